#include "offnominal/sim/hidden/bristle.hpp"

#include <cmath>

namespace offnominal::sim::hidden {
namespace {

// The stuck bristle is damped below this speed only: with a constant damping LuGre is not passive.
constexpr double kDampedSpeedRadS = 0.02;

}  // namespace

Bristle::Bristle(double width_rad, double damping_ratio, double inertia_kg_m2)
    : width_rad_(width_rad), damping_ratio_(damping_ratio), inertia_kg_m2_(inertia_kg_m2) {}

double Bristle::advance(double stretch, double velocity_rad_s, double h_s) const {
  const double end = velocity_rad_s > 0.0 ? 1.0 : -1.0;
  const double slipped = std::abs(velocity_rad_s) * h_s / width_rad_;
  return slipped > 40.0 ? end : end + (stretch - end) * std::exp(-slipped);
}

double Bristle::torque(double stretch, double velocity_rad_s, double level_nm) const {
  const double elastic = level_nm * stretch;
  const double ratio = velocity_rad_s / kDampedSpeedRadS;
  if (damping_ratio_ == 0.0 || std::abs(ratio) > 4.0) return elastic;
  const double damping = 2.0 * damping_ratio_ * std::sqrt(level_nm / width_rad_ * inertia_kg_m2_);
  const double stretching = velocity_rad_s - std::abs(velocity_rad_s) * stretch;
  return elastic + damping * stretching * std::exp(-ratio * ratio);
}

}  // namespace offnominal::sim::hidden
