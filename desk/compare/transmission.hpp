#pragma once

#include <Eigen/Core>

#include "compare/filter_plan.hpp"
#include "compare/motion.hpp"
#include "robot/robot.hpp"

// Between motor and link: the position that is measured is the motor's, and where a transmission
// gives way or has play the link is behind it. What a drive has to supply there follows from the
// motion and, of what gives way, from the torque that was measured: differentiating a position four
// times gives no torque.

namespace offnominal::desk {

// q_motor - q_link of a joint and its derivatives, rad or m; one row per sample of a motion.
struct Displacement {
  Eigen::VectorXd x, dx, ddx;
};
// Central differences at `period_s`.
Displacement displacement_of(Eigen::VectorXd x, double period_s);

// Where a spring acts, in joints: its torque is `from_torques` times theirs, and its displacement
// by 1 is `along` in them. With the matrix A of the transmission, tau = A^T tau_m and dq_m = A dq:
// of a motor, whose number `index` is then, both are a column of A^-1.
struct SpringPlace {
  Eigen::VectorXd from_torques;
  Eigen::VectorXd along;
};
SpringPlace place_of_spring(const RobotDescription& robot, Eigen::Index index, bool of_motor);

// What a displacement times `scale` changes in the torque of every joint, per scale. `along`: by
// how much of it each joint is displaced; of one joint a unit vector. `rigid`: the robot without
// effects, `load` its torque over the motion.
Eigen::MatrixXd torque_of_displacement(const RobotDescription& rigid, const Motion& motion,
                                       const Eigen::MatrixXd& load, const Eigen::VectorXd& along,
                                       const Displacement& by, double scale = 1);

// A transmitted torque in as wide a band as its noise allows: twice differentiated the noise must
// stay below a tenth of what is really there, or what gives way would be found in noise. `density`:
// of the noise, per root hertz; `plan` at the torque's sampling rate.
Eigen::VectorXd without_noise(const Eigen::VectorXd& transmitted, double density,
                              const FilterPlan& plan);

// Displacement of motor against link by a play of that full width while the motor moves as
// measured: at one side the two move together; where the transmitted torque would change its sign
// they part, and the link moves under its own load until the other side is reached, without
// rebound. `inertia`: what the joint's own acceleration asks of it, per sample.
Eigen::VectorXd play_displacement(const Eigen::Ref<const Eigen::VectorXd>& load,
                                  const Eigen::Ref<const Eigen::VectorXd>& inertia, double width,
                                  const FilterPlan& plan);

// Noise density of a signal from what a low-pass takes away, as if white, per root hertz; 0 where
// the low-pass takes nothing. `usable`: 1 or 0 per sample, empty for all of them.
double noise_density(const Eigen::VectorXd& raw, const Eigen::VectorXd& smooth,
                     const Eigen::VectorXd& usable, const FilterPlan& plan);

// Some effect of the robot acts between motor and link.
bool has_transmission_effect(const RobotDescription& robot);

// What the robot's effects between motor and link add to model_torque(), which takes transmissions
// for rigid. `stiff`: that torque; `measured`: what the drives gave, rows as of the motion;
// `density`: of its noise, per joint; `plan` at the motion's sampling rate.
Eigen::MatrixXd transmission_torque(const RobotDescription& robot, const Motion& motion,
                                    const Eigen::MatrixXd& stiff, const Eigen::MatrixXd& measured,
                                    const Eigen::VectorXd& density, const FilterPlan& plan);

}  // namespace offnominal::desk
