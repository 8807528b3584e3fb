#pragma once

#include <Eigen/Core>

#include "identify/inertial_regressor.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk {

// The ten numbers of a body as one symmetric matrix J = [S h; h' m], S the second moments of its
// mass about the frame's origin. Some distribution of mass has these numbers if and only if J is
// positive definite (P. M. Wensing, S. Kim, J.-J. E. Slotine, IEEE RA-L 3(1), 2018).
using PseudoInertia = Eigen::Matrix4d;

PseudoInertia pseudo_inertia_of(const InertialNumbers& numbers);
InertialNumbers inertial_numbers_of(const PseudoInertia& inertia);

// Upper triangular U with J = U U'. J is positive definite.
Eigen::Matrix4d upper_factor_of(const PseudoInertia& inertia);

// Coordinates of all bodies that there can be, about one of them: J = P V V' P', P the upper factor
// of that body, V = e^a [e^d1 s12 s13 t1; 0 e^d2 s23 t2; 0 0 e^d3 t3; 0 0 0 1] (C. Rucker, P. M.
// Wensing, IEEE RA-L 7(2), 2022). Any ten numbers are a body; all 0 are the one that they are
// about. In order: a (half the logarithm of the mass), d1 d2 d3 (of the extent), s12 s13 s23 (of
// the shape), t1 t2 t3 (of the centre of mass, in radii of gyration).
using LogCholesky = Eigen::Matrix<double, kInertialNumbers, 1>;

InertialNumbers inertial_numbers_at(const Eigen::Matrix4d& about, const LogCholesky& point);

// d numbers / d coordinates.
Eigen::Matrix<double, kInertialNumbers, kInertialNumbers> inertial_slopes_at(
    const Eigen::Matrix4d& about, const LogCholesky& point);

// Mass, centre of mass and inertia about it of a body with these numbers, whose mass is above 0.
void put_inertia(const InertialNumbers& numbers, Joint<double>& joint);

}  // namespace offnominal::desk
