#pragma once

#include <memory>
#include <optional>
#include <string>

#include "campaign/detector.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk::campaign {

/// The project's own monitor in either space, calibrated by desk/calibrate and run by desk/replay:
/// DetectorKind::kTorque and kAcceleration.
[[nodiscard]] std::unique_ptr<Detector> calibrated_monitor(const DetectorSettings& settings,
                                                           const Campaign& campaign,
                                                           const std::vector<Log>& logs);

/// Whether these are Detector::thresholds() of such a monitor: a peer has others.
[[nodiscard]] bool are_of_monitor(const std::string& thresholds);

/// The robot file of such a monitor once more, with the bound that it was calibrated to: its
/// Detector::thresholds(). None: the detector of this name is a peer, or there is none.
[[nodiscard]] std::optional<RobotDescription> judging_robot(const Campaign& campaign,
                                                            const std::string& detector,
                                                            const std::string& thresholds);

}  // namespace offnominal::desk::campaign
