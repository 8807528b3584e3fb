#include <fmt/format.h>

#include <Eigen/QR>
#include <algorithm>
#include <offnominal/model/quantity.hpp>
#include <optional>
#include <string>
#include <vector>

#include "compare/inverse_model.hpp"
#include "explain/doctor_checks.hpp"
#include "explain/doctor_signal.hpp"
#include "robot/payload.hpp"
#include "robot/robot.hpp"
#include "signal/norm_about_mean.hpp"

// Torques that nobody recorded: one value in every row of a joint that moves.

namespace offnominal::desk {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

double way_of(const VectorXd& q) { return q.maxCoeff() - q.minCoeff(); }

// Further than a brake or a gear's play lets a joint move.
bool is_moved(const VectorXd& q) {
  constexpr double kWay = 0.02;  // rad or m
  return way_of(q) > kWay && !stands_still(q);
}

// Whether no joint moves so under a constant torque, whatever its friction: gravity and inertia ask
// for a torque that changes. Of a joint that swings or runs out freely they take each other off.
bool is_impossible(const TorquePair& pair, const MatrixXd& gravity, Index joint) {
  constexpr double kUnlike = 0.4;  // of the larger of the two
  MatrixXd friction(pair.dq.rows(), 3);
  friction << friction_columns(pair.dq.col(joint)), VectorXd::Ones(pair.dq.rows());
  const VectorXd asked = pair.load.col(joint);
  const VectorXd left = asked - friction * friction.colPivHouseholderQr().solve(asked);
  const double part =
      std::max(norm_about_mean(gravity.col(joint)), norm_about_mean(asked - gravity.col(joint)));
  return part > 0 && left.norm() > kUnlike * part;
}

// What gravity alone asks for.
MatrixXd gravity_in(const TorquePair& pair, const Log& log, const RobotDescription& robot) {
  RobotDescription rigid = robot;
  rigid.effects.clear();
  rigid = carrying(rigid, log.payload);
  const MatrixXd still = MatrixXd::Zero(pair.q.rows(), pair.q.cols());
  return model_torque(rigid, {pair.t_s, pair.q, still, still});
}

// `impossible`: no drive gives this torque over this motion. Else it may have none at all.
DataFault unrecorded(const Log& log, const RobotDescription& robot, Index joint,
                     const VectorXd& asked, bool impossible) {
  const JointType type = robot.joints[static_cast<std::size_t>(joint)].joint.type;
  DataFault fault;
  fault.kind = DataFaultKind::kStuck;
  fault.joint = joint;
  fault.signal = FaultySignal::kTorque;
  fault.size = 1;
  set_spans(log, {{0, log.sample_count() - 1}}, fault);
  fault.words = fmt::format(
      "the torque of joint {} was never recorded{}: it is {:.4g} in every row, while the joint "
      "moves "
      "over {:.3g} {} and the model's torque changes by {:.3g} {}",
      joint + 1, impossible ? "" : ", or it has no drive", log.tau(0, joint) + 0.0,
      way_of(log.q.col(joint)), unit_of(Quantity::kPosition, type), way_of(asked),
      unit_of(Quantity::kEffort, type));
  fault.mend =
      "log the torque that acts, or the motor current, and look at the channel that it is read "
      "from; what a hand or another machine moves tells nothing of torques; --keep " +
      keep_text_of(fault) + " takes it as it is";
  return fault;
}

}  // namespace

void find_unrecorded_torques(const Log& log, const Log& even, const RobotDescription& robot,
                             std::vector<DataFault>& faults) {
  std::vector<Index> constant;
  for (Index joint = 0; joint < log.tau.cols(); ++joint) {
    const auto tau = log.tau.col(joint);
    if ((tau.array() == tau[0]).all() && is_moved(log.q.col(joint))) constant.push_back(joint);
  }
  if (constant.empty()) return;
  const bool others_change =
      (log.tau.colwise().maxCoeff().array() > log.tau.colwise().minCoeff().array()).any();
  const std::optional<TorquePair> pair = torque_pair(even, robot);
  if (!pair) return;
  const MatrixXd gravity = gravity_in(*pair, even, robot);
  for (const Index joint : constant) {
    const bool impossible = is_impossible(*pair, gravity, joint);
    // Of a joint without a drive, beside others that have one: a link without mass explains a
    // torque of nothing best, and nothing that such a link says of the others is right.
    const bool is_free = others_change && log.tau(0, joint) == 0;
    if (!impossible && !is_free) continue;
    faults.push_back(unrecorded(log, robot, joint, pair->model.col(joint), impossible));
  }
}

}  // namespace offnominal::desk
