#include "offnominal/sim/uncertainty.hpp"

#include <cmath>

namespace offnominal::sim {

Eigen::Vector2d paper_friction(const Eigen::Vector2d& dq) {
  const double sign1 = dq[0] > 0.0 ? 1.0 : (dq[0] < 0.0 ? -1.0 : 0.0);
  return {0.5 * sign1 + 2.0 * dq[0], 0.5 * std::sin(dq[1]) + 2.0 * dq[1]};
}

Eigen::Vector2d paper_disturbance(double t_s) {
  return Eigen::Vector2d::Constant(0.5 * std::sin(30.0 * t_s));
}

Uncertainty paper_uncertainty() {
  return [](double t_s, const TwoLinkState& state) -> Eigen::Vector2d {
    return paper_friction(state.dq) + paper_disturbance(t_s);
  };
}

Uncertainty no_uncertainty() {
  return [](double, const TwoLinkState&) -> Eigen::Vector2d { return Eigen::Vector2d::Zero(); };
}

}  // namespace offnominal::sim
