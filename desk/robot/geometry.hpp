#pragma once

#include <array>
#include <optional>
#include <string>

namespace offnominal::desk {

/// A vector whose length is 1 within 1e-6, made a unit vector; one that is a unit vector to the
/// last bits stays as it is. None where its length is another.
[[nodiscard]] std::optional<std::array<double, 3>> unit_vector(const std::array<double, 3>& vector);

/// A turn, as it is rounded up: of angles between frames nobody needs more, and degrees are beyond.
inline constexpr double kMostAngleRad = 6.2832;

/// The rotation, row by row, of roll, pitch, yaw about the fixed x, y, z axes in this order (rad):
/// Rz(yaw) Ry(pitch) Rx(roll), as in URDF.
[[nodiscard]] std::array<double, 9> rotation_of_rpy(const std::array<double, 3>& rpy_rad);

/// A matrix, row by row, that is a rotation within 1e-6, made one exactly (the nearest one); one
/// that is a rotation to the last bits stays as it is. None for any other matrix.
[[nodiscard]] std::optional<std::array<double, 9>> nearest_rotation(
    const std::array<double, 9>& matrix);

/// What is impossible about an inertia tensor xx, yy, zz, xy, xz, yz, in words with its principal
/// moments; empty where a body can have it.
[[nodiscard]] std::string inertia_fault(const std::array<double, 6>& inertia_kg_m2);

/// By how much of its largest principal moment a positive definite tensor breaks the triangle
/// inequality; none for one that does not, or is not positive definite.
[[nodiscard]] std::optional<double> broken_triangle(const std::array<double, 6>& inertia_kg_m2);

/// The nearest tensor that a body can have: second moments of its mass below zero become none. A
/// triangle inequality that is broken has the two smaller principal moments raised by as much each.
/// None where the trace is not above 0.
[[nodiscard]] std::optional<std::array<double, 6>> nearest_inertia(
    const std::array<double, 6>& inertia_kg_m2);

}  // namespace offnominal::desk
