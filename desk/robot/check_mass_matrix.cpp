#include "robot/check_mass_matrix.hpp"

#include <Eigen/Cholesky>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <offnominal/model/mass_matrix.hpp>
#include <optional>
#include <random>

#include "common/number.hpp"
#include "robot/chain_of.hpp"
#include "robot/read_effect.hpp"

namespace offnominal::desk {
namespace {

constexpr int kPositions = 2000;
// What is looked at where a joint has no limits: a turn, a metre.
constexpr double kTurn = std::numbers::pi;
constexpr double kSlide = 1.0;

// The effect with the least mass, if that is below zero.
std::optional<std::size_t> lightest_effect(const RobotDescription& robot) {
  std::optional<std::size_t> lightest;
  for (std::size_t i = 0; i < robot.effects.size(); ++i) {
    const RobotEffect& effect = robot.effects[i];
    const bool is_mass = info_of(effect.kind)->action == EffectAction::kPointMass;
    if (!is_mass || effect.parameters[0] >= 0) continue;
    if (!lightest || effect.parameters[0] < robot.effects[*lightest].parameters[0]) lightest = i;
  }
  return lightest;
}

// One end of the joint's range, the other, or a place between, each with its share.
double random_position(const Joint<double>& joint, std::mt19937& generator) {
  const double reach = joint.type == JointType::kRevolute ? kTurn : kSlide;
  const double low = std::max(joint.min_position, std::min(-reach, joint.max_position - reach));
  const double high = std::min(joint.max_position, std::max(reach, joint.min_position + reach));
  const double share = std::uniform_real_distribution<double>(-0.5, 1.5)(generator);
  return std::lerp(low, high, std::clamp(share, 0.0, 1.0));
}

bool positive_definite_everywhere(const RobotDescription& robot) {
  const auto model = make_model(chain_of<kRuntimeJoints, double>(robot));
  std::mt19937 generator;  // the same positions every time
  for (int i = 0; i < kPositions; ++i) {
    Vector<kRuntimeJoints, double> q(robot.joint_count());
    for (Eigen::Index j = 0; j < q.size(); ++j) {
      q[j] = random_position(robot.joints[static_cast<std::size_t>(j)].joint, generator);
    }
    const Eigen::LLT<Matrix<kRuntimeJoints, kRuntimeJoints, double>> factor(mass_matrix(model, q));
    if (factor.info() != Eigen::Success) return false;
  }
  return true;
}

}  // namespace

void check_mass_matrix(const TomlTable& root, const RobotDescription& robot) {
  const std::optional<std::size_t> lightest = lightest_effect(robot);
  if (!lightest) return;
  if (positive_definite_everywhere(robot)) return;
  const double mass = robot.effects[*lightest].parameters[0];
  root.tables("effect", effect_keys())[*lightest].refuse(
      "mass", shortest(mass) + ", which leaves a mass matrix that is not positive definite",
      "a mass that leaves every joint something to move, wherever the others are",
      "take away less mass, or correct the links' masses");
}

}  // namespace offnominal::desk
