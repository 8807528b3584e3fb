#include <fmt/format.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "explain/doctor_checks.hpp"
#include "explain/doctor_signal.hpp"
#include "explain/other_masses.hpp"

namespace offnominal::desk {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Where the model explains less than this share of the torque it has nothing to say about the sign.
constexpr double kSilentModel = 0.3;

// Measured and model torque of a joint that are of opposite sign.
struct Opposed {
  double slope = 0;   // of the one against the other
  double turned = 0;  // unexplained with the opposite sign, as a share
  double as_is = 0;
};

// The model with the opposite sign must fit: missing effects and a clock that is off leave less.
constexpr double kFits = 0.6;
// Of a joint that its drive holds friction may hold as much, whichever way.
constexpr double kFitsWhileHeld = 0.3;
// Friction of any kind has +0.8.
constexpr double kClearBraking = 0.6;

std::optional<Opposed> opposed(const VectorXd& tau, const VectorXd& model, double fits) {
  const double size = tau.norm();
  if (!(model.norm() > kSilentModel * size)) return std::nullopt;
  const Opposed found{tau.dot(model) / model.squaredNorm(), (tau + model).norm() / size,
                      (tau - model).norm() / size};
  if (!(found.turned < fits) || !(found.as_is > 1)) return std::nullopt;
  return found;
}

// As the model has it, or where friction is only a part of the torque, beside whatever friction.
std::optional<Opposed> opposed_to_model(const TorquePair& pair, Index joint, bool held) {
  const double fits = held ? kFitsWhileHeld : kFits;
  const VectorXd tau = pair.measured.col(joint);
  if (auto found = opposed(tau, pair.model.col(joint), fits)) return found;
  const VectorXd dq = pair.dq.col(joint);
  const VectorXd rest = beside_friction(tau, dq);
  if (!(rest.norm() > kSilentModel * tau.norm())) return std::nullopt;
  return opposed(rest, beside_friction(pair.model.col(joint), dq), fits);
}

// The correlation with the velocity of what the rigid body does not explain, where that is nearly
// all: friction's power is never negative. None where the rigid body has something to say.
std::optional<double> braking_of(const TorquePair& pair, Index joint) {
  const VectorXd tau = pair.measured.col(joint);
  if (pair.load.col(joint).norm() > kSilentModel * tau.norm()) return std::nullopt;
  const VectorXd rest = tau - pair.load.col(joint);
  const VectorXd speed = pair.dq.col(joint);
  const double product = rest.norm() * speed.norm();
  if (!(product > 0)) return std::nullopt;
  return rest.dot(speed) / product;
}

// Whether the torque beside the rigid body's steps with the direction of motion as friction does,
// whatever it does with the speed beside: a controller that tells a drive less than friction takes,
// or more the faster it goes, turns no sign. A joint that turns one way shows no step.
bool steps_as_friction_does(const TorquePair& pair, Index joint) {
  constexpr double kStep = 0.1;       // of it, rms
  constexpr double kBothWays = 0.05;  // of the samples, at least, in each direction
  const VectorXd rest = pair.measured.col(joint) - pair.load.col(joint);
  const VectorXd dq = pair.dq.col(joint);
  MatrixXd friction(rest.size(), 3);
  friction << dq, dq.cwiseProduct(dq.cwiseAbs()), dq.cwiseSign();
  if (!(std::abs(friction.col(2).mean()) < 1 - 2 * kBothWays)) return false;
  const VectorXd parts = Eigen::ColPivHouseholderQR<MatrixXd>(friction).solve(rest);
  return parts[2] * std::sqrt(static_cast<double>(rest.size())) > kStep * rest.norm();
}

// A sign that is right: the model as it is fits, or friction takes power.
bool is_right(const TorquePair& pair, Index joint) {
  const VectorXd tau = pair.measured.col(joint);
  const bool fits = (tau - pair.model.col(joint)).norm() < kFits * tau.norm();
  return fits || braking_of(pair, joint).value_or(0) > kClearBraking;
}

// Of several joints that tell, all are turned: then so are those that do not.
bool are_all_turned(const TorquePair& pair, const std::vector<Index>& turned) {
  if (turned.size() < 2) return false;
  for (Index joint = 0; joint < pair.measured.cols(); ++joint) {
    const bool is_turned = std::find(turned.begin(), turned.end(), joint) != turned.end();
    if (!is_turned && is_right(pair, joint)) return false;
  }
  return static_cast<Index>(turned.size()) < pair.measured.cols();
}

// Joints whose torque other masses turn round, of those whose torque is opposed to the model's:
// with their torques as they are they explain all torques better than the opposite signs do,
// whatever the masses are then. Several signs may be wrong at once, so that each is judged beside
// the others, and then all of them together.
std::vector<char> turned_by_masses(const RobotDescription& robot, const TorquePair& pair,
                                   const std::vector<char>& opposed) {
  constexpr double kNoise = 0.1;
  const TorquePair rows = thinned(pair);
  const OtherMasses masses(robot, rows, sizes_about_mean(rows.measured), kNoise);
  const auto left_with = [&](const std::vector<char>& wrong) {
    MatrixXd error = rows.measured - rows.model;
    for (Index joint = 0; joint < error.cols(); ++joint) {
      if (wrong[static_cast<std::size_t>(joint)] == 0) continue;
      error.col(joint) = -rows.measured.col(joint) - rows.model.col(joint);
    }
    return masses.left_of_each(error).norm();
  };
  std::vector<char> wrong = opposed;
  double left = left_with(wrong);
  for (std::size_t joint = 0; joint < opposed.size(); ++joint) {
    if (opposed[joint] == 0) continue;
    wrong[joint] = 0;
    const double as_it_is = left_with(wrong);
    if (as_it_is < left) {
      left = as_it_is;
    } else {
      wrong[joint] = 1;
    }
  }
  const std::vector<char> none(opposed.size(), 0);
  if (left_with(none) < left) wrong = none;
  std::vector<char> by_masses(opposed.size(), 0);
  for (std::size_t joint = 0; joint < opposed.size(); ++joint) {
    by_masses[joint] = static_cast<char>(opposed[joint] != 0 && wrong[joint] == 0);
  }
  return by_masses;
}

// What speaks for a wrong sign of a joint's torque, the model or friction that gives power.
struct WrongSign {
  DataFault fault;
  bool by_model = false;
};

// None where nothing does. `held`: a controller that holds a joint gives torques against each
// motion, as friction that gives power would.
std::optional<WrongSign> wrong_sign_of(const TorquePair& pair, Index joint, bool held) {
  WrongSign wrong;
  DataFault& fault = wrong.fault;
  fault.kind = DataFaultKind::kTorqueSign;
  fault.joint = joint;
  if (!(pair.measured.col(joint).norm() > 0)) return std::nullopt;
  if (const auto turned = opposed_to_model(pair, joint, held)) {
    wrong.by_model = true;
    fault.size = turned->slope;
    fault.words = fmt::format(
        "the torque of joint {} has the wrong sign: measured against model torque has slope "
        "{:.2f}, and the opposite sign leaves {:.0f} % of it unexplained instead of {:.0f} %",
        joint + 1, fault.size, 100 * turned->turned, 100 * turned->as_is);
  } else if (const auto braking = braking_of(pair, joint); !held && braking &&
                                                           *braking < -kClearBraking &&
                                                           !steps_as_friction_does(pair, joint)) {
    const VectorXd speed = pair.dq.col(joint);
    fault.size = (pair.measured.col(joint) - pair.load.col(joint)).dot(speed) / speed.squaredNorm();
    fault.words = fmt::format(
        "the torque of joint {} has the wrong sign: it acts against the motion (correlation with "
        "the velocity {:.2f}), as if friction gave power",
        joint + 1, *braking);
  } else {
    return std::nullopt;
  }
  fault.mend = fmt::format(
      "turn the sign of the torque of joint {} (scale = -1), or its position's; or gravity in "
      "the robot file points the wrong way",
      joint + 1);
  return wrong;
}

}  // namespace

void find_torque_sign(const Log& log, const RobotDescription& robot, const TorquePair& pair,
                      std::vector<DataFault>& faults) {
  const Index joints = pair.measured.cols();
  std::vector<DataFault> found;
  std::vector<char> opposed(static_cast<std::size_t>(joints), 0);
  const std::vector<char> held = held_joints(pair.q, robot);
  for (Index joint = 0; joint < joints; ++joint) {
    auto wrong = wrong_sign_of(pair, joint, held[static_cast<std::size_t>(joint)] != 0);
    if (!wrong) continue;
    opposed[static_cast<std::size_t>(joint)] = static_cast<char>(wrong->by_model);
    found.push_back(std::move(wrong->fault));
  }
  const std::size_t before = found.size();
  if (std::any_of(opposed.begin(), opposed.end(), [](char one) { return one != 0; })) {
    const std::vector<char> by_masses = turned_by_masses(robot, pair, opposed);
    std::erase_if(found, [&](const DataFault& fault) {
      return by_masses[static_cast<std::size_t>(fault.joint)] != 0;
    });
  }
  std::vector<Index> turned_channels;
  for (const DataFault& fault : found) turned_channels.push_back(fault.joint);
  const bool all = found.size() == before && are_all_turned(pair, turned_channels);
  if (all) {
    turned_channels.resize(static_cast<std::size_t>(joints));
    std::iota(turned_channels.begin(), turned_channels.end(), 0);
  }
  ChannelMap mended = log.channels;
  for (const Index joint : turned_channels) {
    const auto index = static_cast<std::size_t>(joint);
    if (index < mended.torque.size()) mended.torque[index].scale *= -1;
  }
  for (DataFault& fault : found) {
    if (all) {
      fault.mend +=
          "; every joint that tells its sign has it wrong, so that all are taken for turned";
    }
    propose_channels(log, mended, {"torque"}, fault);
    faults.push_back(std::move(fault));
  }
}

}  // namespace offnominal::desk
