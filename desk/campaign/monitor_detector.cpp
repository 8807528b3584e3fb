#include "campaign/monitor_detector.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <utility>

#include "calibrate/calibrate.hpp"
#include "calibrate/calibrate_joints.hpp"
#include "replay/replay.hpp"
#include "robot/robot_file.hpp"

namespace offnominal::desk::campaign {
namespace {

// No error is within any threshold, be it none yet; as replay counts.
Eigen::MatrixXd ratio_of(const Eigen::MatrixXd& error, const Eigen::MatrixXd& threshold) {
  return error.binaryExpr(
      threshold, [](double e, double mu) { return std::abs(e) > 0 ? std::abs(e) / mu : 0; });
}

// Whatever the threshold is scaled with: a joint whose position is where no motion brings it is
// beyond, and no residual says so.
void add_jumps(const Replay& shown, Eigen::MatrixXd& ratio) {
  const double beyond = std::nextafter(1.0, 2.0);
  for (std::size_t joint = 0; joint < shown.joints.size(); ++joint) {
    for (const Alarm& alarm : shown.joints[joint].alarms) {
      if (!alarm.is_jump()) continue;
      const auto* const begin = shown.t_s.data();
      const auto* const at = std::lower_bound(begin, begin + shown.t_s.size(), alarm.start_s);
      double& there = ratio(at - begin, static_cast<Eigen::Index>(joint));
      there = std::max(there, beyond);
    }
  }
}

// Begins what robot_text() says last.
constexpr const char* kBound = "[uncertainty_bound]";

bool is_monitor(DetectorKind kind) {
  return kind == DetectorKind::kTorque || kind == DetectorKind::kAcceleration;
}

// The campaign's model with the filters of a detector, whatever its bound.
RobotDescription with_filters(const DetectorSettings& settings, const Campaign& campaign) {
  RobotDescription robot = campaign.model;
  robot.estimator.alpha = settings.alpha_per_s;
  robot.estimator.fast_alpha = settings.fast_alpha_per_s;
  robot.estimator.space = settings.kind == DetectorKind::kTorque ? EstimatorSpace::kTorque
                                                                 : EstimatorSpace::kAcceleration;
  return robot;
}

class MonitorDetector final : public Detector {
 public:
  MonitorDetector(RobotDescription robot, bool accommodates, std::vector<std::string> notes)
      : robot_(std::move(robot)), accommodates_(accommodates) {
    notes_ = std::move(notes);
  }

  [[nodiscard]] Judged judge(const Log& log) const override {
    const Replay shown = replay(robot_, log);
    if (shown.joints.empty()) {
      return {shown.t_s, ratio_of(shown.error_norm, shown.threshold)};
    }
    Judged judged{shown.t_s, ratio_of(shown.error, shown.thresholds)};
    if (shown.fast_error.size() > 0) {
      judged.ratio = judged.ratio.cwiseMax(ratio_of(shown.fast_error, shown.fast_thresholds));
    }
    add_jumps(shown, judged.ratio);
    if (!shown.faults.empty() && shown.faults.front().detection_time_s == shown.detection_time_s) {
      const IsolatedFault& said = shown.faults.front();
      const bool is_known = said.kind != offnominal::FaultKind::kUnknown;
      judged.named = {said.kind, is_known ? said.joint : -1, said.size,
                      said.time_s - said.detection_time_s};
    }
    return judged;
  }

  [[nodiscard]] std::unique_ptr<Accommodation> accommodation() const override {
    if (!accommodates_) return nullptr;
    return std::make_unique<Accommodation>(robot_, robot_.estimator.period_s);
  }

  // The robot file's text has every digit of the bound.
  [[nodiscard]] std::string thresholds() const override {
    const std::string text = robot_text(robot_);
    const std::size_t begin = text.find(kBound);
    return begin == std::string::npos ? text : text.substr(begin);
  }

 private:
  RobotDescription robot_;
  bool accommodates_;
};

}  // namespace

std::unique_ptr<Detector> calibrated_monitor(const DetectorSettings& settings,
                                             const Campaign& campaign,
                                             const std::vector<Log>& logs) {
  const RobotDescription robot = with_filters(settings, campaign);
  const CalibrateRequest request{campaign.calibration.alarms_per_hour, {}, ""};
  if (settings.kind == DetectorKind::kTorque) {
    JointsCalibration result = calibrate_joints(robot, request, logs, {});
    return std::make_unique<MonitorDetector>(std::move(result.robot), settings.accommodates,
                                             std::move(result.objections));
  }
  Calibration result = calibrate(robot, request, logs, {});
  return std::make_unique<MonitorDetector>(std::move(result.robot), false,
                                           std::move(result.objections));
}

bool are_of_monitor(const std::string& thresholds) { return thresholds.starts_with(kBound); }

std::optional<RobotDescription> judging_robot(const Campaign& campaign, const std::string& detector,
                                              const std::string& thresholds) {
  const auto found = std::find_if(
      campaign.detectors.begin(), campaign.detectors.end(),
      [&](const DetectorSettings& one) { return one.name == detector && is_monitor(one.kind); });
  if (found == campaign.detectors.end()) return std::nullopt;
  std::string text = robot_text(with_filters(*found, campaign));
  text.resize(std::min(text.size(), text.find(kBound)));
  return parse_robot(text + "\n" + thresholds, "detector " + detector);
}

}  // namespace offnominal::desk::campaign
