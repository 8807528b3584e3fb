#include "offnominal/sim/fault.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

namespace offnominal::sim {

void validate(const Fault& fault) {
  if (!std::isfinite(fault.time_s)) {
    throw std::invalid_argument("fault time_s: found " + std::to_string(fault.time_s) +
                                ", allowed is a finite number");
  }
  if (!(fault.rate_per_s > 0.0)) {
    throw std::invalid_argument("fault rate_per_s: found " + std::to_string(fault.rate_per_s) +
                                ", allowed is above 0, infinity for an abrupt fault");
  }
  if (!(fault.mass_loss >= 0.0 && fault.mass_loss < 1.0)) {
    throw std::invalid_argument("fault mass_loss: found " + std::to_string(fault.mass_loss) +
                                ", allowed is 0 to below 1");
  }
  if (!(fault.payload_kg >= 0.0 && std::isfinite(fault.payload_kg))) {
    throw std::invalid_argument("fault payload_kg: found " + std::to_string(fault.payload_kg) +
                                ", allowed is at least 0");
  }
}

double time_profile(const Fault& fault, double t_s) {
  if (fault.kind == FaultKind::kNone || t_s < fault.time_s) return 0.0;
  if (std::isinf(fault.rate_per_s)) return 1.0;
  return -std::expm1(-fault.rate_per_s * (t_s - fault.time_s));
}

TwoLinkParameters faulty_arm(const TwoLinkParameters& healthy, const Fault& fault, double t_s) {
  TwoLinkParameters arm = healthy;
  if (fault.kind == FaultKind::kMassLoss) {
    arm.mass1_kg *= 1.0 - fault.mass_loss * time_profile(fault, t_s);
  }
  if (fault.kind == FaultKind::kPayload) {
    arm.mass2_kg += fault.payload_kg * time_profile(fault, t_s);
  }
  return arm;
}

Eigen::Vector2d nonlinear_fault(const TwoLinkState& state) {
  const double q1 = state.q[0], q2 = state.q[1], dq2 = state.dq[1];
  return {7.5 * q1 * q1 + 10.0 * q1 * q1 * dq2 * dq2 + 7.0 * q2 + 17.0, 50.0 * q1 * q2 + 12.5};
}

}  // namespace offnominal::sim
