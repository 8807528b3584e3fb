#include "log/hold_map.hpp"

namespace offnominal::desk {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

VectorXd approach_direction(const Eigen::Ref<const VectorXd>& q, double threshold) {
  VectorXd direction = VectorXd::Zero(q.size());
  // Until the joint has moved by the threshold both ends are candidates for where it began.
  Index lowest = 0;
  Index highest = 0;
  Index turn = 0;  // first reading after the last reversal
  double way = 0;
  for (Index i = 0; i < q.size(); ++i) {
    if (q[i] > q[highest]) highest = i;
    if (q[i] < q[lowest]) lowest = i;
    const bool rises = way <= 0 && q[i] - q[lowest] > threshold;
    const bool falls = way >= 0 && q[highest] - q[i] > threshold;
    if (!rises && !falls) continue;
    if (way != 0) {
      const Index extreme = rises ? lowest : highest;
      direction.segment(turn, extreme + 1 - turn).setConstant(way);
      turn = extreme + 1;
    }
    way = rises ? 1 : -1;
    lowest = i;
    highest = i;
  }
  direction.tail(q.size() - turn).setConstant(way);
  return direction;
}

void make_hold_map(Log& log) {
  constexpr double kThresholdShare = 0.01;
  const Index readings = log.q.rows();
  log.at_rest = true;
  log.period_s = 1;
  log.t_s = VectorXd::LinSpaced(readings, 0, static_cast<double>(readings - 1));
  log.dq = MatrixXd::Zero(readings, log.q.cols());
  log.dq_derived.assign(static_cast<std::size_t>(log.q.cols()), false);
  log.approach.resize(readings, log.q.cols());
  for (Index joint = 0; joint < log.q.cols(); ++joint) {
    const auto q = log.q.col(joint);
    const double range = q.maxCoeff() - q.minCoeff();
    log.approach.col(joint) = range > 0 ? approach_direction(q, kThresholdShare * range)
                                        : VectorXd(VectorXd::Zero(readings));
  }
}

}  // namespace offnominal::desk
