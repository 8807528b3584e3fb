#include "compare/compare.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace offnominal::desk {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

double percent_of(double part, double whole) {
  return whole > 0 ? 100 * part / whole : std::numeric_limits<double>::quiet_NaN();
}

// What `error`, of the samples that tell, follows: largest share first.
std::vector<ErrorShare> followed(const Comparison& all, const Measurement& of, Index joint,
                                 const VectorXd& error) {
  const auto share = [&](const auto& variable) {
    return share_explained(of.while_moving(variable, joint), error);
  };
  std::vector<ErrorShare> where{{"position", share(all.q.col(joint))},
                                {"velocity", share(all.dq.col(joint))},
                                {"acceleration", share(all.ddq.col(joint))},
                                {"time", share(all.t_s)}};
  std::stable_sort(where.begin(), where.end(),
                   [](const ErrorShare& a, const ErrorShare& b) { return a.share > b.share; });
  return where;
}

JointComparison compare_joint(const Comparison& all, const Measurement& of,
                              const RobotDescription& robot, Index joint) {
  const auto while_moving = [&](const auto& values) { return of.while_moving(values, joint); };
  const VectorXd measured = while_moving(all.measured.col(joint));
  const VectorXd error = measured - while_moving(all.model.col(joint));
  const double root_n = std::sqrt(static_cast<double>(measured.size()));
  JointComparison result;
  result.joint = static_cast<std::size_t>(joint);
  result.unit = unit_of(Quantity::kEffort, robot.joints[result.joint].joint.type);
  result.rms_error = error.norm() / root_n;
  result.rms_torque = measured.norm() / root_n;
  result.relative_error_percent = percent_of(error.norm(), measured.norm());
  const double spread = (measured.array() - measured.mean()).matrix().norm();
  // Rounding makes the spread of a constant a little more than 0.
  const bool constant = spread <= 1e-12 * measured.norm();
  result.fit_percent = 100 - percent_of(error.norm(), constant ? 0 : spread);
  result.left_out = 1 - static_cast<double>(measured.size()) / static_cast<double>(all.t_s.size());
  result.where = followed(all, of, joint, error);
  if (of.log.has_both(result.joint)) {
    const VectorXd gear = measured - while_moving(of.sensor_torque.col(joint));
    std::vector<ErrorShare> follows = followed(all, of, joint, gear);
    // Whatever is smooth follows the time; a gear is known by its motion.
    std::erase_if(follows, [](const ErrorShare& one) { return one.variable == "time"; });
    result.gear = GearTorque{gear.norm() / root_n, percent_of(gear.norm(), measured.norm()),
                             std::move(follows.front())};
  }
  return result;
}

}  // namespace

Comparison compare(const RobotDescription& robot, const Measurement& measured) {
  Comparison result;
  result.plan = measured.plan;
  result.t_s = measured.t_s;
  result.measured = measured.torque;
  result.model = filtered_model_torque(robot, measured);
  result.remarks = measured.log.remarks;
  const auto kept = [&](const MatrixXd& columns) {
    MatrixXd samples(result.t_s.size(), columns.cols());
    for (Index joint = 0; joint < columns.cols(); ++joint) {
      samples.col(joint) = kept_samples(measured.plan, columns.col(joint));
    }
    return samples;
  };
  result.q = kept(measured.motion.q);
  result.dq = kept(measured.motion.dq);
  result.ddq = kept(measured.motion.ddq);
  for (Index joint = 0; joint < result.measured.cols(); ++joint) {
    result.joints.push_back(compare_joint(result, measured, robot, joint));
  }
  return result;
}

double share_explained(const Eigen::Ref<const VectorXd>& variable,
                       const Eigen::Ref<const VectorXd>& values, int bins) {
  const Index n = values.size();
  const double mean = values.mean();
  const double energy = (values.array() - mean).square().sum();
  if (!(energy > 0) || variable.maxCoeff() == variable.minCoeff()) return 0;
  std::vector<Index> order(static_cast<std::size_t>(n));
  std::iota(order.begin(), order.end(), Index{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](Index a, Index b) { return variable[a] < variable[b]; });
  double between = 0;
  for (int bin = 0; bin < bins; ++bin) {
    const Index first = n * bin / bins;
    const Index end = n * (bin + 1) / bins;
    if (first == end) continue;
    double sum = 0;
    for (Index i = first; i < end; ++i) sum += values[order[static_cast<std::size_t>(i)]] - mean;
    between += sum * sum / static_cast<double>(end - first);
  }
  return std::min(between / energy, 1.0);
}

}  // namespace offnominal::desk
