#pragma once

#include <Eigen/Core>

#include "compare/motion.hpp"
#include "log/log.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk {

// Per sample 1, or 0 where the joint has stood still for kStandstillS or more: dry friction may
// hold it there, and then any torque within the friction does. All 1 where the encoder's resolution
// is not known (counts_per_unit 0), or at rest altogether.
Eigen::VectorXd samples_in_motion(const Log& log, Eigen::Index joint, double counts_per_unit);
// The same, but all 1 where the joint stands still nearly all of the time: who never moves it wants
// to know what holding takes.
Eigen::VectorXd moving_samples(const Log& log, Eigen::Index joint, double counts_per_unit);

inline constexpr double kStandstillS = 0.5;

// Sets `moving` to 0 also for moments in which the joint all but stands: slower than 2 % of
// `top_speed` for 0.1 s or more, and as long as the filter smears them. Friction there is what
// happens to hold the joint, by microscopic displacements. Steady slow motion for kStandstillS or
// more, whose speed never comes near zero, is kept: it shows friction at low speed as nothing else
// does. No change where less than a tenth of the samples would be left. `speed`: rad/s or m/s.
void leave_out_sticking(const Eigen::VectorXd& speed, double top_speed, double period_s,
                        Eigen::Ref<Eigen::VectorXd> moving);

// The share of the samples that are not faster than a joint's top speed.
inline constexpr double kTopSpeedShare = 0.99;

// Both, of one joint of a recording and its velocity in motion_of(), rad/s or m/s. Per sample 1
// or 0.
Eigen::VectorXd samples_that_tell(const Log& log, const RobotDescription& robot, Eigen::Index joint,
                                  const Eigen::VectorXd& speed);

}  // namespace offnominal::desk
