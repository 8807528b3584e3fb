// The paper's plant, equation (1): two-link arm, uncertainty and fault.
#pragma once

#include <Eigen/Core>

#include "offnominal/sim/fault.hpp"
#include "offnominal/sim/two_link_arm.hpp"
#include "offnominal/sim/uncertainty.hpp"

namespace offnominal::sim {

class TwoLinkPlant {
 public:
  /// Throws std::invalid_argument on parameters that are not positive (gravity may be any number),
  /// on a wrong fault and on an empty uncertainty.
  TwoLinkPlant(const TwoLinkParameters& arm, const Fault& fault, Uncertainty uncertainty);

  /// ddq under the drive torque tau (N m), with uncertainty and fault, rad/s^2.
  [[nodiscard]] Eigen::Vector2d acceleration(double t_s, const TwoLinkState& state,
                                             const Eigen::Vector2d& tau) const;

  /// beta psi of equation (1): acceleration with the fault less acceleration without it, at the
  /// same time, state, drive torque and uncertainty torque, rad/s^2. Zero before the fault.
  [[nodiscard]] Eigen::Vector2d fault_function(double t_s, const TwoLinkState& state,
                                               const Eigen::Vector2d& tau) const;

  /// -M^-1 (F + tau_d) of the healthy arm, rad/s^2: what the paper's bound must cover.
  [[nodiscard]] Eigen::Vector2d uncertainty_acceleration(double t_s,
                                                         const TwoLinkState& state) const;

  /// State at t_s + period_s under a torque that is held over the period, by `substeps` >= 1 steps
  /// of the classical Runge-Kutta method. Throws std::invalid_argument on period_s <= 0 or
  /// substeps < 1.
  [[nodiscard]] TwoLinkState step(double t_s, const TwoLinkState& state, const Eigen::Vector2d& tau,
                                  double period_s, int substeps = 1) const;

  [[nodiscard]] const TwoLinkParameters& arm() const { return arm_; }
  [[nodiscard]] const Fault& fault() const { return fault_; }

 private:
  TwoLinkParameters arm_;
  Fault fault_;
  Uncertainty uncertainty_;
};

}  // namespace offnominal::sim
