#include "campaign/detector.hpp"

#include "campaign/kdl_observer.hpp"
#include "campaign/momentum_observer.hpp"
#include "campaign/monitor_detector.hpp"
#include "campaign/observer_detector.hpp"

namespace offnominal::desk::campaign {

std::unique_ptr<Detector> calibrated(const DetectorSettings& settings, const Campaign& campaign,
                                     const std::vector<Log>& logs) {
  const double rate = campaign.calibration.alarms_per_hour;
  const double gain = settings.alpha_per_s;
  const RobotDescription& robot = campaign.model;
  switch (settings.kind) {
    case DetectorKind::kMomentumObserver:
      return calibrated_observer(
          [robot, gain](const Log& log) { return momentum_residual(robot, gain, log); }, gain, rate,
          logs);
    case DetectorKind::kKdl: {
      const double filter = settings.filter_share;
      return calibrated_observer(
          [robot, gain, filter](const Log& log) { return kdl_residual(robot, gain, filter, log); },
          gain, rate, logs);
    }
    case DetectorKind::kTorque:
    case DetectorKind::kAcceleration:
      break;
  }
  return calibrated_monitor(settings, campaign, logs);
}

}  // namespace offnominal::desk::campaign
