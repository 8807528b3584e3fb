#pragma once

#include <Eigen/Core>
#include <vector>

#include "offnominal/sim/hidden/draws.hpp"
#include "offnominal/sim/joint_state.hpp"

namespace offnominal::bench {

// What one joint is told to do: sums of sines, or moves from place to place with pauses.
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

struct ArmMotion {
  std::vector<ArmJointMotion> joints;

  [[nodiscard]] sim::DesiredMotion at(double t_s) const;
};

// Sums of sines in three of five cases. `middles`: where each joint stands or moves about, rad;
// `stands`: joints that are held there.
ArmMotion draw_arm_motion(const std::vector<double>& middles, const std::vector<bool>& stands,
                          double duration_s, sim::hidden::Draws& draws);

}  // namespace offnominal::bench
