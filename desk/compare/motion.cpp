#include "compare/motion.hpp"

#include "signal/differentiate.hpp"
#include "signal/zero_phase.hpp"

namespace offnominal::desk {

Motion motion_of(const Log& log, const FilterPlan& plan) {
  Motion motion{log.t_s, log.q, log.q, log.q};
  if (log.at_rest) {
    motion.dq.setZero();
    motion.ddq.setZero();
    return motion;
  }
  for (Eigen::Index joint = 0; joint < log.q.cols(); ++joint) {
    if (log.q.col(joint).maxCoeff() == log.q.col(joint).minCoeff()) {
      // A joint that is held: the filter's rounding must not pass for motion.
      motion.dq.col(joint).setZero();
      motion.ddq.col(joint).setZero();
      continue;
    }
    motion.q.col(joint) =
        zero_phase_low_pass(log.q.col(joint), plan.position_cutoff_hz, plan.sample_rate_hz);
    motion.dq.col(joint) = central_difference(motion.q.col(joint), log.period_s);
    motion.ddq.col(joint) = central_difference(motion.dq.col(joint), log.period_s);
  }
  return motion;
}

}  // namespace offnominal::desk
