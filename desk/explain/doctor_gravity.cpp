#include <fmt/format.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "compare/inverse_model.hpp"
#include "explain/doctor_checks.hpp"
#include "explain/doctor_signal.hpp"
#include "robot/payload.hpp"

namespace offnominal::desk {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double kStandard = 9.81;  // m/s^2

Vector3d gravity_of(const RobotDescription& robot) {
  return {robot.gravity_m_s2[0], robot.gravity_m_s2[1], robot.gravity_m_s2[2]};
}

// Torques of all joints, one under the other, each in parts of its joint's measured one.
class InParts {
 public:
  explicit InParts(const TorquePair& pair) {
    for (Index joint = 0; joint < pair.measured.cols(); ++joint) {
      const double size = pair.measured.col(joint).norm();
      weights_.push_back(size > 0 ? 1 / size : 0);
      MatrixXd friction(pair.dq.rows(), 2);
      friction << pair.dq.col(joint), pair.dq.col(joint).cwiseSign();
      solvers_.emplace_back(friction);
      friction_.push_back(std::move(friction));
    }
  }

  // Less what friction of each joint takes of it.
  [[nodiscard]] VectorXd beside_friction(const MatrixXd& torques) const {
    const Index rows = torques.rows();
    VectorXd all(torques.size());
    for (Index joint = 0; joint < torques.cols(); ++joint) {
      const auto at = static_cast<std::size_t>(joint);
      const VectorXd own = weights_[at] * torques.col(joint);
      all.segment(joint * rows, rows) = own - friction_[at] * solvers_[at].solve(own);
    }
    return all;
  }

 private:
  std::vector<double> weights_;
  std::vector<MatrixXd> friction_;  // per joint: speed and its sign
  std::vector<Eigen::ColPivHouseholderQR<MatrixXd>> solvers_;
};

// What gravity of 1 m/s^2 along each axis of the base has the joints carry, one column each.
MatrixXd torques_of_gravity(const RobotDescription& robot, const std::optional<Payload>& payload,
                            const TorquePair& pair, const InParts& parts) {
  RobotDescription rigid = robot;
  rigid.effects.clear();
  rigid = carrying(rigid, payload);
  const MatrixXd still = MatrixXd::Zero(pair.q.rows(), pair.q.cols());
  MatrixXd columns(pair.q.size(), 3);
  for (Index axis = 0; axis < 3; ++axis) {
    rigid.gravity_m_s2 = {0, 0, 0};
    rigid.gravity_m_s2[static_cast<std::size_t>(axis)] = 1;
    columns.col(axis) =
        parts.beside_friction(model_torque(rigid, {pair.t_s, pair.q, still, still}));
  }
  return columns;
}

double angle_deg(const Vector3d& a, const Vector3d& b) {
  const double cosine = a.dot(b) / (a.norm() * b.norm());
  return std::acos(std::clamp(cosine, -1.0, 1.0)) * 180 / std::numbers::pi;
}

// Whether more than one joint says so: of each of two or more it leaves clearly less, and all but
// one say the same, whichever is left out. Links that are off, or one joint whose torques lack
// something, turn it too, each by its own. Along an axis that only one joint feels it is that
// joint's word.
bool is_said_by_several(const MatrixXd& columns, const VectorXd& error, const Vector3d& change,
                        Index joints) {
  constexpr double kSame = 0.3;     // of the gravity
  constexpr double kHardly = 0.05;  // of what they feel along any axis
  constexpr double kClearly = 0.6;  // of what was left of a joint's
  constexpr int kSeveral = 2;
  const Index rows = error.size() / joints;
  const Eigen::Matrix3d all = columns.transpose() * columns;
  const VectorXd rest = error - columns * change;
  int say = 0;
  for (Index joint = 0; joint < joints; ++joint) {
    const auto own = columns.middleRows(joint * rows, rows);
    const auto left = rest.segment(joint * rows, rows);
    if (left.norm() < kClearly * error.segment(joint * rows, rows).norm()) ++say;
    const Vector3d pull = columns.transpose() * rest - own.transpose() * left;
    const Eigen::Matrix3d others = all - own.transpose() * own;
    const Eigen::Matrix3d held =
        others + kHardly * others.trace() / 3 * Eigen::Matrix3d::Identity();
    const Vector3d off = held.completeOrthogonalDecomposition().solve(pull);
    if (!(off.norm() < kSame * kStandard)) return false;
  }
  return say >= kSeveral;
}

// The axis of the base that a direction is near, or itself.
Vector3d as_mounted(const Vector3d& gravity) {
  constexpr double kNearDeg = 10;
  for (Index axis = 0; axis < 3; ++axis) {
    Vector3d along = std::copysign(kStandard, gravity[axis]) * Vector3d::Unit(axis);
    if (angle_deg(gravity, along) < kNearDeg) return along;
  }
  return gravity;
}

// To hundredths, and never -0.
double rounded(double value) { return std::round(100 * value) / 100 + 0.0; }

}  // namespace

bool find_gravity(const Log& log, const RobotDescription& robot, const TorquePair& pair,
                  std::vector<DataFault>& faults) {
  constexpr double kBadFit = 0.3;         // as the file has it, rms over the joints' torques
  constexpr double kGoodFit = 0.5;        // as it would be
  constexpr double kClearlyBetter = 0.5;  // of the first
  constexpr double kOff = 0.2;            // from 9.81 m/s^2, links being off the file
  constexpr double kTurnedDeg = 20;
  // The other way round is a matter of the torques' signs.
  constexpr double kReversedDeg = 150;
  // Of fewer joints another zero of the positions looks the same.
  constexpr Index kSureJoints = 3;
  const InParts parts(pair);
  const VectorXd error = parts.beside_friction(pair.measured - pair.model);
  const MatrixXd columns = torques_of_gravity(robot, log.payload, pair, parts);
  // What no joint feels stays as it is.
  const Eigen::CompleteOrthogonalDecomposition<MatrixXd> solver(columns);
  const Vector3d change = solver.solve(error);
  const Vector3d stated = gravity_of(robot);
  const Vector3d fitted = stated + change;
  const double joints = std::sqrt(static_cast<double>(pair.measured.cols()));
  const double before = error.norm() / joints;
  const double after = (error - columns * change).norm() / joints;
  if (!(before > kBadFit) || !(after < kGoodFit) || !(after < kClearlyBetter * before))
    return false;
  DataFault fault;
  fault.kind = DataFaultKind::kGravity;
  const Index count = pair.measured.cols();
  // Else links, or one joint, may be what is off.
  fault.or_masses = count >= kSureJoints && !is_said_by_several(columns, error, change, count);
  fault.certain = count >= kSureJoints && !fault.or_masses;
  if (fitted.norm() < kOff * kStandard && stated.norm() > kOff * kStandard) {
    fault.words = fmt::format(
        "the torques {} without gravity: friction apart, the model leaves {:.0f} % of them "
        "unexplained, and {:.0f} % where nothing weighs anything",
        fault.certain ? "are" : "may be", 100 * before, 100 * after);
    fault.mend =
        "record the whole torque where the controller carries gravity apart; where springs or "
        "counterweights carry every joint, or the base lies so that none has any, write "
        "gravity_m_s2 = [0, 0, 0] into the robot file";
    faults.push_back(std::move(fault));
    return true;
  }
  if (std::abs(fitted.norm() - kStandard) > kOff * kStandard) return false;
  const bool has_one = stated.norm() > 0;
  const double turned_deg = has_one ? angle_deg(stated, fitted) : 0;
  if (has_one && (turned_deg < kTurnedDeg || turned_deg > kReversedDeg)) return false;
  const Vector3d mounted = as_mounted(fitted);
  fault.size = turned_deg;
  fault.unit = "deg";
  fault.words = fmt::format(
      "gravity {} where the robot file has it: along [{:.2f}, {:.2f}, {:.2f}] m/s^2 of the base it "
      "leaves {:.0f} % of the torques unexplained, friction apart, instead of {:.0f} %",
      fault.certain ? "does not point" : "may not point", fitted[0], fitted[1], fitted[2],
      100 * after, 100 * before);
  fault.mend = fmt::format(
      "write gravity_m_s2 = [{:g}, {:g}, {:g}] into the robot file where the arm is mounted "
      "so; or the positions of a joint have another zero or sign than the file's",
      rounded(mounted[0]), rounded(mounted[1]), rounded(mounted[2]));
  faults.push_back(std::move(fault));
  return true;
}

void find_joint_gravity(const Log& log, const RobotDescription& robot, const TorquePair& pair,
                        std::vector<DataFault>& faults) {
  constexpr double kBadFit = 0.5;         // with it, of the joint's own torque
  constexpr double kGoodFit = 0.6;        // without
  constexpr double kClearlyBetter = 0.5;  // without, of what is left with it
  constexpr double kAsWhole = 0.2;        // of it that is missing: neither less nor more
  const InParts parts(pair);
  const VectorXd error = parts.beside_friction(pair.measured - pair.model);
  const VectorXd gravity = torques_of_gravity(robot, log.payload, pair, parts) * gravity_of(robot);
  const Index rows = pair.measured.rows();
  // What a brake or dry friction holds is not told either.
  const std::vector<char> held = held_joints(pair.q, robot);
  for (Index joint = 0; joint < pair.measured.cols(); ++joint) {
    if (held[static_cast<std::size_t>(joint)] != 0) continue;
    const auto left = error.segment(joint * rows, rows);
    const auto own = gravity.segment(joint * rows, rows);
    const double with = left.norm();
    const double without = (left + own).norm();
    if (!(with > kBadFit) || !(without < kGoodFit) || !(without < kClearlyBetter * with)) continue;
    const double missing = -left.dot(own) / own.squaredNorm();
    if (!(std::abs(missing - 1) < kAsWhole)) continue;
    DataFault fault;
    fault.kind = DataFaultKind::kGravity;
    fault.joint = joint;
    fault.certain = false;
    fault.or_masses = true;
    fault.words = fmt::format(
        "the torque of joint {} may be without gravity: friction apart, the model leaves {:.0f} % "
        "of it unexplained, and {:.0f} % where nothing weighs anything on that joint",
        joint + 1, 100 * with, 100 * without);
    fault.mend = fmt::format(
        "record the whole torque where the drive's controller carries gravity apart; where a "
        "spring or a counterweight carries it, `offnominal add position_torque --joint {}` puts "
        "that into the model",
        joint + 1);
    faults.push_back(std::move(fault));
  }
}

}  // namespace offnominal::desk
