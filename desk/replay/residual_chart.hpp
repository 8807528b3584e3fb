#pragma once

#include <string>

#include "report/page.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk {

// What a monitor judges by, over the time in s: the size of the residual of one joint
// (EstimatorSpace::kTorque) or of all (|e|) and its threshold, in `unit`. Of the two series x and y
// count; they are named here. act_ratio: of the second level to the threshold, which has a line of
// its own where it is above 1.
[[nodiscard]] report::Chart chart_against_threshold(EstimatorSpace space, const std::string& unit,
                                                    report::Series residual,
                                                    report::Series threshold, double act_ratio = 1);

}  // namespace offnominal::desk
