#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <offnominal/model/effect.hpp>
#include <vector>

#include "compare/body_torque.hpp"
#include "compare/motion.hpp"
#include "robot/robot.hpp"

// A robot description's torques over a recorded motion: core's inverse dynamics, sample by sample.
// Results have the motion's rows and one column per joint, N m or N. A motion has as many joints as
// the robot, otherwise std::invalid_argument. A run begins at the motion's first sample: effects in
// time count from there, as the on-board monitor does.

namespace offnominal::desk {

// What the model needs for the motion, effects included, with rigid transmissions: what acts
// between motor and link is transmission_torque() (transmission.hpp).
Eigen::MatrixXd model_torque(const RobotDescription& robot, const Motion& motion);
// The same, to the bit, where `bodies` is of this motion.
Eigen::MatrixXd model_torque(const RobotDescription& robot, const Motion& motion,
                             BodyTorque& bodies);

// The share of one link's mass and inertia in it; linear in them.
Eigen::MatrixXd link_torque(const RobotDescription& robot, std::size_t link, const Motion& motion);

// True where an effect acts as a torque of its own joint, by the motion so far and the time.
bool is_torque_effect(EffectKind kind);

// True where an effect scales or delays what passes from the drive to the load of its own joint
// (core's torque_path.hpp, effect_memory.hpp).
bool is_path_effect(EffectKind kind);

// Some effect of the robot is one of these.
bool has_path_effect(const RobotDescription& robot);

// What the drive has to be told per torque more that it gives, and per torque more of the load, at
// every sample: 1 without path effects; and how much earlier.
struct ToldTorque {
  Eigen::VectorXd per_given;  // per joint
  Eigen::MatrixXd per_load;
  Eigen::VectorXd samples_ahead;  // per joint
};
ToldTorque told_torque(const RobotDescription& robot, const Motion& motion);

// The motion of the motors, rad, in the columns of their numbers: of a robot with a transmission.
Motion motor_motion(const RobotDescription& robot, const Motion& motion);

// A joint that a motor moves, and how much the motor turns per rad or m of it: what a torque of the
// motor has to be multiplied by to be the joint's.
struct MovedJoint {
  Eigen::Index joint = 0;
  double motor_per_joint = 0;
};
std::vector<MovedJoint> joints_of_motor(const RobotDescription& robot, std::size_t motor);

// Whether an effect of the robot acts on a joint: its own, or one of a motor that moves the joint.
bool acts_on_joint(const RobotDescription& robot, const RobotEffect& effect, Eigen::Index joint);
// The same of an effect that acts there as one of the joint's own would: of a motor that moves this
// joint and no other.
bool is_of_joint(const RobotDescription& robot, const RobotEffect& effect, Eigen::Index joint);

// The torque of one torque effect on its own joint, of the given type; for an effect of a motor
// that of the motor, where the motion is the motors'. The run that its time counts
// from began at `start_s`, on the motion's clock.
Eigen::VectorXd torque_of_effect(const Effect<double>& effect, JointType type, const Motion& motion,
                                 double start_s);
// The same of a run that began at the motion's first sample.
Eigen::VectorXd torque_of_effect(const Effect<double>& effect, JointType type,
                                 const Motion& motion);

// The friction of one effect by what passes from drive to load, on its own joint with this load
// over the motion, N m or N.
Eigen::VectorXd friction_of_load(const Effect<double>& effect, const Motion& motion,
                                 const Eigen::Ref<const Eigen::VectorXd>& load);

// The inertia that an effect adds to its own joint alone, kg m^2 or kg; 0 for all others.
double reflected_inertia_of(const Effect<double>& effect);

// What an inertial effect adds to the torque of every joint.
Eigen::MatrixXd torque_of_inertial_effect(const RobotDescription& robot,
                                          const Effect<double>& effect, const Motion& motion);

}  // namespace offnominal::desk
