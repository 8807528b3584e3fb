#include "campaign/accommodation.hpp"

namespace offnominal::desk::campaign {

Accommodation::Accommodation(const RobotDescription& robot, double period_s)
    : watch_(make_watch(robot, period_s, {})), joints_(robot.joint_count()) {}

sim::JointVector Accommodation::after(const Watch::Sample& sample, double t_s) {
  // A sample that is refused changes nothing: what was said of the one before stands.
  static_cast<void>(watch_->take(sample, t_s, 0));
  const std::optional<IsolatedFault> answer = watch_->answer();
  const bool acts = answer && answer->decided && is_compensated(answer->kind);
  if (!acts) return sim::JointVector::Zero(joints_);
  return watch_->said().compensation;
}

}  // namespace offnominal::desk::campaign
