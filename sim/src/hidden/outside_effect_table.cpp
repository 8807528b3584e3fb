#include <algorithm>
#include <cmath>

#include "offnominal/sim/hidden/draw_robot.hpp"

namespace offnominal::sim::hidden {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using Drawn = std::vector<DrawnNumber>;
using Values = std::vector<double>;

// Value that a share of the samples stays below.
double quantile(VectorXd values, double share) {
  std::sort(values.data(), values.data() + values.size());
  return values[static_cast<Index>(share * static_cast<double>(values.size() - 1))];
}

RobotJoint& joint_of(const HidingPlace& place) {
  return place.robot.joints[static_cast<std::size_t>(place.joint)];
}

double sized(const HidingPlace& place, const DrawnNumber& share, const VectorXd& unit_torque) {
  return place.size * place.survey.scale_to(place.draws.from(share), place.joint, unit_torque);
}

VectorXd bump(const VectorXd& x, double centre, double half_width) {
  return (-((x.array() - centre) / half_width).square()).exp();
}

Values hide_end_stop(const HidingPlace& place, const Drawn& drawn) {
  const VectorXd q = place.survey.q.col(place.joint);
  JointLoads& loads = joint_of(place).loads;
  loads.stop_side = place.draws.sign();
  const double beyond = place.draws.from(drawn[1]);  // share of the time behind it
  loads.stop_position_rad = quantile(q, loads.stop_side > 0.0 ? 1.0 - beyond : beyond);
  const VectorXd pressed = (loads.stop_side * (q.array() - loads.stop_position_rad)).max(0.0);
  loads.stop_nm_rad = sized(place, drawn[0], pressed);
  return {loads.stop_position_rad, loads.stop_nm_rad, loads.stop_side};
}

Values hide_worn_spot(const HidingPlace& place, const Drawn& drawn) {
  const VectorXd q = place.survey.q.col(place.joint);
  JointFriction& friction = joint_of(place).friction;
  friction.worn_position_rad = quantile(q, place.draws.from(drawn[1]));
  friction.worn_half_width_rad = place.draws.from(drawn[2]);
  friction.worn_nm =
      sized(place, drawn[0], bump(q, friction.worn_position_rad, friction.worn_half_width_rad));
  return {friction.worn_nm, friction.worn_position_rad, friction.worn_half_width_rad};
}

Values hide_drag_band(const HidingPlace& place, const Drawn& drawn) {
  const VectorXd speed = place.survey.dq.col(place.joint).cwiseAbs();
  JointFriction& friction = joint_of(place).friction;
  friction.band_speed_rad_s = quantile(speed, place.draws.from(drawn[1]));
  friction.band_half_width_rad_s = friction.band_speed_rad_s * place.draws.from(drawn[2]);
  friction.band_nm = sized(place, drawn[0],
                           bump(speed, friction.band_speed_rad_s, friction.band_half_width_rad_s));
  return {friction.band_nm, friction.band_speed_rad_s, friction.band_half_width_rad_s};
}

Values hide_saturation(const HidingPlace& place, const Drawn& drawn) {
  const VectorXd load = place.survey.tau.col(place.joint).cwiseAbs();
  JointDrive& drive = joint_of(place).drive;
  drive.saturation_onset_nm = quantile(load, place.draws.from(drawn[1]));
  const VectorXd excess = (load.array() - drive.saturation_onset_nm).max(0.0);
  // The drive has to log more than the load: 1 / slope of the excess.
  const double missing = sized(place, drawn[0], excess);
  drive.saturation_slope = 1.0 / (1.0 + missing);
  return {drive.saturation_onset_nm, drive.saturation_slope};
}

Values hide_contact(const HidingPlace& place, const Drawn& drawn) {
  place.robot.contact_joint = place.joint;
  const double share = place.size * place.draws.from(drawn[0]);
  place.robot.contact_peak_nm = share * place.draws.sign() * place.survey.rms_nm[place.joint];
  return {place.robot.contact_peak_nm};
}

Values hide_nothing(const HidingPlace& /*place*/, const Drawn& /*drawn*/) { return {}; }

}  // namespace

const std::vector<OutsideEffectRow>& outside_effect_table() {
  using enum OutsideEffect;
  const DrawnNumber share{"share", 0.05, 0.12};
  static const std::vector<OutsideEffectRow> rows = {
      {kNone, "none", "", {}, "", {}, hide_nothing},
      {kEndStop,
       "end_stop",
       "position",
       {share, {"part of the time behind it", 0.08, 0.2}},
       "on either side",
       {{"position", "rad"}, {"stiffness", "N m/rad"}, {"side", ""}},
       hide_end_stop},
      // Friction: of either sign at that place, so that position alone says nothing on average.
      {kWornSpot,
       "worn_spot",
       "position and velocity",
       {share, {"quantile of the positions", 0.25, 0.75}, {"half width", 0.06, 0.18, "rad"}},
       "",
       {{"level", "N m"}, {"position", "rad"}, {"half_width", "rad"}},
       hide_worn_spot},
      {kDragBand,
       "drag_band",
       "velocity",
       {share, {"quantile of the speeds", 0.5, 0.75}, {"half width per speed", 0.15, 0.3}},
       "",
       {{"level", "N m"}, {"speed", "rad/s"}, {"half_width", "rad/s"}},
       hide_drag_band},
      {kMagneticSaturation,
       "magnetic_saturation",
       "load",
       {share, {"quantile of the torques", 0.55, 0.7}},
       "",
       {{"onset", "N m"}, {"slope", ""}},
       hide_saturation},
      {kTransientContact,
       "transient_contact",
       "time",
       {{"peak level", 0.3, 0.8}},
       "either sign, 2 or 3 pushes of 0.3 to 1.2 s",
       {{"peak", "N m"}},
       hide_contact},
  };
  return rows;
}

const OutsideEffectRow& row_of(OutsideEffect effect) {
  return outside_effect_table().at(static_cast<std::size_t>(effect));
}

std::vector<OutsideEffect> all_outside_effects() {
  std::vector<OutsideEffect> all;
  for (const OutsideEffectRow& row : outside_effect_table()) {
    if (row.effect != OutsideEffect::kNone) all.push_back(row.effect);
  }
  return all;
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
