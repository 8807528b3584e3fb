#pragma once

#include <Eigen/Core>
#include <vector>

#include "identify/improved_robot.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk {

// Errors of a robot file before and after a fit, rms per joint (N m or N), on parts of the fitted
// recordings that the fit has not seen: what every verb tells where no recordings are kept apart;
// where some are, it is compare()'s of them.
struct HeldOutErrors {
  Eigen::VectorXd torque;  // measured
  Eigen::VectorXd before;
  Eigen::VectorXd after;
};

// Each part is predicted by a fit of the others, shapes included, of what the new file has: not of
// the skew of its clocks. Before: by the file as it is, on the same samples. `written`: the terms
// of the last fit that the new file has.
HeldOutErrors held_out_errors(const RobotDescription& file, const ImprovedRobot& improved,
                              const std::vector<Term>& written);

}  // namespace offnominal::desk
