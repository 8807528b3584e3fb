#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "calibrate/calibrate_joints.hpp"
#include "calibrate/calibrate_report.hpp"
#include "report/page.hpp"

namespace offnominal::desk {

/// The result in one sentence or two.
[[nodiscard]] std::string verdict_of(const JointsCalibration& calibration);

[[nodiscard]] std::string text_of(const JointsCalibration& calibration,
                                  const CalibrateNames& names);
[[nodiscard]] nlohmann::ordered_json to_json(const JointsCalibration& calibration,
                                             const CalibrateNames& names);
[[nodiscard]] report::Page page_of(const JointsCalibration& calibration,
                                   const CalibrateNames& names);

}  // namespace offnominal::desk
