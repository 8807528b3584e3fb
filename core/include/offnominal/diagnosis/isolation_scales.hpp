#pragma once

#include <limits>
#include <offnominal/diagnosis/isolation_block.hpp>
#include <offnominal/diagnosis/known_friction.hpp>
#include <offnominal/vector.hpp>

namespace offnominal {

// Sizes that turn scaled parameters into units; constants of a robot.
template <int N, typename Scalar>
struct IsolationScales {
  OwnValues<N, Scalar> own = no_values<OwnValues<N, Scalar>>();
  Vector<kTipParameters, Scalar> tip = Vector<kTipParameters, Scalar>::Ones();
  PerJoint<N, Scalar> thresholds{};  // largest of each joint, N m or N
  PerJoint<N, Scalar> speeds{};      // largest velocities, rad/s or m/s; 1 where there is no limit
  Scalar reach_m = Scalar(0.6);      // of a payload's centre from the last link's frame, at most
  Scalar alpha{};                    // of the monitor, 1/s
  // The most that can be lost of each joint's friction, dry and viscous, and of the last link, kg.
  PerJoint<N, KnownFriction<Scalar>> friction{};
  Scalar last_mass = std::numeric_limits<Scalar>::max();
};

}  // namespace offnominal
