// Friction with a pre-sliding state (LuGre). C. Canudas de Wit, H. Olsson, K. J. Astrom,
// P. Lischinsky, "A new model for control of systems with friction", IEEE Trans. Automatic Control
// 40(3), 1995: a bristle of deflection z is dragged along and slips,
//   dz/dt = v - |v| z / z_max(v),   friction = sigma0 z + damping.
// Here z is carried as the stretch s = z / width: s = +-g(v) / level in steady sliding, and 63 % of
// a reversal is done within the width.
#pragma once

namespace offnominal::sim::hidden {

class Bristle {
 public:
  Bristle() = default;
  /// width_rad > 0; inertia_kg_m2 moved by the friction sets the damping of the stuck bristle, 0
  /// for none.
  Bristle(double width_rad, double damping_ratio, double inertia_kg_m2);

  /// The stretch after a time h_s > 0 at constant velocity; exact, hence stable for any step.
  [[nodiscard]] double advance(double stretch, double velocity_rad_s, double h_s) const;

  /// Friction torque, N m, positive against a positive velocity; level_nm >= 0 is that of steady
  /// sliding.
  [[nodiscard]] double torque(double stretch, double velocity_rad_s, double level_nm) const;

 private:
  double width_rad_ = 1e-3;
  double damping_ratio_ = 0.0;
  double inertia_kg_m2_ = 0.0;
};

}  // namespace offnominal::sim::hidden
