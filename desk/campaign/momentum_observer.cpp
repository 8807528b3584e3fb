#include "campaign/momentum_observer.hpp"

#include <offnominal/model/momentum.hpp>

#include "robot/chain_of.hpp"

namespace offnominal::desk::campaign {

Eigen::MatrixXd momentum_residual(const RobotDescription& robot, double gain_per_s,
                                  const Log& log) {
  using Numbers = Vector<kRuntimeJoints, double>;
  const auto model = make_model(chain_of<kRuntimeJoints, double>(robot));
  Eigen::MatrixXd residual(log.q.rows(), log.q.cols());
  Numbers r = Numbers::Zero(log.q.cols());
  Numbers integral = r;  // of the model's rate and of r
  Numbers first, rate_before;
  for (Eigen::Index row = 0; row < log.q.rows(); ++row) {
    const auto now = momentum_dynamics<kRuntimeJoints, double>(
        model, log.q.row(row).transpose(), log.dq.row(row).transpose(),
        log.tau.row(row).transpose(), log.t_s[row]);
    if (row == 0) {
      first = now.momentum;
    } else {
      // r is on both sides: solved for.
      const double half_s = 0.5 * log.period_s;
      integral += half_s * (rate_before + now.rate + r);
      r = gain_per_s / (1 + gain_per_s * half_s) * (now.momentum - first - integral);
      integral += half_s * r;
    }
    rate_before = now.rate;
    residual.row(row) = r;
  }
  return residual;
}

}  // namespace offnominal::desk::campaign
