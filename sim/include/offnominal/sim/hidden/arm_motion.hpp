// What the joints of an arm of any number of them are told to do.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "offnominal/sim/hidden/draws.hpp"
#include "offnominal/sim/joint_state.hpp"

namespace offnominal::sim::hidden {

/// What one joint is told to do: sums of sines, or moves from place to place with pauses.
struct ArmJointMotion {
  struct Wave {
    double size, rad_s, phase;
  };
  struct Move {
    double from_s, to_s, from, to;  // a polynomial of fifth order, at rest at both ends
  };
  double middle = 0;  // rad
  std::vector<Wave> waves;
  std::vector<Move> moves;  // in the order of time
};

/// At most this far from the middle, rad.
inline constexpr double kArmMotionReachRad = 1.2;

struct ArmMotion {
  std::vector<ArmJointMotion> joints;

  [[nodiscard]] DesiredMotion at(double t_s) const;
};

/// Sums of sines in three of five cases. `middles`: where each joint stands or moves about, rad;
/// `stands`: joints that are held there. Others stay within kArmMotionReachRad of their middle.
ArmMotion draw_arm_motion(const std::vector<double>& middles, const std::vector<bool>& stands,
                          double duration_s, Draws& draws);

}  // namespace offnominal::sim::hidden
