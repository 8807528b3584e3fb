#include "sil/not_held.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <offnominal/model/inverse_dynamics.hpp>
#include <offnominal/model/mass_matrix.hpp>
#include <offnominal/model/quantity.hpp>

#include "common/amount.hpp"
#include "robot/chain_of.hpp"
#include "robot/monitor_config_of.hpp"

namespace offnominal::desk::sil {
namespace {

using Eigen::Index;
using Joints = Vector<kRuntimeJoints, double>;

constexpr int kDigits = 3;

// What a robot file says of an arm that is to stand still, per joint.
struct AtRest {
  Joints weight;             // torque that holds it, N m or N
  Joints inertia;            // that its drive moves while the others give way, kg m^2 or kg
  Eigen::MatrixXd mobility;  // accelerations per torque
  Joints friction_slope;     // of the torque over the speed around 0, N m s/rad or N s/m
};

AtRest at_rest(const RobotDescription& robot, const std::vector<RobotEffect>& hidden,
               const sim::JointVector& pose) {
  constexpr double kCreep = 1e-9;  // the least `smoothing` that a file may have
  RobotDescription whole = robot;
  whole.effects.insert(whole.effects.end(), hidden.begin(), hidden.end());
  const auto model = make_model(chain_of<kRuntimeJoints, double>(whole));
  const Joints& q = pose;
  const Joints none = Joints::Zero(q.size());
  AtRest arm;
  arm.weight = inverse_dynamics(model, q, none, none, 0.0);
  const Eigen::MatrixXd mass = mass_matrix(model, q);
  arm.mobility = mass.llt().solve(Eigen::MatrixXd::Identity(mass.rows(), mass.cols()));
  arm.inertia = arm.mobility.diagonal().cwiseInverse();
  arm.friction_slope = none;
  for (Index joint = 0; joint < q.size(); ++joint) {
    Joints dq = none;
    dq[joint] = kCreep;
    const Joints moving = inverse_dynamics(model, q, dq, none, 0.0);
    arm.friction_slope[joint] = (moving[joint] - arm.weight[joint]) / kCreep;
  }
  return arm;
}

class Causes {
 public:
  Causes(const RobotDescription& robot, const Scenario& scenario, const sim::JointVector& pose)
      : robot_(robot),
        scenario_(scenario),
        arming_(arming_of<kRuntimeJoints, double>(robot)),
        pose_(pose),
        known_(at_rest(robot, {}, pose)) {}

  [[nodiscard]] std::vector<std::string> all() {
    too_weak();
    too_slow();
    another_plant();
    too_sharp();
    too_stiff();
    return found_;
  }

 private:
  [[nodiscard]] const Joint<double>& joint(Index at) const {
    return robot_.joints[static_cast<std::size_t>(at)].joint;
  }
  [[nodiscard]] std::string name(Index at) const {
    return fmt::format("joint {} ({})", at + 1, robot_.joints[static_cast<std::size_t>(at)].name);
  }
  [[nodiscard]] std::string effort(Index at, double torque) const {
    return significant(torque, kDigits) + " " + unit_of(Quantity::kEffort, joint(at).type);
  }

  // Its weight is more than its drive may give.
  void too_weak() {
    for (Index at = 0; at < pose_.size(); ++at) {
      const double weight = std::abs(known_.weight[at]);
      if (!(weight > joint(at).max_torque)) continue;
      found_.push_back(fmt::format(
          "{} has {} to carry where the motion begins, and `torque` of its [joint.limits] is {}: "
          "raise that, or begin where it carries less",
          name(at), effort(at, weight), effort(at, joint(at).max_torque)));
    }
  }

  // It falls until the torque that carries it is in, and then is caught.
  void too_slow() {
    constexpr double kOfWindow = 0.3;
    constexpr double kWanted = 0.3;
    Joints impulse(pose_.size());  // of what is not carried yet
    Joints ramp_s(pose_.size());
    for (Index at = 0; at < pose_.size(); ++at) {
      const double weight = known_.weight[at];
      ramp_s[at] = std::abs(weight) / arming_.torque_rate[static_cast<std::size_t>(at)];
      impulse[at] = weight * ramp_s[at] / 2;
    }
    const Joints speed = known_.mobility * impulse;
    double of_window = 0;
    for (Index at = 0; at < pose_.size(); ++at) {
      const auto number = static_cast<std::size_t>(at);
      // The most that a critically damped joint goes on after a blow.
      const double caught_s = 1 / (std::numbers::e * std::sqrt(robot_.joints[number].kp));
      const double way = std::abs(speed[at]) * (2 * ramp_s.maxCoeff() / 3 + caught_s);
      of_window = std::max(of_window, way / arming_.position_window[number]);
    }
    if (!(of_window > kOfWindow)) return;
    Index slowest = 0;
    ramp_s.maxCoeff(&slowest);
    const double rate = arming_.torque_rate[static_cast<std::size_t>(slowest)];
    found_.push_back(fmt::format(
        "the arm falls until its weight is carried: {} has {} to carry, which takes {} s at its "
        "torque_rate of {}/s: raise torque_rate of [arming] {:.0f} times, on every joint, or widen "
        "position_window",
        name(slowest), effort(slowest, std::abs(known_.weight[slowest])),
        significant(ramp_s[slowest], kDigits), effort(slowest, rate),
        std::max(2.0, std::ceil(of_window / kWanted))));
  }

  // The arm is not the one that the controller's file describes.
  void another_plant() {
    if (scenario_.mujoco || !scenario_.plant) return;
    constexpr double kUnlike = 1.1;
    const AtRest real = at_rest(*scenario_.plant, scenario_.hidden, pose_);
    for (Index at = 0; at < pose_.size(); ++at) {
      const double lifted = real.weight[at] - known_.weight[at];
      const double inertia = real.inertia[at] / known_.inertia[at];
      const bool weighs = std::abs(lifted) > (kUnlike - 1) * std::abs(known_.weight[at]) &&
                          std::abs(lifted) > kOfLimit * joint(at).max_torque;
      const bool heavier = inertia > kUnlike || inertia < 1 / kUnlike;
      if (!weighs && !heavier) continue;
      found_.push_back(
          fmt::format("the plant is another arm than the controller's file says: {} carries {} "
                      "there and not {}, and moves {} times the inertia: give --robot the file of "
                      "that arm, or --plant the controller's",
                      name(at), effort(at, real.weight[at]), effort(at, known_.weight[at]),
                      significant(inertia, kDigits)));
      return;
    }
  }

  // Torque that the controller adds for friction comes a period late; it pushes a plant that does
  // not have as much.
  void too_sharp() {
    Joints excess = known_.friction_slope;
    if (scenario_.plant && !scenario_.mujoco) {
      excess -= at_rest(*scenario_.plant, scenario_.hidden, pose_).friction_slope;
    }
    for (Index at = 0; at < pose_.size(); ++at) {
      const double times = excess[at] * robot_.estimator.period_s / known_.inertia[at];
      if (!(times > 1)) continue;
      found_.push_back(fmt::format(
          "the controller adds friction to {} that the plant has less of, changes its sign over so "
          "small a speed that a period of {} s is too long for it ({} times what the inertia "
          "bears), and shakes the joint: widen `smoothing` of its friction, or shorten period_s of "
          "[estimator]",
          name(at), significant(robot_.estimator.period_s, kDigits), significant(times, kDigits)));
    }
  }

  void too_stiff() {
    constexpr double kMost = 0.5;  // of a loop that is a period late, with room
    for (Index at = 0; at < pose_.size(); ++at) {
      const double per_period =
          robot_.joints[static_cast<std::size_t>(at)].kd * robot_.estimator.period_s;
      if (!(per_period > kMost)) continue;
      found_.push_back(
          fmt::format("kd_per_s of {} takes {} of its speed away in one period of {} s, and more "
                      "than {} swings: lower the gains of [joint.control], or shorten period_s",
                      name(at), significant(per_period, kDigits),
                      significant(robot_.estimator.period_s, kDigits), kMost));
    }
  }

  static constexpr double kOfLimit = 0.01;

  const RobotDescription& robot_;
  const Scenario& scenario_;
  ArmingConfig<kRuntimeJoints, double> arming_;
  const sim::JointVector& pose_;
  AtRest known_;
  std::vector<std::string> found_;
};

}  // namespace

NotHeld not_held(const RobotDescription& robot, const Scenario& scenario,
                 const sim::JointState& before, const sim::JointState& after) {
  const auto arming = arming_of<kRuntimeJoints, double>(robot);
  NotHeld arm;
  double furthest = -1;
  double fastest = -1;
  for (Index at = 0; at < before.q.size(); ++at) {
    const auto joint = static_cast<std::size_t>(at);
    const double moved = std::abs(after.q[at] - before.q[at]);
    const double speed = std::abs(after.dq[at]);
    const bool left = moved > arming.position_window[joint];
    // Of joints that have not left their windows the fastest kept the arm from being at rest.
    const double far = left ? moved / arming.position_window[joint] : 0;
    const double fast = speed / arming.speed[joint];
    if (far < furthest || (far == furthest && fast <= fastest)) continue;
    furthest = far;
    fastest = fast;
    arm.joint = joint;
    arm.moved = moved;
    arm.speed = speed;
    arm.window = arming.position_window[joint];
    arm.speed_limit = arming.speed[joint];
  }
  const RobotJoint& worst = robot.joints[arm.joint];
  arm.name = worst.name;
  arm.unit = unit_of(Quantity::kPosition, worst.joint.type);
  arm.causes = Causes(robot, scenario, before.q).all();
  return arm;
}

std::string words_of(const NotHeld& arm) {
  const std::string joint = fmt::format("joint {} ({})", arm.joint + 1, arm.name);
  if (arm.moved > arm.window) {
    return fmt::format(
        "{} moved by {} {} before the torque that holds it was in, and its "
        "position_window of [arming] is {} {}",
        joint, significant(arm.moved, kDigits), arm.unit, significant(arm.window, kDigits),
        arm.unit);
  }
  return fmt::format(
      "{} did not come to rest: it moved at {} {}/s when the time to do so was over, "
      "and `speed` of [arming] is {} {}/s",
      joint, significant(arm.speed, kDigits), arm.unit, significant(arm.speed_limit, kDigits),
      arm.unit);
}

}  // namespace offnominal::desk::sil
