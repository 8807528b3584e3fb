#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <vector>

#include "explain/doctor_checks.hpp"
#include "explain/doctor_signal.hpp"
#include "explain/expected_torque.hpp"
#include "explain/moved_meanwhile.hpp"
#include "signal/quantile.hpp"

// One value for long, while the joint moves: a dead encoder, a blocked reader, a drive that is not
// on yet. A joint that rests repeats its values too, and a drive at its limit its torque.

namespace offnominal::desk {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr Index kFewestRepeats = 10;
constexpr Index kFewestAtStart = 4;
// Single events, such as a joint that is stopped by hand, that are no measure of what it does
// usually.
constexpr int kEvents = 2;
constexpr double kUnusual = 2;
constexpr double kSensorSteps = 3;  // of the encoder
constexpr double kSeldom = 1e-3;

// How a burst begins and ends in a signal. What it does usually is looked for once somebody asks:
// in a long recording that costs more than all bursts.
class BurstEnds {
 public:
  // `q` has to outlive it.
  explicit BurstEnds(const VectorXd& q) : q_(q) {}

  // What the signal is rounded to at a value.
  [[nodiscard]] double step_at(double value) const {
    if (!rounding_) rounding_.emplace(q_);
    return rounding_->at(value);
  }

  // The joint moved at full pace right before it: a real one slows down.
  [[nodiscard]] bool starts_abruptly(const Burst& burst) const {
    constexpr Index kWhole = 4;  // widths
    constexpr double kPaceKept = 0.5;
    constexpr double kPaceBefore = 0.3;
    constexpr double kOfTopPace = 0.3;
    std::size_t at = 0;
    for (Index width = 1; width <= kWidest && kWhole * width <= burst.length; width *= 2) {
      const Index from = burst.first - kWhole * width;
      if (from < 0) break;
      const double limit = limit_of(at++) + kSensorSteps * step_at(q_[burst.first]);
      const double last = std::abs(q_[burst.first] - q_[burst.first - width]);
      const double whole = std::abs(q_[burst.first] - q_[from]) / kWhole;
      const double before = std::abs(q_[burst.first - width] - q_[from]) / (kWhole - 1);
      // One jump is no pace, and dry friction stops what is slow at once.
      if (last > limit && last > kOfTopPace * top_pace() * static_cast<double>(width) &&
          last > kPaceKept * whole && before > kPaceBefore * last)
        return true;
    }
    return false;
  }

  // It goes on with a jump.
  [[nodiscard]] bool ends_in_jump(const Burst& burst) const {
    const Index end = burst.end();
    if (end + 1 >= q_.size()) return false;
    const double jump = std::abs(q_[end + 1] - q_[end]);
    const double next = end + 2 < q_.size() ? std::abs(q_[end + 2] - q_[end + 1]) : 0;
    constexpr double kOfTopPace = 2;
    if (comes_back(burst)) return false;
    return jump > 2 * next && jump > kOfTopPace * top_pace() &&
           jump > limit_of(0) + kSensorSteps * step_at(q_[end + 1]);
  }

  // It comes to its end with the recording, or with a change that the joint does not show
  // otherwise: what rests starts anew by and by.
  [[nodiscard]] bool ends_unlike_a_rest(const Burst& burst) const {
    const Index end = burst.end();
    if (end + 1 >= q_.size()) return true;
    return !comes_back(burst) &&
           std::abs(q_[end + 1] - q_[end]) > limit_of(0) + kSensorSteps * step_at(q_[end + 1]);
  }

  // A jump that is not more than what the joint can have moved meanwhile, by how it moves then.
  [[nodiscard]] bool moves_on(const Burst& burst) const {
    constexpr Index kRows = 8;
    constexpr double kOfJump = 0.2;
    const Index first = burst.end() + 1;
    const Index last = std::min(first + kRows, q_.size() - 1);
    if (last <= first) return false;
    const double pace =
        (q_.segment(first + 1, last - first) - q_.segment(first, last - first)).cwiseAbs().mean();
    return pace * static_cast<double>(burst.length) > kOfJump * std::abs(q_[first] - q_[first - 1]);
  }

 private:
  static constexpr Index kWidest = 16;

  // What follows it is a spike of a joint that rests.
  [[nodiscard]] bool comes_back(const Burst& burst) const {
    const Index end = burst.end();
    const double jump = std::abs(q_[end + 1] - q_[end]);
    for (Index i = end + 2; i <= std::min(end + 1 + kLongestSpike, q_.size() - 1); ++i) {
      if (std::abs(q_[i] - q_[end]) < jump / 2) return true;
    }
    return false;
  }

  // From one row to the next.
  [[nodiscard]] double top_pace() const {
    constexpr double kNearlyTop = 0.99;
    const Index steps = q_.size() - 1;
    if (!top_pace_) {
      top_pace_ = quantile((q_.tail(steps) - q_.head(steps)).cwiseAbs(), kNearlyTop);
    }
    return *top_pace_;
  }

  // Of the width 2^power rows.
  [[nodiscard]] double limit_of(std::size_t power) const {
    if (limits_.size() <= power) limits_.resize(power + 1);
    std::optional<double>& limit = limits_[power];
    if (!limit) limit = kUnusual * usual_change_of_pace(q_, Index{1} << power, kEvents);
    return *limit;
  }

  const VectorXd& q_;
  mutable std::optional<Rounding> rounding_;
  mutable std::optional<double> top_pace_;
  mutable std::vector<std::optional<double>> limits_;  // per power of two
};

// What a joint's measured velocity does while its position repeats.
class VelocityMeanwhile {
 public:
  VelocityMeanwhile(const Log& log, Index joint) : log_(log), joint_(joint) {}

  // It moves on: at a pace, or to and fro over more than a part of the joint's way.
  [[nodiscard]] bool moves(const Burst& burst) const {
    constexpr double kOfUsual = 0.3;
    if (log_.dq_derived[static_cast<std::size_t>(joint_)]) return false;
    // Where it is filtered it only comes to rest later.
    constexpr double kLateS = 0.15;
    if (static_cast<double>(burst.length) * log_.period_s < 2 * kLateS) return false;
    const VectorXd during = log_.dq.col(joint_).segment(burst.first + 1, burst.length);
    if (const auto ratio = ratio_beside(burst)) {
      constexpr double kOfWay = 0.2;
      VectorXd way(during.size());
      std::partial_sum(during.begin(), during.end(), way.begin());
      const double covered = log_.period_s * (way.maxCoeff() - way.minCoeff()) / std::abs(*ratio);
      const auto q = log_.q.col(joint_);
      if (covered > kOfWay * (q.maxCoeff() - q.minCoeff())) return true;
    }
    return during.minCoeff() < during.maxCoeff() &&
           std::abs(during.mean()) > kOfUsual * usual_speed() &&
           during.cwiseAbs().mean() > kSensorSteps * step();
  }

 private:
  // Of velocity and position, on the longer side of the burst: more than ten minutes say no more.
  [[nodiscard]] std::optional<double> ratio_beside(const Burst& burst) const {
    constexpr double kLongestS = 600;
    const Index behind = log_.sample_count() - burst.end() - 1;
    const bool before = burst.first > behind;
    const auto rows = std::min(before ? burst.first : behind,
                               static_cast<Index>(std::lround(kLongestS / log_.period_s)));
    const Index first = before ? burst.first - rows : burst.end() + 1;
    return velocity_ratio(log_.q.col(joint_).segment(first, rows),
                          log_.dq.col(joint_).segment(first, rows), log_.period_s);
  }

  [[nodiscard]] double usual_speed() const {
    constexpr double kOfTop = 0.95;
    constexpr double kOfFastest = 0.2;  // of one that moves seldom
    if (!usual_speed_) {
      const VectorXd speed = log_.dq.col(joint_).cwiseAbs();
      usual_speed_ = std::max(quantile(speed, kOfTop), kOfFastest * speed.maxCoeff());
    }
    return *usual_speed_;
  }

  [[nodiscard]] double step() const {
    if (!step_) step_ = smallest_step(log_.dq.col(joint_));
    return *step_;
  }

  const Log& log_;
  Index joint_;
  mutable std::optional<double> usual_speed_;
  mutable std::optional<double> step_;
};

// What a joint's torque asks for beyond the model at the positions that were read: how much that
// changes within half a second, usually and while its position repeats.
class BeyondModel {
 public:
  // `bursts`: of the joint; a coarse encoder's short ones are as usual as any rows.
  BeyondModel(const Log& log, Index joint, const ExpectedTorque& expected,
              const std::vector<Burst>& bursts)
      : torque_(log.tau.col(joint)), beyond_(expected.torque_beyond(log, joint)) {
    constexpr double kWindowS = 0.5;
    constexpr Index kFewestRows = 8;
    constexpr std::size_t kFewestWindows = 4;
    constexpr double kNearlyAll = 0.95;
    rows_ = std::max(kFewestRows, static_cast<Index>(std::lround(kWindowS / log.period_s)));
    std::vector<double> others;
    for (Index first = 0; first + rows_ <= beyond_.size(); first += rows_ / 2) {
      const bool repeats = std::any_of(bursts.begin(), bursts.end(), [&](const Burst& burst) {
        return burst.length >= 2 * rows_ && first <= burst.end() && first + rows_ > burst.first;
      });
      if (!repeats) others.push_back(spread(beyond_, first));
    }
    if (others.size() < kFewestWindows) return;
    usual_ = quantile(Eigen::Map<const VectorXd>(others.data(), static_cast<Index>(others.size())),
                      kNearlyAll);
  }

  // The torque says that the joint moves: what it asks for changes as it never does where the
  // position is read, again and again, and the drive gives it. One change would be a brake that
  // takes over, or a spike.
  [[nodiscard]] bool moves_during(const Burst& burst) const {
    constexpr double kUnlike = 2;
    constexpr double kGiven = 0.5;
    constexpr int kWindows = 3;
    if (!(usual_ > 0)) return false;
    int found = 0;
    for (Index first = burst.first; first + rows_ <= burst.end() + 1; first += rows_) {
      const double asked = spread(beyond_, first);
      if (asked > kUnlike * usual_ && spread(torque_, first) > kGiven * asked) ++found;
    }
    return found >= kWindows;
  }

 private:
  // Standard deviation over one window.
  [[nodiscard]] double spread(const VectorXd& x, Index first) const {
    const auto window = x.segment(first, rows_).array();
    return std::sqrt((window - window.mean()).square().mean());
  }

  VectorXd torque_;
  VectorXd beyond_;
  Index rows_ = 0;  // of a window
  double usual_ = 0;
};

// As a drive or a logger takes to start.
bool is_short(const Log& log, const Burst& burst) {
  constexpr double kStartS = 1;
  return static_cast<double>(burst.length) * log.period_s <= kStartS;
}

std::vector<Burst> long_bursts(const VectorXd& x) {
  std::vector<Burst> bursts = repeats_of(x);
  std::erase_if(bursts, [](const Burst& burst) {
    return burst.length < (burst.first == 0 ? kFewestAtStart : kFewestRepeats);
  });
  return bursts;
}

std::vector<Burst> stuck_positions(const Log& log, Index joint, const ExpectedTorque& expected) {
  const VectorXd q = log.q.col(joint);
  std::vector<Burst> bursts = long_bursts(q);
  if (bursts.empty() || stands_still(q)) return {};
  const BurstEnds ends(q);
  const BeyondModel torque(log, joint, expected, bursts);
  const VelocityMeanwhile velocity(log, joint);
  const std::vector<Index> repeats_before = repeats_before_of(q);
  std::erase_if(bursts, [&](const Burst& burst) {
    if (is_next_to_gap(log, burst)) return true;
    if (torque.moves_during(burst)) return false;
    // A coarse encoder holds its value for as long where the joint is slow.
    const bool usual = static_cast<double>(q.size()) * std::pow(own_repeats(repeats_before, burst),
                                                                static_cast<double>(burst.length)) >
                       kSeldom;
    const bool by_velocity = velocity.moves(burst);
    const bool at_start = burst.first == 0 && is_short(log, burst);
    if (ends.ends_in_jump(burst)) {
      const MovedMeanwhile moved = moved_meanwhile(log, burst, expected);
      if (moved != MovedMeanwhile::kUnknown) return moved == MovedMeanwhile::kNo;
      if (at_start || ends.moves_on(burst)) return false;
    }
    if (usual && !by_velocity) return true;
    return !by_velocity && !(ends.starts_abruptly(burst) && ends.ends_unlike_a_rest(burst));
  });
  return bursts;
}

bool moves_mostly(const VectorXd& dq, const Burst& burst) {
  constexpr double kUsual = 0.95;
  constexpr double kSlow = 0.1;
  const double slow = kSlow * quantile(dq.cwiseAbs(), kUsual);
  const auto during = dq.segment(burst.first, burst.length + 1).array().abs();
  return 2 * (during > slow).count() > during.size();
}

bool goes_on_by_a_step(const VectorXd& x, const BurstEnds& ends, const Burst& burst) {
  constexpr double kSteps = 1.5;
  if (burst.end() + 1 >= x.size()) return false;
  const double change = std::abs(x[burst.end() + 1] - x[burst.end()]);
  return change <= kSteps * ends.step_at(x.cwiseAbs().maxCoeff());
}

std::vector<Burst> stuck_torques(const Log& log, Index joint, const ExpectedTorque& expected) {
  constexpr double kShortestS = 0.1;
  constexpr double kTravel = 0.01;  // of the joint's range
  constexpr double kChange = 0.15;  // of the torque's range
  constexpr double kChangeWhereLost = 0.4;
  constexpr double kChangeOfFine = 0.05;
  constexpr double kSeldomRepeats = 0.1;
  constexpr std::size_t kUsual = 4;
  constexpr Index kLonger = 3;
  constexpr double kAtExtreme = 1e-3;
  const VectorXd tau = log.tau.col(joint);
  const auto q = log.q.col(joint);
  const double range = q.maxCoeff() - q.minCoeff();
  std::vector<Burst> bursts = repeats_of(tau);
  std::sort(bursts.begin(), bursts.end(),
            [](const Burst& a, const Burst& b) { return a.length > b.length; });
  const Index usual = bursts.size() > kUsual ? bursts[kUsual].length : 0;
  const std::vector<Index> repeats_before = repeats_before_of(tau);
  const double low = tau.minCoeff();
  const double high = tau.maxCoeff();
  const double near = kAtExtreme * (high - low);
  const BurstEnds ends(tau);
  std::erase_if(bursts, [&](const Burst& burst) {
    if (is_next_to_gap(log, burst)) return true;
    // A drive that gives nothing yet, then all at once, also where it holds the joint.
    if (burst.first == 0 && tau[0] == 0 && burst.length >= kFewestAtStart && is_short(log, burst) &&
        ends.ends_in_jump(burst)) {
      return false;
    }
    if (static_cast<double>(burst.length) <
            std::max<double>(kFewestRepeats, kShortestS / log.period_s) ||
        !(range > 0)) {
      return true;
    }
    const auto during = q.segment(burst.first, burst.length + 1);
    if (during.maxCoeff() - during.minCoeff() < kTravel * range) return true;
    const double value = tau[burst.first];
    const double change = expected.change_during(log.t_s[burst.first], log.t_s[burst.end()], joint);
    const double lasting =
        expected.lasting_change_during(log.t_s[burst.first], log.t_s[burst.end()], joint);
    constexpr double kSteps = 2;  // of the torque, that rounding makes of nothing
    if (lasting < kSteps * ends.step_at(value)) return true;
    // A drive that is off lets the joint swing as the model says, or fall to where friction holds
    // it; a torque that is lost does not.
    if (value == 0) {
      return change < kChangeWhereLost * (high - low) || !moves_mostly(log.dq.col(joint), burst);
    }
    // A drive at its limit: find_saturation(). None is there most of the time.
    const bool at_end = value <= low + near || value >= high - near;
    if (at_end && 2 * burst.length < tau.size()) return true;
    if (is_noisy_around(tau, burst)) return false;
    const bool by_chance =
        static_cast<double>(tau.size()) *
            std::pow(own_repeats(repeats_before, burst), static_cast<double>(burst.length)) >
        kSeldom;
    if (burst.length < kLonger * usual) return true;
    // A torque that never repeats says so where the model asks for little; a coarse one holds its
    // value for as long by chance, but not while the model asks for many of its steps.
    if (own_repeats(repeats_before, burst) < kSeldomRepeats) {
      return by_chance || change < kChangeOfFine * (high - low);
    }
    // Where it only stayed it goes on by a step.
    if (goes_on_by_a_step(tau, ends, burst)) return true;
    return lasting < (by_chance ? kChangeWhereLost : kChange) * (high - low);
  });
  return bursts;
}

// Short repeats that come often have a name of their own.
bool is_known(const std::vector<DataFault>& faults, Index joint, FaultySignal signal,
              const Burst& burst) {
  return std::any_of(faults.begin(), faults.end(), [&](const DataFault& fault) {
    return fault.kind == DataFaultKind::kStaleSamples && fault.joint == joint &&
           fault.signal == signal &&
           std::any_of(fault.spans.begin(), fault.spans.end(), [&](const FaultSpan& span) {
             return span.samples.first <= burst.end() && span.samples.last > burst.first;
           });
  });
}

void add_stuck_fault(const Log& log, Index joint, bool position, bool at_start,
                     const std::vector<Burst>& bursts, std::vector<DataFault>& faults) {
  std::vector<RowSpan> spans;
  Index rows = 0;
  for (const Burst& burst : bursts) {
    if ((burst.first == 0) != at_start) continue;
    // At the start the first row is not the last good one.
    spans.push_back({burst.first + (at_start ? 0 : 1), burst.end()});
    rows += spans.back().count();
  }
  if (spans.empty()) return;
  DataFault fault;
  fault.kind = at_start ? DataFaultKind::kStart : DataFaultKind::kStuck;
  fault.joint = joint;
  fault.signal = position ? FaultySignal::kPosition : FaultySignal::kTorque;
  fault.size = static_cast<double>(rows) / static_cast<double>(log.sample_count());
  set_spans(log, spans, fault);
  fault.words = fmt::format("the {} of joint {} {} while the joint moves: {}",
                            position ? "position" : "torque", joint + 1,
                            at_start ? "does not change at the start" : "is stuck at one value",
                            words_of_spans(fault));
  fault.mend = at_start ? "start to record when the drive is on and every channel is there"
                        : "look at the sensor, its cable and the channel that it is logged from";
  faults.push_back(std::move(fault));
}

}  // namespace

void find_stuck_values(const Log& log, const ExpectedTorque& expected,
                       std::vector<DataFault>& faults) {
  struct Stuck {
    std::vector<Burst> positions, torques;
  };
  const std::vector<Stuck> stuck = of_every_joint(log, [&](Index joint) {
    return Stuck{stuck_positions(log, joint, expected), stuck_torques(log, joint, expected)};
  });
  for (Index joint = 0; joint < log.q.cols(); ++joint) {
    const Stuck& own = stuck[static_cast<std::size_t>(joint)];
    for (const bool position : {true, false}) {
      std::vector<Burst> bursts = position ? own.positions : own.torques;
      const auto signal = position ? FaultySignal::kPosition : FaultySignal::kTorque;
      std::erase_if(bursts,
                    [&](const Burst& burst) { return is_known(faults, joint, signal, burst); });
      for (const bool at_start : {true, false}) {
        add_stuck_fault(log, joint, position, at_start, bursts, faults);
      }
    }
  }
}

}  // namespace offnominal::desk
