#include "offnominal/sim/two_link_plant.hpp"

#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "offnominal/sim/runge_kutta.hpp"

namespace offnominal::sim {
namespace {

void require_positive(const char* name, double value) {
  if (value > 0.0 && std::isfinite(value)) return;
  throw std::invalid_argument(std::string("two-link arm ") + name + ": found " +
                              std::to_string(value) + ", allowed is above 0");
}

}  // namespace

TwoLinkPlant::TwoLinkPlant(const TwoLinkParameters& arm, const Fault& fault,
                           Uncertainty uncertainty)
    : arm_(arm), fault_(fault), uncertainty_(std::move(uncertainty)) {
  require_positive("mass1_kg", arm.mass1_kg);
  require_positive("mass2_kg", arm.mass2_kg);
  require_positive("length1_m", arm.length1_m);
  require_positive("length2_m", arm.length2_m);
  if (!std::isfinite(arm.gravity_m_s2)) {
    throw std::invalid_argument("two-link arm gravity_m_s2: not a finite number");
  }
  validate(fault);
  if (!uncertainty_) throw std::invalid_argument("two-link plant: the uncertainty is empty");
}

Eigen::Vector2d TwoLinkPlant::acceleration(double t_s, const TwoLinkState& state,
                                           const Eigen::Vector2d& tau) const {
  const Eigen::Vector2d net = tau - uncertainty_(t_s, state);
  Eigen::Vector2d ddq = forward_acceleration(faulty_arm(arm_, fault_, t_s), state, net);
  if (fault_.kind == FaultKind::kNonlinear) {
    ddq += time_profile(fault_, t_s) * nonlinear_fault(state);
  }
  return ddq;
}

Eigen::Vector2d TwoLinkPlant::fault_function(double t_s, const TwoLinkState& state,
                                             const Eigen::Vector2d& tau) const {
  switch (fault_.kind) {
    case FaultKind::kNone:
      break;
    case FaultKind::kNonlinear:
      return time_profile(fault_, t_s) * nonlinear_fault(state);
    case FaultKind::kMassLoss:
    case FaultKind::kPayload: {
      if (t_s < fault_.time_s) break;
      const Eigen::Vector2d net = tau - uncertainty_(t_s, state);
      return forward_acceleration(faulty_arm(arm_, fault_, t_s), state, net) -
             forward_acceleration(arm_, state, net);
    }
  }
  return Eigen::Vector2d::Zero();
}

Eigen::Vector2d TwoLinkPlant::uncertainty_acceleration(double t_s,
                                                       const TwoLinkState& state) const {
  const Eigen::Vector2d bias = velocity_torque(arm_, state) + gravity_torque(arm_, state.q);
  return forward_acceleration(arm_, state, bias - uncertainty_(t_s, state));
}

TwoLinkState TwoLinkPlant::step(double t_s, const TwoLinkState& state, const Eigen::Vector2d& tau,
                                double period_s, int substeps) const {
  if (!(period_s > 0.0) || substeps < 1) {
    throw std::invalid_argument("two-link plant step: period_s " + std::to_string(period_s) +
                                ", substeps " + std::to_string(substeps) +
                                "; allowed is period_s above 0 and substeps at least 1");
  }
  const auto derivative = [&](double t, const Eigen::Vector4d& x) -> Eigen::Vector4d {
    const TwoLinkState s{x.head<2>(), x.tail<2>()};
    Eigen::Vector4d dx;
    dx << s.dq, acceleration(t, s, tau);
    return dx;
  };
  const double h = period_s / substeps;
  Eigen::Vector4d x;
  x << state.q, state.dq;
  for (int i = 0; i < substeps; ++i) x = runge_kutta4_step(t_s + i * h, x, h, derivative);
  return {x.head<2>(), x.tail<2>()};
}

}  // namespace offnominal::sim
