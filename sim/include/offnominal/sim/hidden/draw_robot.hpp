// Draws a robot, what its owner knows of it, and what is hidden in it.
//
// "Share" and "level" are those of effect_table.hpp.
//
// | what | drawn, uniform |
// |---|---|
// | mass of link 1, 2 | 2-6, 1-4 kg |
// | length of link 1, 2 | 0.35-0.6, 0.3-0.5 m; centre of mass at 0.4-0.6 of it |
// | inertia | that of a rod of 0.7-1.1 of the length |
// | known rotor inertia | 0.2-0.5 of the arm's at that joint, elbow at a right angle |
// | known Coulomb friction | level 0.06-0.12, pre-sliding width 5e-5-2e-4 rad |
// | known viscous friction | share 0.04-0.1 |
//
// What is hidden is drawn as effect_table.hpp says.
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

/// What hiding something needs and changes (effect_table.hpp).
struct HidingPlace {
  int joint = 0;
  double size = 1.0;  ///< factor on what is drawn
  const Survey& survey;
  Draws& draws;
  Robot& robot;
  Nominal& nominal;
};

/// The pushes of one run; none where the robot has no transient contact.
std::vector<Contact> draw_contacts(const Robot& robot, double duration_s, Draws draws);

/// Desired motion of the recording (Stream::kMotion) or of the hold-out (Stream::kHoldoutMotion).
Motion drawn_motion(const Request& request, const Eigen::Vector2d& centre_rad, Stream stream);

}  // namespace offnominal::sim::hidden
