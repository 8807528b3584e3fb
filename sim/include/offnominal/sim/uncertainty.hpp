// What the plant does that the nominal model does not know: F + tau_d of the paper's equation (1).
#pragma once

#include <Eigen/Core>
#include <functional>

#include "offnominal/sim/two_link_arm.hpp"

namespace offnominal::sim {

/// Joint torque that opposes the drive, F + tau_d in N m, at time t_s in this state. It is
/// subtracted from the drive torque. A function of state and time alone, so that an integrator may
/// ask for it at any stage.
using Uncertainty = std::function<Eigen::Vector2d(double t_s, const TwoLinkState& state)>;

/// F(dq) of section 5: [0.5 sgn(dq1) + 2 dq1, 0.5 sin(dq2) + 2 dq2], sgn(0) = 0.
Eigen::Vector2d paper_friction(const Eigen::Vector2d& dq);

/// tau_d(t) of section 5: 0.5 sin(30 t) on both joints, as its norm of the uncertainty implies.
Eigen::Vector2d paper_disturbance(double t_s);

/// paper_friction + paper_disturbance.
Uncertainty paper_uncertainty();

/// A plant that is exactly its rigid-body model.
Uncertainty no_uncertainty();

}  // namespace offnominal::sim
