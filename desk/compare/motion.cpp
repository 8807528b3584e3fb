#include "compare/motion.hpp"

#include <cstddef>

#include "signal/decimate.hpp"
#include "signal/differentiate.hpp"
#include "signal/zero_phase.hpp"

namespace offnominal::desk {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

void set_joint(Motion& motion, Index joint, const JointMotion& of_joint, Index stride) {
  const auto rows = Eigen::seq(0, of_joint.q.size() - 1, stride);
  motion.q.col(joint) = of_joint.q(rows);
  motion.dq.col(joint) = of_joint.dq(rows);
  motion.ddq.col(joint) = of_joint.ddq(rows);
}

}  // namespace

JointMotion motion_of_joint(const Log& log, const FilterPlan& plan, Index joint) {
  const auto q = log.q.col(joint);
  if (log.at_rest || q.maxCoeff() == q.minCoeff()) {
    // Of a joint that is held the filter's rounding must not pass for motion.
    return {q, VectorXd::Zero(q.size()), VectorXd::Zero(q.size())};
  }
  JointMotion motion;
  motion.q = zero_phase_low_pass(q, plan.position_cutoff_hz, plan.sample_rate_hz);
  motion.dq = central_difference(motion.q, log.period_s);
  motion.ddq = central_difference(motion.dq, log.period_s);
  return motion;
}

Motion motion_of(const Log& log, const FilterPlan& plan) { return thin_motion_of(log, plan, 1); }

Motion thin_motion_of(const Log& log, const FilterPlan& plan, Index stride) {
  Motion motion;
  motion.t_s = every_nth(log.t_s, stride);
  for (MatrixXd* const one : {&motion.q, &motion.dq, &motion.ddq}) {
    one->resize(motion.t_s.size(), log.q.cols());
  }
  for_every_column(log.q, [&](Index joint) {
    set_joint(motion, joint, motion_of_joint(log, plan, joint), stride);
  });
  return motion;
}

}  // namespace offnominal::desk
