#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "compare/compare.hpp"
#include "compare/error_variable.hpp"
#include "report/page.hpp"

namespace offnominal::desk {

// One model's torque, and how its curve is called.
struct NamedComparison {
  std::string name;  // "model", "with coulomb_friction"
  const Comparison* comparison = nullptr;
  report::Tone tone = report::Tone::kModel;
};

// Measured torque of one joint and that of every model over time. All comparisons are of one
// recording.
report::Chart torque_over_time(const std::vector<NamedComparison>& models, std::size_t joint);

// The residual of every model over time.
report::Chart residual_over_time(const std::vector<NamedComparison>& models, std::size_t joint);

// The residuals of a joint over a variable, sample by sample where it has a value, with the mean of
// each over 40 equally filled bins.
report::Chart residual_over(const std::vector<NamedComparison>& models, std::size_t joint,
                            const ErrorOver& over);

// A line through the means of `values` over 40 equally filled bins of `variable`; samples of which
// one is NaN are none.
report::Series binned_mean(const std::string& name, report::Tone tone,
                           const Eigen::Ref<const Eigen::VectorXd>& variable,
                           const Eigen::Ref<const Eigen::VectorXd>& values);

}  // namespace offnominal::desk
