#include "offnominal/sim/hidden/arm_motion.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace offnominal::sim::hidden {

namespace {

constexpr double kOneTurn = 2 * std::numbers::pi;

void add_waves(ArmJointMotion& joint, double base_hz, Draws& draws) {
  constexpr int kWaves = 5;
  constexpr int kHighest = 9;  // harmonic
  const double most_rad = draws.uniform(0.5, kArmMotionReachRad);
  const double most_rad_s = draws.uniform(0.7, 1.8);
  double range = 0;
  double speed = 0;
  for (int i = 0; i < kWaves; ++i) {
    const double harmonic = i == 0 ? 1 : 1 + draws.below(kHighest);
    const double rad_s = kOneTurn * base_hz * harmonic * draws.uniform(0.97, 1.03);
    const double size = draws.uniform(0.4, 1.0) / std::sqrt(harmonic);
    joint.waves.push_back({size, rad_s, draws.uniform(0, kOneTurn)});
    range += size;
    speed += size * rad_s;
  }
  const double scale = std::min(most_rad / range, most_rad_s / speed);
  for (auto& wave : joint.waves) wave.size *= scale;
}

// All joints set off together and arrive together, as a controller's moves from point to point do.
void add_moves(ArmMotion& motion, const std::vector<bool>& stands, double duration_s,
               Draws& draws) {
  std::vector<double> at(motion.joints.size());
  for (std::size_t j = 0; j < at.size(); ++j) at[j] = motion.joints[j].middle;
  for (double t_s = draws.uniform(0.2, 0.6); t_s < duration_s;) {
    const double takes_s = draws.uniform(0.8, 2.2);
    for (std::size_t j = 0; j < at.size(); ++j) {
      const double to = motion.joints[j].middle + draws.uniform(-0.9, 0.9);
      if (stands[j]) continue;
      motion.joints[j].moves.push_back({t_s, t_s + takes_s, at[j], to});
      at[j] = to;
    }
    t_s += takes_s + draws.uniform(0.1, 0.5);
  }
}

void add_move(const ArmJointMotion& joint, double t_s, double& q, double& dq, double& ddq) {
  const auto next = std::find_if(joint.moves.begin(), joint.moves.end(),
                                 [&](const auto& move) { return t_s < move.to_s; });
  if (next == joint.moves.end()) {
    q = joint.moves.back().to;
    return;
  }
  q = next->from;
  if (t_s <= next->from_s) return;
  const double takes_s = next->to_s - next->from_s;
  const double s = (t_s - next->from_s) / takes_s;
  const double by = next->to - next->from;
  q += by * s * s * s * (10 + s * (-15 + 6 * s));
  dq += by / takes_s * 30 * s * s * (1 + s * (-2 + s));
  ddq += by / (takes_s * takes_s) * 60 * s * (1 + s * (-3 + 2 * s));
}

}  // namespace

DesiredMotion ArmMotion::at(double t_s) const {
  const auto count = static_cast<Eigen::Index>(joints.size());
  DesiredMotion motion{JointVector::Zero(count), JointVector::Zero(count),
                       JointVector::Zero(count)};
  for (Eigen::Index j = 0; j < count; ++j) {
    const ArmJointMotion& joint = joints[static_cast<std::size_t>(j)];
    motion.q[j] = joint.middle;
    if (!joint.moves.empty()) add_move(joint, t_s, motion.q[j], motion.dq[j], motion.ddq[j]);
    for (const auto& wave : joint.waves) {
      const double angle = wave.rad_s * t_s + wave.phase;
      motion.q[j] += wave.size * std::sin(angle);
      motion.dq[j] += wave.size * wave.rad_s * std::cos(angle);
      motion.ddq[j] -= wave.size * wave.rad_s * wave.rad_s * std::sin(angle);
    }
  }
  return motion;
}

ArmMotion draw_arm_motion(const std::vector<double>& middles, const std::vector<bool>& stands,
                          double duration_s, Draws& draws) {
  constexpr double kShareOfSines = 0.6;
  ArmMotion motion;
  for (const double middle : middles) motion.joints.push_back({middle, {}, {}});
  const bool sines = draws.uniform(0, 1) < kShareOfSines;
  if (!sines) {
    add_moves(motion, stands, duration_s, draws);
    return motion;
  }
  const double base_hz = draws.uniform(0.08, 0.13);
  for (std::size_t j = 0; j < middles.size(); ++j) {
    ArmJointMotion drawn = motion.joints[j];
    add_waves(drawn, base_hz, draws);
    if (!stands[j]) motion.joints[j] = drawn;
  }
  return motion;
}

}  // namespace offnominal::sim::hidden
