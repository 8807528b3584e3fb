#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <system_error>

#include "common/error.hpp"
#include "common/file.hpp"
#include "common/refused.hpp"
#include "live/live.hpp"
#include "log/csv_text.hpp"
#include "report/act_level.hpp"
#include "report/decimate.hpp"

namespace offnominal::desk::live {
namespace {

using Eigen::Index;

[[noreturn]] void refuse(Refused::Why why, const std::string& words) { throw Refused(why, words); }

sim::FaultEvent checked(const std::string& kind, int joint, double size, int joints) {
  const auto* info = std::find_if(sim::kFaultEventInfos.begin(), sim::kFaultEventInfos.end(),
                                  [&](const sim::FaultEventInfo& one) { return one.name == kind; });
  if (info == sim::kFaultEventInfos.end() || info->kind == sim::FaultEventKind::kNonlinear) {
    refuse(Refused::Why::kBadRequest, "There is no fault of that name.");
  }
  sim::FaultEvent fault;
  fault.kind = info->kind;
  if (info->of_joint != sim::OfJoint::kNever) {
    if (joint < 1 || joint > joints) refuse(Refused::Why::kBadRequest, "There is no such joint.");
    fault.joint = joint - 1;
  }
  if (!info->unit.empty()) {
    if (!(size >= info->least && size <= info->most)) {
      refuse(Refused::Why::kBadRequest,
             fmt::format("The size of {} has to be {:g} to {:g} {}.", info->name, info->least,
                         info->most, info->unit));
    }
    // It would take the place of one that is there, and stand in the list as a fault.
    if (size == 0) {
      refuse(
          Refused::Why::kBadRequest,
          fmt::format("A size of 0 is no fault: that of {} has to be {:g} to {:g} {}, and not 0.",
                      info->name, info->least, info->most, info->unit));
    }
    fault.size = size;
  }
  return fault;
}

// Residual and the levels that there are over the time, as much of them as a picture shows.
report::Chart chart_of(const History::Rows& rows, std::size_t of, const Judged& judged,
                       std::size_t pixels, const Live& live) {
  const Eigen::VectorXd t_s = rows.time_s();
  const auto series = [&](const char* name, const Eigen::VectorXd& values, report::Tone tone) {
    report::Series all{.name = name, .tone = tone};
    all.x.assign(t_s.data(), t_s.data() + t_s.size());
    all.y.assign(values.data(), values.data() + values.size());
    return report::decimate(all, std::max(2 * pixels, report::kMinDecimatedPoints));
  };
  report::Chart chart;
  chart.title = "Around the detection: " + judged.name;
  chart.x = {.name = "time", .unit = "s"};
  chart.y = {{.name = "residual", .unit = judged.unit}};
  chart.series = {series("|residual|", rows.residual(of), report::Tone::kResidual)};
  if (live.has_bound()) {
    chart.series.push_back(series("threshold", rows.threshold(of), report::Tone::kThreshold));
  }
  if (!rows.act(of).array().isNaN().all()) {
    chart.series.push_back(series(report::kActLevel, rows.act(of), report::Tone::kFaint));
    chart.series.back().dashed = true;
  }
  chart.zoom_group = "live";
  chart.width = report::Width::kHalf;
  return chart;
}

}  // namespace

Moment Live::moment(std::uint64_t from) const {
  const std::lock_guard guard(lock_);
  Moment moment = now_;
  moment.steps = strip_.since(from);
  if (detection_) {
    moment.detection.emplace();
    moment.detection->number = detection_->number;
    moment.detection->t_s = detection_->t_s;
    moment.detection->joint = detection_->joint;
    moment.detection->act_t_s = detection_->act_t_s;
    moment.detection->act_joint = detection_->act_joint;
    moment.detection->answer = detection_->answer;
    moment.detection->frozen = detection_->frozen;
  }
  if (recording_) {
    const std::size_t stride = 1 + 3 * input_.robot.joints.size();
    const std::size_t rows = recording_->size() / stride;
    moment.recording_s = static_cast<double>(rows) * period_s_;
  }
  return moment;
}

std::string Live::words_of(const IsolatedFault& fault) const {
  return desk::words_of(fault, names_);
}

std::vector<report::Chart> Live::frozen(std::size_t pixels) const {
  History::Rows rows;
  double detected_s = 0;
  std::optional<double> acts_s;
  {
    const std::lock_guard guard(lock_);
    if (!detection_ || !detection_->frozen) {
      refuse(Refused::Why::kNotNow, "Nothing was detected yet whose surroundings are kept.");
    }
    rows = detection_->rows;
    detected_s = detection_->t_s;
    if (has_two_levels_) acts_s = detection_->act_t_s;
  }
  std::vector<report::Chart> charts;
  for (std::size_t i = 0; i < judged_.size(); ++i) {
    charts.push_back(chart_of(rows, i, judged_[i], pixels, *this));
    charts.back().events = {{detected_s, "detected", report::Level::kBad}};
    if (acts_s) charts.back().events.push_back({*acts_s, "acts", report::Level::kBad});
  }
  return charts;
}

Bench& Live::bench() const {
  if (bench_ != nullptr) return *bench_;
  refuse(Refused::Why::kNotNow,
         "This is a real bus: Studio listens, and can do nothing to what is on it.");
}

void Live::add_fault(const std::string& kind, int joint, double size) {
  Bench& on = bench();
  const sim::FaultEvent fault = checked(kind, joint, size, input_.robot.joint_count());
  std::vector<sim::FaultEvent> all;
  {
    const std::lock_guard guard(lock_);
    std::erase_if(now_.faults, [&](const sim::FaultEvent& other) {
      return other.kind == fault.kind && other.joint == fault.joint;
    });
    now_.faults.push_back(fault);
    now_.faults.back().begin_s = now_.t_s;
    all = now_.faults;
  }
  tell([&on, all] { on.set_faults(all); });
}

void Live::end_faults() {
  Bench& on = bench();
  {
    const std::lock_guard guard(lock_);
    now_.faults.clear();
  }
  tell([&on] { on.set_faults({}); });
}

void Live::set_accommodation(bool on) {
  Bench& of = bench();
  {
    const std::lock_guard guard(lock_);
    now_.accommodates = on;
  }
  tell([&of, on] { of.set_accommodation(on); });
}

void Live::begin_again() {
  if (is_simulated()) {
    const std::lock_guard guard(lock_);
    now_.faults.clear();
  }
  tell([this] {
    if (bench_ != nullptr) bench_->begin_again();
    forget();
  });
}

void Live::start_recording() {
  const std::lock_guard guard(lock_);
  if (recording_) refuse(Refused::Why::kNotNow, "A recording is under way already.");
  recording_.emplace();
}

std::string Live::stop_recording() {
  std::vector<double> rows;
  double period_s = 0;
  {
    const std::lock_guard guard(lock_);
    if (!recording_) refuse(Refused::Why::kNotNow, "No recording is under way.");
    rows = std::move(*recording_);
    recording_.reset();
    period_s = period_s_;
  }
  const std::size_t joints = input_.robot.joints.size();
  const auto stride = static_cast<Index>(1 + 3 * joints);
  if (rows.empty()) refuse(Refused::Why::kNotNow, "Nothing came while it was recorded.");
  History::Rows all{joints, 0, {}};
  using Table = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  all.all = Eigen::Map<const Table>(rows.data(), static_cast<Index>(rows.size()) / stride, stride);
  return write(all.log("live", period_s), "live");
}

Live::Written Live::write_detection() const {
  History::Rows rows;
  double detected_s = 0;
  double period_s = 0;
  Written written;
  {
    const std::lock_guard guard(lock_);
    if (!detection_ || !detection_->frozen) {
      refuse(Refused::Why::kNotNow,
             "There is nothing to explain yet: a detection, and what follows it for two seconds.");
    }
    rows = detection_->stretch ? *detection_->stretch : stretch_of(*detection_);
    detected_s = detection_->t_s;
    period_s = period_s_;
    written.detection = detection_->number;
  }
  written.since = write(rows.since(detected_s).log("live", period_s), "detection");
  written.before = write(rows.before(detected_s).log("live", period_s), "before_detection");
  return written;
}

std::uint64_t Live::detection_number() const {
  const std::lock_guard guard(lock_);
  return detection_ ? detection_->number : 0;
}

// "arm_detection.csv", or "arm_detection_2.csv" where that is there, and so on.
std::string Live::write(const Log& log, const std::string& what) const {
  const std::string text = csv_text(log);
  const std::string stem = std::filesystem::path(input_.robot_file).stem().string();
  for (int number = 1;; ++number) {
    const std::string again = number == 1 ? "" : fmt::format("_{}", number);
    const std::filesystem::path path =
        input_.folder / fmt::format("{}_{}{}.csv", stem, what, again);
    std::error_code ignored;
    if (std::filesystem::exists(std::filesystem::symlink_status(path, ignored))) continue;
    write_file_atomically(path, text, Existing::kRefuse);
    return path.string();
  }
}

}  // namespace offnominal::desk::live
