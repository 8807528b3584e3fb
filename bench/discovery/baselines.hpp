#pragma once

#include <vector>

#include "log/log.hpp"
#include "robot/robot.hpp"
#include "score.hpp"

namespace offnominal::bench {

// What two regressions in common use select from the columns of the analysis' own candidates, on
// the same filtered samples and with the same nuisance fitted. Largest contribution first.
struct BaselineSelections {
  Effects stepwise;     // forward selection by BIC, samples taken for independent
  Effects thresholded;  // sequentially thresholded least squares (S. L. Brunton, J. L. Proctor,
                        // J. N. Kutz, PNAS 113(15), 2016)
};

BaselineSelections select_by_baselines(const desk::RobotDescription& robot,
                                       const desk::Log& recording);

}  // namespace offnominal::bench
