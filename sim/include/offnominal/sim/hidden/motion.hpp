// Desired motions of both joints.
#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <vector>

#include "offnominal/sim/hidden/draws.hpp"
#include "offnominal/sim/hidden/request.hpp"
#include "offnominal/sim/trajectory.hpp"

namespace offnominal::sim::hidden {

using Motion = std::function<DesiredMotion(double t_s)>;

/// Six sinusoids from 0.1 to 1.5 Hz around `centre_rad`; the four faster ones swell and fade, so
/// that fast phases alternate with slow ones. Peaks about 1 rad and 3 rad/s.
Motion rich_motion(const Eigen::Vector2d& centre_rad, Draws& draws);

/// One of three: a slow small sinusoid of one joint, one speed to and fro, a tiny range.
Motion poor_motion(const Eigen::Vector2d& centre_rad, Draws& draws);

/// Natural cubic spline through given positions; constant beyond its ends. Throws
/// std::invalid_argument unless times rise strictly from 0, are finite and match the positions.
Motion given_motion(const Eigen::VectorXd& t_s, const Eigen::MatrixXd& q_rad);

}  // namespace offnominal::sim::hidden
