#pragma once

#include <Eigen/Core>

#include "compare/filter_plan.hpp"
#include "log/log.hpp"

namespace offnominal::desk {

// Per sample 1, or 0 where the recording's left_out has it of the joint, with what the plan's
// filter spreads of it on either side; empty where nothing is left out of any joint.
Eigen::VectorXd usable_samples(const Log& log, const FilterPlan& plan, Eigen::Index joint);

}  // namespace offnominal::desk
