#include "compare/inverse_model.hpp"

#include <algorithm>
#include <cmath>
#include <offnominal/model/effect_memory.hpp>
#include <offnominal/model/inverse_dynamics.hpp>
#include <stdexcept>

#include "robot/chain_of.hpp"
#include "robot/transmission.hpp"
#include "signal/shift.hpp"

namespace offnominal::desk {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

// Of an effect with a state, along the way that its joint goes; the state is 0 where the way
// begins.
template <typename E>
VectorXd torque_along(const std::array<double, kMaxEffectParameters>& parameters,
                      const Eigen::Ref<const VectorXd>& q) {
  VectorXd torque(q.size());
  double z = 0;
  for (Index i = 0; i < q.size(); ++i) {
    if (i > 0) z = E::next_state(parameters, z, q[i] - q[i - 1]);
    torque[i] = E::torque_of_state(parameters, z);
  }
  return torque;
}

using Joints = Vector<kRuntimeJoints, double>;

// Per joint, how many samples later than it is logged its torque acts.
VectorXd delays_in_samples(const Chain<kRuntimeJoints, double>& chain, const Motion& motion) {
  VectorXd samples = VectorXd::Zero(static_cast<Index>(chain.joints.size()));
  if (motion.sample_count() < 2) return samples;
  for (Index joint = 0; joint < samples.size(); ++joint) {
    samples[joint] = delay_of_joint(chain, static_cast<std::size_t>(joint)) / motion.period_s();
  }
  return samples;
}

using Model = decltype(make_model(Chain<kRuntimeJoints, double>()));

Model model_for(const RobotDescription& robot, const Motion& motion) {
  if (motion.q.cols() != robot.joint_count()) {
    throw std::invalid_argument("the motion has another number of joints than the robot");
  }
  return make_model(chain_of<kRuntimeJoints, double>(robot));
}

// Sets the rows of `torque` from `first` on, one for each row of `rigid`, the bodies' torque there:
// with every effect that follows from a sample alone.
void torque_of_drives(const Model& model, const Motion& motion,
                      const Eigen::Ref<const MatrixXd>& rigid, Index first, MatrixXd& torque) {
  for (Index row = 0; row < rigid.rows(); ++row) {
    const Index i = first + row;
    const Joints q = motion.q.row(i);
    const Joints dq = motion.dq.row(i);
    const Joints of_bodies = rigid.row(row);
    const auto effects = joint_effects(model, q, dq, motion.t_s[i] - motion.t_s[0]);
    torque.row(i) = drive_torque<kRuntimeJoints, double>(model, effects, of_bodies);
  }
}

// What follows from the whole motion: effects with a state, and delays.
void add_what_remembers(const RobotDescription& robot, const Model& model, const Motion& motion,
                        MatrixXd& torque) {
  for (const RobotEffect& effect : robot.effects) {
    if (!remembers(effect.kind) || !is_torque_effect(effect.kind)) continue;
    const JointType type = robot.joints[effect.joint].joint.type;
    torque.col(effect.joint) +=
        model.told_per_given[effect.joint] * torque_of_effect(effect, type, motion);
  }
  const VectorXd delays = delays_in_samples(chain_of<kRuntimeJoints, double>(robot), motion);
  for (Index joint = 0; joint < delays.size(); ++joint) {
    if (delays[joint] != 0) torque.col(joint) = ahead_by(torque.col(joint), delays[joint]);
  }
}

// Its joints alone: what has no mass takes no torque.
RobotDescription without_masses(const RobotDescription& robot) {
  RobotDescription bare = robot;
  bare.effects.clear();
  for (RobotJoint& one : bare.joints) {
    one.joint.mass_kg = 0;
    one.joint.inertia_kg_m2 = {};
  }
  return bare;
}

}  // namespace

MatrixXd model_torque(const RobotDescription& robot, const Motion& motion) {
  const Model model = model_for(robot, motion);
  MatrixXd torque(motion.sample_count(), robot.joint_count());
  for_stretches(motion, [&](Index first, Index count) {
    const MatrixXd rigid = BodyTorque().of(robot, motion.part(first, count));
    torque_of_drives(model, motion, rigid, first, torque);
  });
  add_what_remembers(robot, model, motion, torque);
  return torque;
}

MatrixXd model_torque(const RobotDescription& robot, const Motion& motion, BodyTorque& bodies) {
  const Model model = model_for(robot, motion);
  MatrixXd torque(motion.sample_count(), robot.joint_count());
  const MatrixXd rigid = bodies.of(robot, motion);
  for_stretches(motion, [&](Index first, Index count) {
    torque_of_drives(model, motion, rigid.middleRows(first, count), first, torque);
  });
  add_what_remembers(robot, model, motion, torque);
  return torque;
}

MatrixXd link_torque(const RobotDescription& robot, std::size_t link, const Motion& motion) {
  RobotDescription only = without_masses(robot);
  only.joints[link] = robot.joints[link];
  return model_torque(only, motion);
}

bool is_torque_effect(EffectKind kind) {
  const EffectAction action = info_of(kind)->action;
  return action == EffectAction::kTorque || action == EffectAction::kTorqueOfState;
}

bool is_path_effect(EffectKind kind) {
  const EffectInfo& info = *info_of(kind);
  return info.acts_on_whole_drive() || info.action == EffectAction::kFrictionPerLoad;
}

bool has_path_effect(const RobotDescription& robot) {
  return std::any_of(robot.effects.begin(), robot.effects.end(),
                     [](const RobotEffect& effect) { return is_path_effect(effect.kind); });
}

ToldTorque told_torque(const RobotDescription& robot, const Motion& motion) {
  const auto chain = chain_of<kRuntimeJoints, double>(robot);
  const auto model = make_model(chain);
  ToldTorque told{model.told_per_given, MatrixXd(motion.sample_count(), robot.joint_count()),
                  delays_in_samples(chain, motion)};
  for_stretches(motion, [&](Index first, Index count) {
    for (Index i = first; i < first + count; ++i) {
      const Joints q = motion.q.row(i);
      const Joints dq = motion.dq.row(i);
      const Joints ddq = motion.ddq.row(i);
      const auto effects = joint_effects(model, q, dq, motion.t_s[i] - motion.t_s[0]);
      const Joints load = rigid_body_torque(model, joint_transforms(model, q), dq, ddq);
      told.per_load.row(i) = told_per_load(model, effects, load);
    }
  });
  return told;
}

Motion motor_motion(const RobotDescription& robot, const Motion& motion) {
  const MatrixXd to_motors = motor_per_joint(*robot.transmission).transpose();
  Motion motors{motion.t_s, motion.q * to_motors, motion.dq * to_motors, motion.ddq * to_motors};
  motors.q.rowwise() += motor_offset_rad(*robot.transmission).transpose();
  return motors;
}

std::vector<MovedJoint> joints_of_motor(const RobotDescription& robot, std::size_t motor) {
  const MatrixXd matrix = motor_per_joint(*robot.transmission);
  std::vector<MovedJoint> joints;
  for (Index joint = 0; joint < matrix.cols(); ++joint) {
    const double per_joint = matrix(static_cast<Index>(motor), joint);
    if (per_joint != 0) joints.push_back({joint, per_joint});
  }
  return joints;
}

bool acts_on_joint(const RobotDescription& robot, const RobotEffect& effect, Index joint) {
  if (!effect.of_motor) return static_cast<Index>(effect.joint) == joint;
  const std::vector<MovedJoint> moved = joints_of_motor(robot, effect.joint);
  return std::any_of(moved.begin(), moved.end(),
                     [&](const MovedJoint& one) { return one.joint == joint; });
}

bool is_of_joint(const RobotDescription& robot, const RobotEffect& effect, Index joint) {
  const bool shared = effect.of_motor && joints_of_motor(robot, effect.joint).size() > 1;
  return !shared && acts_on_joint(robot, effect, joint);
}

VectorXd torque_of_effect(const Effect<double>& effect, JointType type, const Motion& motion,
                          double start_s) {
  const auto joint = static_cast<Index>(effect.joint);
  VectorXd torque = VectorXd::Zero(motion.sample_count());
  if (!source_joint_valid(effect, static_cast<int>(motion.q.cols()))) return torque;
  visit_effect(effect.kind, [&]<typename E>() {
    auto parameters = effect.parameters;
    if constexpr (requires { E::prepare(parameters, type); }) E::prepare(parameters, type);
    if constexpr (offnominal::detail::kHasState<E>) {
      torque = torque_along<E>(parameters, motion.q.col(joint));
    } else if constexpr (requires(JointInstant<double> at) { E::torque(parameters, at); }) {
      for (Index i = 0; i < motion.sample_count(); ++i) {
        JointInstant<double> at{motion.q(i, joint), motion.dq(i, joint), motion.t_s[i] - start_s};
        if constexpr (kHasSource<E>) at.source_dq = motion.dq(i, source_joint<E>(parameters));
        torque[i] = E::torque(parameters, at);
      }
    }
  });
  return torque;
}

VectorXd torque_of_effect(const Effect<double>& effect, JointType type, const Motion& motion) {
  return torque_of_effect(effect, type, motion, motion.sample_count() > 0 ? motion.t_s[0] : 0);
}

VectorXd friction_of_load(const Effect<double>& effect, const Motion& motion,
                          const Eigen::Ref<const VectorXd>& load) {
  const auto joint = static_cast<Index>(effect.joint);
  VectorXd friction = VectorXd::Zero(motion.sample_count());
  visit_effect(effect.kind, [&]<typename E>() {
    if constexpr (offnominal::detail::action_of<E>() == EffectAction::kFrictionPerLoad) {
      for (Index i = 0; i < motion.sample_count(); ++i) {
        const JointInstant<double> at{motion.q(i, joint), motion.dq(i, joint), 0};
        const auto per_load = E::friction_per_load(effect.parameters, at);
        friction[i] = per_load.by_size * std::abs(load[i]) + per_load.by_load * load[i];
      }
    }
  });
  return friction;
}

double reflected_inertia_of(const Effect<double>& effect) {
  double inertia = 0;
  visit_effect(effect.kind, [&]<typename E>() {
    if constexpr (offnominal::detail::action_of<E>() == EffectAction::kReflectedInertia) {
      inertia = E::reflected_inertia(effect.parameters);
    }
  });
  return inertia;
}

MatrixXd torque_of_inertial_effect(const RobotDescription& robot, const Effect<double>& effect,
                                   const Motion& motion) {
  const bool is_of_joint_alone =
      info_of(effect.kind)->action == EffectAction::kReflectedInertia && !effect.of_motor;
  if (is_of_joint_alone) {
    const auto joint = static_cast<Index>(effect.joint);
    MatrixXd torque = MatrixXd::Zero(motion.q.rows(), motion.q.cols());
    torque.col(joint) = reflected_inertia_of(effect) * motion.ddq.col(joint);
    return torque;
  }
  RobotDescription only = without_masses(robot);
  only.effects.push_back({effect});
  return model_torque(only, motion);
}

}  // namespace offnominal::desk
