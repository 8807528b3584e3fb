// Draws a robot, what its owner knows of it, and what is hidden in it.
//
// Sizes, before the request's effect_size. "Share" is the root mean square of the effect's torque
// over that of the joint's torque, on the rich motion of the rigid, frictionless arm; "level" is
// a torque over that root mean square.
//
// | what | drawn, uniform |
// |---|---|
// | mass of link 1, 2 | 2-6, 1-4 kg |
// | length of link 1, 2 | 0.35-0.6, 0.3-0.5 m; centre of mass at 0.4-0.6 of it |
// | inertia | that of a rod of 0.7-1.1 of the length |
// | known rotor inertia | 0.2-0.5 of the arm's at that joint, elbow at a right angle |
// | known Coulomb friction | level 0.06-0.12, pre-sliding width 5e-5-2e-4 rad |
// | known viscous friction | share 0.04-0.1 |
// | coulomb_friction | level 0.05-0.14 |
// | viscous_friction, quadratic_friction | share 0.04-0.12 |
// | stribeck_friction | share 0.03-0.07, velocity 0.1-0.4 rad/s |
// | friction_asymmetry | 0.3-0.7 of the Coulomb level and, apart, of the viscous coefficient |
// | load_dependent_friction | coefficient 0.04-0.12 |
// | hysteresis | level 0.06-0.15, width 0.05-0.2 rad |
// | torque_offset | level 0.03-0.1, either sign |
// | torque_scale | 0.06-0.2, either sign |
// | rotor_inertia, joint_stiffness | share 0.04-0.12; rest within 0.5 rad of the mean position |
// | link_mass | 0.12-0.4 of the link |
// | tip_payload | share 0.08-0.18 at joint 2 |
// | cogging_torque | share 0.03-0.09, order 6-72 per turn |
// | periodic_disturbance | share 0.03-0.09, 1-15 Hz |
// | joint_coupling | share 0.03-0.09, by velocity (either sign) or by direction |
// | joint_elasticity | share 0.02-0.06 of the deflection, ringing apart; damping ratio 0.04-0.1 |
// | backlash | gap 0.004-0.025 rad; flanks of 30 Hz with the link |
// | time_delay | 2-6 ms |
// | temperature_drift | 0.7-1.5 of Coulomb and viscous friction, time constant 8-20 s |
// | end stop, worn spot, drag band, magnetic saturation | share 0.05-0.12 |
// | transient contact | 2 or 3 pushes of 0.3-1.2 s, peak level 0.3-0.8, either sign |
//
// In closed loop (20 seeds, 30 s) that is 3 to 15 % of the joint's torque, but 1 to 3 % for
// time_delay, up to 20 % for torque_scale and up to 28 % for link_mass; backlash is 6 % below 20
// Hz, under impacts of several times that. The tests print it.
#pragma once

#include "offnominal/sim/hidden/case.hpp"
#include "offnominal/sim/hidden/motion.hpp"
#include "offnominal/sim/hidden/robot.hpp"

namespace offnominal::sim::hidden {

/// The rich motion of the robot sampled over 30 s, with the torques of its rigid arm: what sizes
/// are drawn against.
struct Survey {
  Eigen::MatrixXd q, dq, ddq, tau;  ///< n x 2, at kSurveyRateHz
  Eigen::Vector2d rms_nm;

  /// Factor that gives an effect of this torque per unit (n values) the share of the joint's rms.
  [[nodiscard]] double scale_to(double share, int joint, const Eigen::VectorXd& unit_torque) const;
};

inline constexpr double kSurveyRateHz = 50.0;

Survey survey(const Robot& robot, const Motion& motion);

struct DrawnRobot {
  Robot robot;
  Nominal nominal;
  Truth truth;
  Eigen::Vector2d centre_rad;  ///< of its motions
};

/// Throws as validate().
DrawnRobot draw_robot(const Request& request);

/// What hiding something needs and changes.
struct HidingPlace {
  int joint = 0;
  double size = 1.0;  ///< factor on what is drawn
  const Survey& survey;
  Draws& draws;
  Robot& robot;
  Nominal& nominal;
};

/// Hides an effect and says what was hidden. Effects that build on another's numbers (asymmetry and
/// temperature drift on the friction) come after it, which is the order of the enumeration.
TrueEffect hide_effect(HiddenEffect effect, const HidingPlace& place);
TrueOutsideEffect hide_outside_effect(OutsideEffect effect, const HidingPlace& place);

/// The pushes of one run; none where the robot has no transient contact.
std::vector<Contact> draw_contacts(const Robot& robot, double duration_s, Draws draws);

/// Desired motion of the recording (Stream::kMotion) or of the hold-out (Stream::kHoldoutMotion).
Motion drawn_motion(const Request& request, const Eigen::Vector2d& centre_rad, Stream stream);

}  // namespace offnominal::sim::hidden
