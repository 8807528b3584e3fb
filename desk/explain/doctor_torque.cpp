#include <fmt/format.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "explain/doctor_checks.hpp"

namespace offnominal::desk {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kRadPerDegree = std::numbers::pi / 180;
// A model that misses more of the torque than this takes the positions for something else: missing
// effects make up 15 %.
constexpr double kBadFit = 0.6;
// Of two misfits, noise aside.
constexpr double kClearlyBetter = 0.9;

// Error of the model on a joint as a share of its torque, whatever the torque's sign: both faults
// may be there at once.
double misfit(const TorquePair& pair, Index joint) {
  const double torque = pair.measured.col(joint).norm();
  if (!(torque > 0)) return 0;
  return std::min((pair.measured.col(joint) - pair.model.col(joint)).norm(),
                  (pair.measured.col(joint) + pair.model.col(joint)).norm()) /
         torque;
}

double misfit(const TorquePair& pair) {
  double sum = 0;
  for (Index joint = 0; joint < pair.measured.cols(); ++joint) {
    sum += std::pow(misfit(pair, joint), 2);
  }
  return std::sqrt(sum / static_cast<double>(pair.measured.cols()));
}

// Whether the velocity of a joint was measured, and fits its position as it stands: then it is in
// degrees as well.
bool velocity_in_degrees(const Log& log, Index joint) {
  const auto ratio = velocity_ratio(log, joint);
  return ratio && *ratio > 1 / kSameUnit && *ratio < kSameUnit;
}

// Where `joint`, or every revolute one for -1, has positions in degrees.
bool is_in_degrees(const RobotDescription& robot, Index joint, Index which) {
  return (joint < 0 || which == joint) &&
         robot.joints[static_cast<std::size_t>(which)].joint.type == JointType::kRevolute;
}

// Converts one joint, or all revolute ones for -1, in the recording and in where it comes from.
void to_radians(Log& log, const RobotDescription& robot, Index joint) {
  for (Index j = 0; j < log.q.cols(); ++j) {
    const auto index = static_cast<std::size_t>(j);
    if (!is_in_degrees(robot, joint, j)) continue;
    const bool with_velocity = log.dq_derived[index] || velocity_in_degrees(log, j);
    log.q.col(j) *= kRadPerDegree;
    change_recorded(log, [j](RecordedRows& rows) { rows.q.col(j) *= kRadPerDegree; });
    if (index < log.channels.position.size()) log.channels.position[index].scale *= kRadPerDegree;
    if (!with_velocity) continue;
    log.dq.col(j) *= kRadPerDegree;
    if (index >= log.channels.velocity.size() || !log.channels.velocity[index]) continue;
    log.channels.velocity[index]->scale *= kRadPerDegree;
  }
}

// What a pair needs of to_radians().
SlowSignals in_radians(SlowSignals slow, const RobotDescription& robot, Index joint) {
  for (Index j = 0; j < slow.motion.q.cols(); ++j) {
    if (!is_in_degrees(robot, joint, j)) continue;
    for (MatrixXd* const one : {&slow.motion.q, &slow.motion.dq, &slow.motion.ddq}) {
      one->col(j) *= kRadPerDegree;
    }
  }
  return slow;
}

// Of a time of which a second has so many units.
SlowSignals in_units(SlowSignals slow, double per_second) {
  slow.period_s /= per_second;
  slow.cutoff_hz *= per_second;
  slow.motion.t_s /= per_second;
  slow.motion.dq *= per_second;
  slow.motion.ddq *= per_second * per_second;
  return slow;
}

bool leaves_limits(const Log& log, const RobotDescription& robot, Index joint) {
  // A joint may overshoot its limits, but not by as much as they are apart.
  constexpr double kBeyond = 1;
  const auto& limits = robot.joints[static_cast<std::size_t>(joint)].joint;
  const double width = limits.max_position - limits.min_position;
  if (!(width < std::numeric_limits<double>::max())) return false;
  return log.q.col(joint).maxCoeff() > limits.max_position + kBeyond * width ||
         log.q.col(joint).minCoeff() < limits.min_position - kBeyond * width;
}

bool inside_limits(const Log& log, const RobotDescription& robot, Index joint) {
  const auto& limits = robot.joints[static_cast<std::size_t>(joint)].joint;
  return log.q.col(joint).maxCoeff() * kRadPerDegree <= limits.max_position &&
         log.q.col(joint).minCoeff() * kRadPerDegree >= limits.min_position;
}

// Whether positions go beyond a turn of 0. An arm that stays within would hardly have moved in
// degrees, and a model that hardly moves fits what the drive gives while a hand moves the arm.
bool go_beyond_a_turn(const Log& log, const std::vector<Index>& revolute, Index joint) {
  return std::any_of(revolute.begin(), revolute.end(), [&](Index j) {
    return (joint < 0 || j == joint) && log.q.col(j).cwiseAbs().maxCoeff() > 2 * std::numbers::pi;
  });
}

// The joint whose positions are in degrees, -1 for all, and how that shows.
struct Degrees {
  Index joint = -1;
  std::string reason;
};

// The same pair, of all joints.
TorquePair all_beside_friction(TorquePair pair) {
  for (Index joint = 0; joint < pair.measured.cols(); ++joint) {
    const VectorXd dq = pair.dq.col(joint);
    pair.measured.col(joint) = beside_friction(pair.measured.col(joint), dq);
    pair.model.col(joint) = beside_friction(pair.model.col(joint), dq);
  }
  return pair;
}

std::optional<Degrees> degrees_by_torque(const Log& log, const SlowSignals& slow,
                                         const RobotDescription& robot,
                                         const std::vector<Index>& revolute) {
  // As degrees it must fit, although effects are missing or a clock is off.
  constexpr double kGoodFit = 0.5;
  // And fit far better.
  constexpr double kBetter = 3;
  const auto as_is = torque_pair(slow, robot, WithLinks::kNo);
  if (!as_is) return std::nullopt;
  // A friction of the file that is a guess is no unit of the positions.
  const double missed = std::min(misfit(*as_is), misfit(all_beside_friction(*as_is)));
  if (!(missed > kBadFit)) return std::nullopt;
  // Torques that are too small are missed by far as well, and by less where nothing weighs
  // anything.
  if (is_of_another_torque_unit(*as_is)) return std::nullopt;
  std::vector<Index> choices{-1};
  if (revolute.size() > 1) choices.insert(choices.end(), revolute.begin(), revolute.end());
  std::optional<Degrees> found;
  double best = std::min(kGoodFit, missed / kBetter);
  for (const Index joint : choices) {
    const auto scaled = torque_pair(in_radians(slow, robot, joint), robot, WithLinks::kNo);
    const double left = scaled ? misfit(*scaled) : best;
    if (!(left < best)) continue;
    // Within a turn it must be the whole torque that fits, friction or none.
    constexpr double kWhole = 0.2;
    if (!go_beyond_a_turn(log, revolute, joint) &&
        !(left < kWhole && misfit(all_beside_friction(*scaled)) < kWhole)) {
      continue;
    }
    best = left;
    found = Degrees{
        joint,
        fmt::format("the model misses {:.0f} % of the torque with the positions as they are, "
                    "{:.0f} % with the positions times pi/180",
                    std::min(100 * missed, 1e4), 100 * best)};
  }
  if (found || !go_beyond_a_turn(log, revolute, -1)) return found;
  const auto radians = torque_pair(in_radians(slow, robot, -1), robot, WithLinks::kNo);
  if (!radians || !is_of_another_torque_unit(*radians)) return std::nullopt;
  return Degrees{-1,
                 "the torques follow the model, at another scale, with the positions times pi/180 "
                 "and not as they are"};
}

// Velocities in rad/s beside positions that then cannot be in rad.
std::optional<Degrees> degrees_by_velocity(const Log& log, const std::vector<Index>& revolute) {
  std::optional<Degrees> found;
  Index told = 0;
  Index alike = 0;
  const std::vector<std::optional<double>> ratios = velocity_ratios(log);
  for (const Index joint : revolute) {
    const auto& ratio = ratios[static_cast<std::size_t>(joint)];
    if (!ratio) continue;
    ++told;
    if (!(*ratio > kRadPerDegree / kNearUnit && *ratio < kRadPerDegree * kNearUnit)) continue;
    ++alike;
    if (found) continue;
    found = Degrees{joint, fmt::format("the velocity of joint {} is {:.4g} times their derivative",
                                       joint + 1, *ratio)};
  }
  if (found && alike == told && told > 1) found->joint = -1;
  return found;
}

// Positions that jump by 2 pi are in radians, however far they go unfolded.
bool is_folded_into_radians(const std::vector<DataFault>& faults, Index joint) {
  constexpr double kTurn = 2 * std::numbers::pi;
  return std::any_of(faults.begin(), faults.end(), [joint](const DataFault& fault) {
    return fault.kind == DataFaultKind::kWrapped && fault.joint == joint &&
           std::abs(fault.size / kTurn - 1) < 1e-6;
  });
}

std::optional<Degrees> degrees_by_limits(const Log& log, const std::optional<SlowSignals>& slow,
                                         const RobotDescription& robot,
                                         const std::vector<Index>& revolute,
                                         const std::vector<DataFault>& faults) {
  std::vector<Index> beyond;
  for (const Index joint : revolute) {
    if (leaves_limits(log, robot, joint) && inside_limits(log, robot, joint) &&
        !is_folded_into_radians(faults, joint)) {
      beyond.push_back(joint);
    }
  }
  if (beyond.empty()) return std::nullopt;
  // Limits of a turn stand beside a joint that turns on and on; its torque knows better.
  const auto as_is = slow ? torque_pair(*slow, robot, WithLinks::kNo) : std::nullopt;
  std::erase_if(beyond, [&](Index joint) {
    if (!as_is || !(as_is->measured.col(joint).norm() > 0)) return false;
    const auto scaled = torque_pair(in_radians(*slow, robot, joint), robot, WithLinks::kNo);
    if (!scaled) return false;
    const double radians = misfit(*as_is, joint);
    const double degrees = misfit(*scaled, joint);
    return radians < kClearlyBetter * degrees || (radians <= kBadFit && radians <= degrees);
  });
  if (beyond.empty()) return std::nullopt;
  return Degrees{
      beyond.size() == 1 && revolute.size() > 1 ? beyond.front() : -1,
      fmt::format("positions of joint {} go from {:.4g} to {:.4g}, far beyond its limits",
                  beyond.front() + 1, log.q.col(beyond.front()).minCoeff(),
                  log.q.col(beyond.front()).maxCoeff())};
}

}  // namespace

Eigen::MatrixXd beside(const Eigen::MatrixXd& others, const Eigen::MatrixXd& torques) {
  return torques - others * others.colPivHouseholderQr().solve(torques);
}

Eigen::MatrixXd friction_columns(const VectorXd& dq) {
  constexpr double kSlow = 0.1;  // of the usual speed
  const double usual = dq.norm() / std::sqrt(static_cast<double>(dq.size()));
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(dq.size(), 2);
  if (usual > 0) columns << dq, (dq.array() / (kSlow * usual)).tanh().matrix();
  return columns;
}

VectorXd beside_friction(const VectorXd& torque, const VectorXd& dq) {
  return beside(friction_columns(dq), torque);
}

Eigen::MatrixXd beside_drive(const TorquePair& pair, Index joint, const Eigen::MatrixXd& torques) {
  Eigen::MatrixXd drive(torques.rows(), 4);
  drive << friction_columns(pair.dq.col(joint)), pair.ddq.col(joint),
      VectorXd::Ones(torques.rows());
  return beside(drive, torques);
}

TimeByTorque time_by_torque(const Log& log, const RobotDescription& robot, double per_second) {
  constexpr double kHz = 5;
  constexpr double kOfRate = 0.1;
  constexpr double kFewestPeriods = 20;  // of the cut-off in the recording
  const auto rows = static_cast<double>(log.sample_count());
  // Filtered over as many samples either way: else the one that smooths more has less noise.
  const double share =
      std::min(kOfRate, std::max(kHz * log.period_s / per_second, kFewestPeriods / rows));
  const auto slow = slow_signals(log, share);
  if (!slow) return TimeByTorque::kUnknown;
  const auto best_misfit = [&](const SlowSignals& one) {
    double best = std::numeric_limits<double>::infinity();
    for (const bool degrees : {false, true}) {
      const auto pair =
          torque_pair(degrees ? in_radians(one, robot, -1) : one, robot, WithLinks::kNo);
      if (pair) best = std::min(best, misfit(*pair));
    }
    return best;
  };
  const double seconds = best_misfit(*slow);
  const double other = best_misfit(in_units(*slow, per_second));
  if (seconds < kBadFit && seconds < kClearlyBetter * other) return TimeByTorque::kSeconds;
  if (other < kBadFit && other < kClearlyBetter * seconds) return TimeByTorque::kUnit;
  return TimeByTorque::kUnknown;
}

void mend_degrees(Log& log, const RobotDescription& robot, std::vector<DataFault>& faults) {
  std::vector<Index> revolute;
  for (Index j = 0; j < log.q.cols(); ++j) {
    if (robot.joints[static_cast<std::size_t>(j)].joint.type == JointType::kRevolute) {
      revolute.push_back(j);
    }
  }
  if (revolute.empty()) return;
  const std::optional<SlowSignals> slow = slow_signals(log);
  auto found = slow ? degrees_by_torque(log, *slow, robot, revolute) : std::nullopt;
  if (!found) found = degrees_by_velocity(log, revolute);
  if (!found) found = degrees_by_limits(log, slow, robot, revolute, faults);
  if (!found) return;
  DataFault fault;
  fault.kind = DataFaultKind::kDegrees;
  fault.joint = found->joint;
  fault.size = 1 / kRadPerDegree;
  fault.words = fmt::format("the positions of {} are in degrees: {}", joint_words(found->joint),
                            found->reason);
  fault.mend = "log radians, or scale the positions by 0.0174533";
  std::vector<std::string> keys{"position"};
  for (const Index joint : revolute) {
    if ((found->joint >= 0 && joint != found->joint) || !velocity_in_degrees(log, joint)) continue;
    fault.words += fmt::format("; so is the velocity of joint {}", joint + 1);
    if (keys.size() == 1) keys.emplace_back("velocity");
  }
  to_radians(log, robot, found->joint);
  propose_channels(log, log.channels, keys, fault);
  faults.push_back(std::move(fault));
}

}  // namespace offnominal::desk
