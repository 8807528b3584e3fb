#include "live/live.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <offnominal/model/quantity.hpp>
#include <utility>

#include "common/error.hpp"
#include "common/refused.hpp"

namespace offnominal::desk::live {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kKeptS = kExplainedBeforeS + kExplainedAfterS + 2;  // of samples
constexpr std::size_t kPeriodSamples = 201;
constexpr std::uint32_t kBeginsAfresh = kBorneInARow + 1;  // ticks without a sample

std::vector<Judged> judged_of(const RobotDescription& robot) {
  if (robot.estimator.space == EstimatorSpace::kTorque) {
    std::vector<Judged> all;
    for (const RobotJoint& joint : robot.joints) {
      all.push_back({joint.name, unit_of(Quantity::kEffort, joint.joint.type)});
    }
    return all;
  }
  const JointType first = robot.joints.front().joint.type;
  const bool mixed =
      std::any_of(robot.joints.begin(), robot.joints.end(),
                  [&](const RobotJoint& joint) { return joint.joint.type != first; });
  return {{"all joints", mixed ? "1" : unit_of(Quantity::kVelocity, first)}};
}

std::size_t rows_of(const RobotDescription& robot) {
  return static_cast<std::size_t>(std::ceil(kKeptS / robot.estimator.period_s));
}

}  // namespace

Live::Live(LiveInput input) : Live(std::move(input), nullptr) {}

Live::Live(LiveInput input, std::unique_ptr<Feed> feed)
    : input_(std::move(input)),
      has_bound_(input_.robot.bound.has_value()),
      has_two_levels_(has_bound_ && input_.robot.bound->has_two_levels()),
      judged_(judged_of(input_.robot)),
      feed_(std::move(feed)),
      watched_(sil::never_judged(input_.robot)),
      history_(input_.robot.joints.size(), judged_.size(), rows_of(input_.robot)),
      strip_(judged_.size()) {
  names_ = joint_names(input_.robot);
  period_s_ = watched_.estimator.period_s;
  set_up();
  now_.beyond.assign(judged_.size(), false);
  now_.residual.assign(judged_.size(), kNone);
  now_.threshold.assign(judged_.size(), kNone);
  now_.act.assign(judged_.size(), kNone);
  if (!feed_ && input_.bus) feed_ = make_ears(*input_.bus);
  if (!feed_) {
    auto bench = make_bench(watched_, input_.scenario);
    bench_ = bench.get();
    feed_ = std::move(bench);
    period_known_ = true;
    now_.accommodates = input_.scenario.accommodate;
  }
  thread_ = std::thread([this] { run(); });
}

Live::~Live() {
  over_ = true;
  if (thread_.joinable()) thread_.join();
}

void Live::set_up() {
  if (samples_) {
    frames_before_ += samples_->frames();
    understood_before_ += samples_->understood();
    counts_before_.lost += samples_->counts().lost;
    counts_before_.rejected += samples_->counts().rejected;
  }
  samples_ = std::make_unique<BusSamples>(watched_);
  watch_ = make_watch(watched_, watched_.estimator.period_s, {});
  residual_.assign(judged_.size(), 0);
  threshold_.assign(judged_.size(), kNone);
  act_.assign(judged_.size(), kNone);
}

void Live::run() {
  while (!over_) {
    try {
      do_what_was_told();
      feed_->take([this](const hal::ReceivedFrame& received) { take(received); });
      after_frames();
    } catch (const std::exception& error) {
      const std::lock_guard guard(lock_);
      now_.ended = error.what();
      return;
    }
  }
}

void Live::tell(std::function<void()> command) {
  const std::lock_guard guard(lock_);
  if (!now_.ended.empty() && !is_simulated()) throw Refused(Refused::Why::kNotNow, now_.ended);
  commands_.push_back(std::move(command));
}

void Live::do_what_was_told() {
  std::vector<std::function<void()>> commands;
  {
    const std::lock_guard guard(lock_);
    commands.swap(commands_);
  }
  for (const auto& command : commands) command();
}

void Live::take(const hal::ReceivedFrame& received) {
  const BusSample* sample = samples_->take(received);
  if (sample == nullptr || !knows_period(*sample)) return;
  judge(*sample);
}

// The monitor's tick is the readings' period, as that of a replay is the recording's: the robot
// file's, unless the first readings say otherwise.
bool Live::knows_period(const BusSample& sample) {
  if (period_known_) return true;
  first_us_.push_back(sample.time_us);
  if (first_us_.size() < kPeriodSamples) return false;
  std::vector<hal::Microseconds> steps;
  for (std::size_t i = 1; i < first_us_.size(); ++i) {
    steps.push_back(first_us_[i] - first_us_[i - 1]);
  }
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  const double period_s = 1e-6 * static_cast<double>(std::max<hal::Microseconds>(*middle, 1));
  constexpr double kSame = 0.05;
  period_known_ = true;
  if (std::abs(period_s - watched_.estimator.period_s) <= kSame * watched_.estimator.period_s) {
    return true;
  }
  watched_.estimator.period_s = period_s;
  set_up();
  const std::lock_guard guard(lock_);
  period_s_ = period_s;
  history_ = History(input_.robot.joints.size(), judged_.size(), rows_of(watched_));
  return false;
}

void Live::judge(const BusSample& sample) {
  if (!begin_us_) begin_us_ = sample.time_us;
  last_sample_us_ = sample.time_us;
  const double t_s = 1e-6 * static_cast<double>(sample.time_us - *begin_us_);
  const bool judges = is_settled(sample, t_s);
  Status status = Status::kOk;
  if (judges) {
    std::uint32_t missing = sample.missing + std::exchange(unjudged_, 0);
    if (std::exchange(begins_afresh_, false)) missing += kBeginsAfresh;
    status = watch_->take(sample.sample, t_s, missing);
  }
  const std::lock_guard guard(lock_);
  now_.t_s = t_s;
  now_.is_driven = sample.driven;
  now_.is_judging = judges;
  if (!judges) return;
  now_.missing += sample.missing;
  if (status != Status::kOk) {
    ++now_.refused;
    return;
  }
  keep(sample, t_s, watch_->said());
  follow_detection(t_s, watch_->said());
}

// Whether a sample can be judged. Where brakes may hold the joints it cannot. And the threshold of
// a run that begins is not what it will be (docs/theory.md: nothing in acceleration space, the
// largest in torque space): until it is that of a run that has lasted, nothing is judged. The
// monitor then begins afresh, with the threshold that it has.
bool Live::is_settled(const BusSample& sample, double t_s) {
  constexpr std::uint32_t kMost = 1'000'000;
  if (!sample.driven) {
    driven_since_s_.reset();
    unjudged_ = std::min(unjudged_ + 1 + sample.missing, kMost);
    return false;
  }
  if (!driven_since_s_) driven_since_s_ = t_s;
  constexpr double kTimeConstants = 6;
  if (t_s >= *driven_since_s_ + kTimeConstants / watched_.estimator.alpha) return true;
  static_cast<void>(watch_->take(sample.sample, t_s, sample.missing + unjudged_));
  unjudged_ = 0;
  begins_afresh_ = true;
  return false;
}

// Two levels there are only where joints are judged by themselves.
double Live::act_ratio(std::size_t joint, bool fast) const {
  const BoundSettings& bound = *input_.robot.bound;
  return (fast ? bound.fast : bound.joints)[joint].act_ratio;
}

void Live::keep(const BusSample& sample, double t_s, const Watched& said) {
  const bool by_joint = judged_.size() > 1 || said.thresholds.size() > 0;
  for (std::size_t i = 0; i < judged_.size(); ++i) {
    const auto index = static_cast<Eigen::Index>(i);
    const ResidualAgainst nearest = by_joint ? said.nearest(index) : ResidualAgainst{};
    residual_[i] = by_joint ? nearest.residual : said.error_norm;
    const double threshold = by_joint ? nearest.threshold : said.threshold;
    threshold_[i] = has_bound_ ? threshold : kNone;
    if (has_two_levels_) {
      const double ratio = act_ratio(i, nearest.fast);
      act_[i] = ratio > 1 ? ratio * threshold : kNone;
    }
    now_.beyond[i] = by_joint ? said.levels[i] : said.level;
  }
  const auto span = [](const auto& vector) {
    return std::span<const double>(vector.data(), static_cast<std::size_t>(vector.size()));
  };
  const auto& at = sample.sample.joints;
  const Levels levels{residual_, threshold_, act_};
  history_.push(t_s, span(at.q), span(at.dq), span(at.tau), levels);
  strip_.push(t_s, levels);
  now_.residual = residual_;
  now_.threshold = threshold_;
  now_.act = act_;
  if (!recording_) return;
  const std::size_t stride = 1 + 3 * input_.robot.joints.size();
  const auto most = static_cast<std::size_t>(kLongestRecordingS / period_s_);
  if (recording_->size() >= most * stride) return;
  recording_->push_back(t_s);
  for (const auto* part : {&at.q, &at.dq, &at.tau}) {
    recording_->insert(recording_->end(), part->data(), part->data() + part->size());
  }
}

void Live::follow_detection(double t_s, const Watched& said) {
  if (said.latched && !was_latched_) {
    detection_.emplace();
    detection_->number = ++detections_;
    detection_->t_s = t_s;
    detection_->joint = said.first_joint;
  }
  was_latched_ = said.latched;
  if (!detection_) return;
  if (said.latched) detection_->answer = watch_->answer();
  if (said.acts && !detection_->act_t_s) {
    detection_->act_t_s = t_s;
    if (said.first_joint >= 0) {
      const auto acts = std::find(said.joint_acts.begin(), said.joint_acts.end(), true);
      detection_->act_joint = static_cast<int>(acts - said.joint_acts.begin());
    }
  }
  freeze(t_s);
}

// What is complete by now, and only that, is taken out of the history.
void Live::freeze(double now_s) {
  Detection& of = *detection_;
  if (!of.frozen && now_s >= of.t_s + kAfterS) {
    of.rows = history_.between(of.t_s - kBeforeS, of.t_s + kAfterS);
    of.frozen = true;
  }
  if (!of.stretch && now_s >= of.t_s + kExplainedAfterS) of.stretch = stretch_of(of);
}

History::Rows Live::stretch_of(const Detection& detection) const {
  return history_.between(detection.t_s - kExplainedBeforeS, detection.t_s + kExplainedAfterS);
}

void Live::after_frames() {
  const std::string ended = feed_->ended();
  const hal::Microseconds now_us = feed_->now_us();
  const std::string missing = ended.empty() ? what_is_missing(now_us) : "";
  const hal::DriveCounts counts = samples_->counts();
  std::optional<ControllerWord> controller;
  if (bench_ != nullptr) {
    controller = bench_->controller();
  } else if (const auto& heartbeat = samples_->heartbeat()) {
    controller = {heartbeat->state, static_cast<controller::Fault>(heartbeat->fault), false};
  }
  const std::lock_guard guard(lock_);
  now_.ended = ended;
  const std::string remark = feed_->remark();
  now_.words = remark.empty() ? missing : remark;
  // Without samples nobody judges.
  if (!missing.empty() || !ended.empty()) now_.is_judging = false;
  now_.controller = controller;
  now_.frames = frames_before_ + samples_->frames();
  now_.understood = understood_before_ + samples_->understood();
  now_.overflow = feed_->overflow();
  now_.lost = counts_before_.lost + counts.lost;
  now_.rejected = counts_before_.rejected + counts.rejected;
  if (!ended.empty() && detection_) freeze(std::numeric_limits<double>::infinity());
}

std::string Live::what_is_missing(hal::Microseconds now_us) const {
  constexpr hal::Microseconds kPatienceUs = 300'000;
  if (begin_us_ && now_us - last_sample_us_ < kPatienceUs) return {};
  if (frames_before_ + samples_->frames() == 0) return "No frame has come yet.";
  if (understood_before_ + samples_->understood() == 0) {
    return "Frames come, but none that this robot's drives send: [drives] of the robot file says "
           "how they speak.";
  }
  const std::vector<std::size_t> silent = samples_->silent_joints(now_us);
  if (silent.size() == input_.robot.joints.size()) return "No readings come any more.";
  std::string joints;
  for (const std::size_t joint : silent) {
    joints += fmt::format("{}joint {} ({})", joints.empty() ? "" : ", ", joint + 1,
                          input_.robot.joints[joint].name);
  }
  return joints.empty() ? "Waiting for a reading of every joint."
                        : "There are no readings of " + joints + ".";
}

// The monitor begins as at the start.
void Live::forget() {
  const bool known = period_known_;
  set_up();
  period_known_ = known;
  unjudged_ = 0;
  driven_since_s_.reset();
  was_latched_ = false;
  const std::lock_guard guard(lock_);
  history_.clear();
  detection_.reset();
  now_.beyond.assign(judged_.size(), false);
  now_.is_driven = now_.is_judging = false;
}

}  // namespace offnominal::desk::live
