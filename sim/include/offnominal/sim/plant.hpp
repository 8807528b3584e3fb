// What drives move: any number of joints behind one face.
#pragma once

#include <vector>

#include "offnominal/sim/bus/fault_event.hpp"
#include "offnominal/sim/joint_state.hpp"

namespace offnominal::sim {

/// Joints with their state. The same steps from the same start give the same bits; neither looks at
/// a clock nor draws a number. A new plant is a class of this face.
class Plant {
 public:
  virtual ~Plant() = default;

  /// As the encoders stand; as many joints as ever. A drive with a soft gear has its encoder on the
  /// motor's side.
  [[nodiscard]] virtual const JointState& state() const = 0;

  /// Moves on from t_s, s since it was let go, by period_s > 0 under drive torques, N m or N, that
  /// are held over it. Throws std::runtime_error where the motion runs away.
  virtual void step(double t_s, const JointVector& tau, double period_s) = 0;

  /// beta psi of the paper's equation (1) at this state: acceleration with the plant's faults less
  /// acceleration without them under the drive torque tau, rad/s^2 or m/s^2. Zero where there is
  /// none.
  [[nodiscard]] virtual JointVector fault_function(double t_s, const JointVector& tau) const = 0;

  /// From now on its body has these faults and no others; those of drives, encoders and the bus
  /// concern it not. False, and nothing changed, where it cannot change them;
  /// std::invalid_argument, and nothing changed, may be thrown for a joint that it has not.
  [[nodiscard]] virtual bool set_faults(const std::vector<FaultEvent>& /*faults*/) { return false; }

  [[nodiscard]] Eigen::Index joint_count() const { return state().q.size(); }
};

}  // namespace offnominal::sim
