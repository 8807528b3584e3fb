#include "explain/confirm.hpp"

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>

namespace offnominal::desk {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

VectorXd simulated_position_error(const Data& data, const VectorXd& residual) {
  constexpr double kWindowS = 0.5;
  const RowLayout& layout = data.layout;
  const Index joints = layout.joint_count();
  if (data.recordings[0].at_rest) {
    return VectorXd::Constant(joints, std::numeric_limits<double>::quiet_NaN());
  }
  const VectorXd error = layout.while_moving(residual);
  VectorXd sum = VectorXd::Zero(joints);
  double count = 0;
  for (std::size_t r = 0; r < layout.recording_count(); ++r) {
    const Workspace& at = data.recordings[r];
    const double h = layout.period_s(r);
    const Index n = layout.samples(r);
    std::vector<MatrixXd> mass;
    for (const MatrixXd& column : at.mass) {
      MatrixXd kept(n, joints);
      for (Index i = 0; i < joints; ++i) kept.col(i) = kept_samples(at.plan, column.col(i));
      mass.push_back(std::move(kept));
    }
    const auto window = std::max<Index>(2, std::lround(kWindowS / h));
    VectorXd position = VectorXd::Zero(joints);
    VectorXd velocity = VectorXd::Zero(joints);
    for (Index i = 0; i < n; ++i) {
      if (i % window == 0) {
        position.setZero();
        velocity.setZero();
      }
      MatrixXd m(joints, joints);
      VectorXd torque(joints);
      for (Index j = 0; j < joints; ++j) {
        m.col(j) = mass[static_cast<std::size_t>(j)].row(i).transpose();
        torque[j] = error[layout.begin(r, j) + i];
      }
      const VectorXd acceleration = m.ldlt().solve(torque);
      position += h * velocity + 0.5 * h * h * acceleration;
      velocity += h * acceleration;
      if (i % window == window - 1) {
        sum += position.cwiseAbs2();
        count += 1;
      }
    }
  }
  return count > 0 ? VectorXd((sum / count).cwiseSqrt()) : VectorXd::Zero(joints);
}

}  // namespace offnominal::desk
