#include <algorithm>
#include <cmath>

#include "offnominal/sim/hidden/draw_robot.hpp"

namespace offnominal::sim::hidden {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using Parameters = std::vector<TrueParameter>;

// Value that a share of the samples stays below.
double quantile(VectorXd values, double share) {
  std::sort(values.data(), values.data() + values.size());
  return values[static_cast<Index>(share * static_cast<double>(values.size() - 1))];
}

double drawn_scale(const HidingPlace& place, const VectorXd& unit_torque) {
  return place.size *
         place.survey.scale_to(place.draws.uniform(0.05, 0.12), place.joint, unit_torque);
}

VectorXd bump(const VectorXd& x, double centre, double half_width) {
  return (-((x.array() - centre) / half_width).square()).exp();
}

Parameters hide_end_stop(const HidingPlace& place, RobotJoint& joint) {
  const VectorXd q = place.survey.q.col(place.joint);
  JointLoads& loads = joint.loads;
  loads.stop_side = place.draws.sign();
  const double beyond = place.draws.uniform(0.08, 0.2);  // share of the time behind it
  loads.stop_position_rad = quantile(q, loads.stop_side > 0.0 ? 1.0 - beyond : beyond);
  const VectorXd pressed = (loads.stop_side * (q.array() - loads.stop_position_rad)).max(0.0);
  loads.stop_nm_rad = drawn_scale(place, pressed);
  return {{"position", loads.stop_position_rad, "rad"},
          {"stiffness", loads.stop_nm_rad, "N m/rad"},
          {"side", loads.stop_side, ""}};
}

Parameters hide_worn_spot(const HidingPlace& place, RobotJoint& joint) {
  const VectorXd q = place.survey.q.col(place.joint);
  JointFriction& friction = joint.friction;
  friction.worn_position_rad = quantile(q, place.draws.uniform(0.25, 0.75));
  friction.worn_half_width_rad = place.draws.uniform(0.06, 0.18);
  friction.worn_nm =
      drawn_scale(place, bump(q, friction.worn_position_rad, friction.worn_half_width_rad));
  return {{"level", friction.worn_nm, "N m"},
          {"position", friction.worn_position_rad, "rad"},
          {"half_width", friction.worn_half_width_rad, "rad"}};
}

Parameters hide_drag_band(const HidingPlace& place, RobotJoint& joint) {
  const VectorXd speed = place.survey.dq.col(place.joint).cwiseAbs();
  JointFriction& friction = joint.friction;
  friction.band_speed_rad_s = quantile(speed, place.draws.uniform(0.5, 0.75));
  friction.band_half_width_rad_s = friction.band_speed_rad_s * place.draws.uniform(0.15, 0.3);
  friction.band_nm =
      drawn_scale(place, bump(speed, friction.band_speed_rad_s, friction.band_half_width_rad_s));
  return {{"level", friction.band_nm, "N m"},
          {"speed", friction.band_speed_rad_s, "rad/s"},
          {"half_width", friction.band_half_width_rad_s, "rad/s"}};
}

Parameters hide_saturation(const HidingPlace& place, RobotJoint& joint) {
  const VectorXd load = place.survey.tau.col(place.joint).cwiseAbs();
  JointDrive& drive = joint.drive;
  drive.saturation_onset_nm = quantile(load, place.draws.uniform(0.55, 0.7));
  const VectorXd excess = (load.array() - drive.saturation_onset_nm).max(0.0);
  // The drive has to log more than the load: 1 / slope of the excess.
  const double missing = drawn_scale(place, excess);
  drive.saturation_slope = 1.0 / (1.0 + missing);
  return {{"onset", drive.saturation_onset_nm, "N m"}, {"slope", drive.saturation_slope, ""}};
}

Parameters hide_contact(const HidingPlace& place) {
  place.robot.contact_joint = place.joint;
  place.robot.contact_peak_nm = place.size * place.draws.uniform(0.3, 0.8) * place.draws.sign() *
                                place.survey.rms_nm[place.joint];
  return {{"peak", place.robot.contact_peak_nm, "N m"}};
}

}  // namespace

TrueOutsideEffect hide_outside_effect(OutsideEffect effect, const HidingPlace& place) {
  RobotJoint& joint = place.robot.joints[static_cast<std::size_t>(place.joint)];
  TrueOutsideEffect hidden{effect, place.joint, {}};
  switch (effect) {
    case OutsideEffect::kNone:
      break;
    case OutsideEffect::kEndStop:
      hidden.parameters = hide_end_stop(place, joint);
      break;
    case OutsideEffect::kWornSpot:
      hidden.parameters = hide_worn_spot(place, joint);
      break;
    case OutsideEffect::kDragBand:
      hidden.parameters = hide_drag_band(place, joint);
      break;
    case OutsideEffect::kMagneticSaturation:
      hidden.parameters = hide_saturation(place, joint);
      break;
    case OutsideEffect::kTransientContact:
      hidden.parameters = hide_contact(place);
      break;
  }
  return hidden;
}

std::vector<Contact> draw_contacts(const Robot& robot, double duration_s, Draws draws) {
  std::vector<Contact> contacts;
  if (robot.contact_peak_nm == 0.0) return contacts;
  const int count = 2 + draws.below(2);
  // One per part of the run, so that they do not meet.
  const double part_s = duration_s / count;
  for (int i = 0; i < count; ++i) {
    const double length_s = std::min(draws.uniform(0.3, 1.2), 0.8 * part_s);
    const double start_s = i * part_s + draws.uniform(0.1, 0.9) * (part_s - length_s);
    contacts.push_back({robot.contact_joint, start_s, length_s, robot.contact_peak_nm});
  }
  return contacts;
}

}  // namespace offnominal::sim::hidden
