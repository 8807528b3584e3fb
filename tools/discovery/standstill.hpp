#pragma once

#include <Eigen/Core>

#include "log/log.hpp"

namespace offnominal::tools::discovery {

// Per sample 1, or 0 where the joint has stood still for kStandstillS or more: dry friction may
// hold it there, and then any torque within the friction does. All 1 where the encoder's resolution
// is not known (counts_per_unit 0), or where the joint stands still nearly all of the time, or at
// rest altogether: who never moves it wants to know what holding takes.
Eigen::VectorXd moving_samples(const Log& log, Eigen::Index joint, double counts_per_unit);

inline constexpr double kStandstillS = 0.5;

}  // namespace offnominal::tools::discovery
