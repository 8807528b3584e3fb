#pragma once

#include <memory>

#include "campaign/detector.hpp"

namespace offnominal::desk::campaign {

/// The project's own monitor in either space, calibrated by desk/calibrate and run by desk/replay:
/// DetectorKind::kTorque and kAcceleration.
[[nodiscard]] std::unique_ptr<Detector> calibrated_monitor(const DetectorSettings& settings,
                                                           const Campaign& campaign,
                                                           const std::vector<Log>& logs);

}  // namespace offnominal::desk::campaign
