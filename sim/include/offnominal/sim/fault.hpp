// Faults of section 5 and their time profile beta (Assumption 3.2).
#pragma once

#include <Eigen/Core>
#include <limits>

#include "offnominal/sim/two_link_arm.hpp"

namespace offnominal::sim {

enum class FaultKind {
  kNone,
  kMassLoss,   ///< section 5.1: mass 1 falls, so M, V and G change
  kNonlinear,  ///< section 5.2, equation (30): an acceleration that depends on the state
  kPayload,    ///< a mass at the tip, so mass 2 grows
};

/// Evolution rate of a fault that is complete at once.
inline constexpr double kAbrupt = std::numeric_limits<double>::infinity();

struct Fault {
  FaultKind kind = FaultKind::kNone;
  double time_s = 10.0;     ///< T, when it begins
  double rate_per_s = 0.5;  ///< rho > 0; kAbrupt for a jump
  double mass_loss = 0.75;  ///< final share of mass 1 that is lost, [0, 1); kMassLoss only
  double payload_kg = 0.0;  ///< final mass at the tip, >= 0; kPayload only
};

/// Throws std::invalid_argument naming the field, what was found and what is allowed.
void validate(const Fault& fault);

/// beta(t - T) = 1 - exp(-rho (t - T)) from T on, 0 before; 1 from T on for an abrupt fault.
double time_profile(const Fault& fault, double t_s);

/// Arm at time t_s: mass 1 is m1 (1 - mass_loss beta), mass 2 is m2 + payload_kg beta. The printed
/// m1(t) of section 5.1 has the wrong sign before its exponential; this one starts at m1 and ends
/// at (1 - mass_loss) m1.
TwoLinkParameters faulty_arm(const TwoLinkParameters& healthy, const Fault& fault, double t_s);

/// Equation (30) without its time profile, rad/s^2:
/// [7.5 q1^2 + 10 q1^2 dq2^2 + 7 q2 + 17, 50 q1 q2 + 12.5].
Eigen::Vector2d nonlinear_fault(const TwoLinkState& state);

}  // namespace offnominal::sim
