// One case of the blind benchmark: a robot with something hidden in it, what its owner knows, what
// the log shows, and the answer. The arm moves in the vertical x-y plane, gravity along -y; q1 is
// the angle of link 1 from the x axis, q2 that of link 2 from link 1, counter-clockwise. Arrays and
// columns count joints from 0.
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "offnominal/sim/hidden/request.hpp"

namespace offnominal::sim::hidden {

struct NominalLink {
  double mass_kg = 0.0;
  double length_m = 0.0;
  double centre_of_mass_m = 0.0;  ///< on the line from the link's joint to its end
  double inertia_kg_m2 = 0.0;     ///< about the centre of mass, axis normal to the plane
};

struct NominalJoint {
  double viscous_nm_s_rad = 0.0;     ///< known viscous friction; 0 where that is what is hidden
  double coulomb_nm = 0.0;           ///< known Coulomb friction; 0 where that is what is hidden
  double rotor_inertia_kg_m2 = 0.0;  ///< known, seen at the joint; 0 where that is what is hidden
  double position_min_rad = 0.0;
  double position_max_rad = 0.0;
  double velocity_limit_rad_s = 0.0;
  double torque_limit_nm =
      0.0;  ///< about twice the peak of the rich motion; noise is a share of it
};

/// What the robot file will say. Per link mass and inertia are off by the same factor within 3 %,
/// friction coefficients by up to 10 %, rotor inertias by up to 3 %; lengths, centres of mass and
/// gravity are exact.
struct Nominal {
  std::array<NominalLink, 2> links;
  std::array<NominalJoint, 2> joints;
  double gravity_m_s2 = 9.81;
  int encoder_bits = 19;
};

struct TrueParameter {
  std::string name;  ///< as in robot files where there is such an effect
  double value = 0.0;
  std::string unit;
};

/// A hidden effect with the parameters of its row in effect_table.hpp. Its torque is what the drive
/// has to supply for it.
struct TrueEffect {
  HiddenEffect effect = HiddenEffect::kCoulombFriction;
  int joint = 0;
  std::vector<TrueParameter> parameters;
};

struct TrueOutsideEffect {
  OutsideEffect effect = OutsideEffect::kNone;
  int joint = 0;
  std::vector<TrueParameter> parameters;
};

struct Truth {
  std::vector<TrueEffect> effects;  ///< in the order of the request
  TrueOutsideEffect outside;
  DataFault fault = DataFault::kNone;
  std::vector<TrueParameter> fault_parameters;
};

/// A log: row k holds the encoders' reading (motor side) at t_s[k], rad, and the torque that the
/// drive was told to give from then until the next row, N m, as measured with noise.
struct Recording {
  Eigen::VectorXd t_s;
  Eigen::MatrixXd q;
  Eigen::MatrixXd tau;
};

struct Case {
  Nominal nominal;
  Truth truth;
  Recording recording;
  Recording holdout;  ///< 15 s of the same robot, another motion of the same excitation
};

/// The same request gives the same bytes; requests that differ in effects, noise or excitation
/// alone have the same arm. Throws as validate().
Case make_case(const Request& request);

/// The robot of make_case(request), driven along the desired positions `q_desired` (n x 2, rad) at
/// the times t_s (n >= 2, strictly rising from 0), sampled at request.sample_rate_hz from 0 to the
/// last of them. Excitation and duration of the request are ignored. Velocities come from a cubic
/// spline through the positions. `run` tells repetitions apart: noise and transient contacts are
/// drawn from it. Throws std::invalid_argument on times or positions that are none, and
/// std::runtime_error where the robot cannot follow and runs away.
Recording record_motion(const Request& request, const Eigen::VectorXd& t_s,
                        const Eigen::MatrixXd& q_desired, std::uint64_t run = 0);

}  // namespace offnominal::sim::hidden
