#pragma once

#include <Eigen/Core>

#include "compare/filter_plan.hpp"
#include "log/log.hpp"

namespace offnominal::desk {

// Per sample 1, or 0 where the recording's left_out has it, with what the plan's filter spreads of
// it on either side. Rows: samples, columns: joints; no rows where nothing is left out.
Eigen::MatrixXd usable_samples(const Log& log, const FilterPlan& plan);

}  // namespace offnominal::desk
