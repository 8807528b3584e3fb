#include "offnominal/sim/hidden/plant.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace offnominal::sim::hidden {
namespace {

using Eigen::Vector2d;

constexpr double kBristleDampingRatio = 0.3;

// 1 at the centre, 1/e at the half width.
double bump(double x, double centre, double half_width) {
  const double d = (x - centre) / half_width;
  return std::exp(-d * d);
}

double push(const std::vector<Contact>& contacts, int joint, double t_s) {
  double torque = 0.0;
  for (const Contact& c : contacts) {
    const double phase = (t_s - c.start_s) / c.duration_s;
    if (c.joint != joint || phase <= 0.0 || phase >= 1.0) continue;
    torque += c.peak_nm * std::sin(std::numbers::pi * phase);
  }
  return torque;
}

}  // namespace

Plant::Plant(const Robot& robot, std::vector<Contact> contacts)
    : robot_(robot), arm_(robot.arm()), contacts_(std::move(contacts)) {
  const PlanarArm::Terms folded =
      arm_.terms({0.0, std::numbers::pi / 2.0}, {0.0, 0.0});  // a typical inertia
  for (std::size_t j = 0; j < 2; ++j) {
    const RobotJoint& joint = robot_.joints[j];
    double inertia = joint.transmission.rotor_inertia_kg_m2;
    if (joint.transmission.rigid()) {
      inertia += folded.mass(static_cast<Eigen::Index>(j), static_cast<Eigen::Index>(j));
    }
    bristles_[j] = Bristle(joint.friction.width_rad, kBristleDampingRatio, inertia);
    soft_bristles_[j] = Bristle(joint.friction.soft_width_rad, 0.0, 0.0);
    belts_[j] = Bristle(robot_.joints[1 - j].friction.width_rad, 0.0, 0.0);
  }
}

PlantState Plant::start(const Vector2d& q, const Vector2d& dq, const Vector2d& ddq) const {
  PlantState state;
  state.motor_q = state.link_q = q;
  state.motor_dq = state.link_dq = dq;
  const Vector2d load = arm_.torque(q, dq, ddq);
  for (int j = 0; j < 2; ++j) {
    const JointTransmission& t = robot_.joints[static_cast<std::size_t>(j)].transmission;
    if (t.rigid()) continue;
    const double side = load[j] > 0.0 ? 1.0 : -1.0;
    state.link_q[j] -= load[j] / t.stiffness_nm_rad + side * 0.5 * t.gap_rad;
  }
  state.gear_load_nm = load;
  return state;
}

double Plant::transmitted_torque(int joint, const PlantState& state) const {
  const JointTransmission& t = robot_.joints[static_cast<std::size_t>(joint)].transmission;
  const double twist = state.motor_q[joint] - state.link_q[joint];
  const double rate = state.motor_dq[joint] - state.link_dq[joint];
  if (t.gap_rad == 0.0) return t.stiffness_nm_rad * twist + t.damping_nm_s_rad * rate;
  const double pressed = std::abs(twist) - 0.5 * t.gap_rad;
  if (pressed <= 0.0) return 0.0;
  const double side = twist > 0.0 ? 1.0 : -1.0;
  // Tooth flanks push; they do not pull.
  return side * std::max(0.0, t.stiffness_nm_rad * pressed + t.damping_nm_s_rad * side * rate);
}

double Plant::sliding_level(const JointFriction& f, double position_rad, double velocity_rad_s,
                            double gear_load_nm, double cold) const {
  double level = f.coulomb_nm + f.per_load * std::abs(gear_load_nm) + cold * f.cold_coulomb_nm;
  if (f.stribeck_nm != 0.0) {
    level += f.stribeck_nm * bump(velocity_rad_s, 0.0, f.stribeck_velocity_rad_s);
  }
  if (f.worn_nm != 0.0) {
    level += f.worn_nm * bump(position_rad, f.worn_position_rad, f.worn_half_width_rad);
  }
  if (f.band_nm != 0.0) {
    level +=
        f.band_nm * bump(std::abs(velocity_rad_s), f.band_speed_rad_s, f.band_half_width_rad_s);
  }
  return level;
}

double Plant::friction_torque(int joint, const PlantState& state, double t_s) const {
  const auto j = static_cast<std::size_t>(joint);
  const JointFriction& f = robot_.joints[j].friction;
  const double v = state.motor_dq[joint], stretch = state.stretch[joint];
  const bool warms = f.cold_coulomb_nm != 0.0 || f.cold_viscous_nm_s_rad != 0.0;
  const double cold = warms ? std::exp(-t_s / f.warming_s) : 0.0;
  double level = sliding_level(f, state.motor_q[joint], v, state.gear_load_nm[joint], cold);
  // By the bristle's side, not the velocity's: the torque stays continuous where the joint sticks.
  level += std::copysign(f.coulomb_asymmetry_nm, f.coulomb_asymmetry_nm * stretch);
  const double viscous = f.viscous_nm_s_rad + cold * f.cold_viscous_nm_s_rad +
                         (v > 0.0 ? 1.0 : -1.0) * f.viscous_asymmetry_nm_s_rad;
  return bristles_[j].torque(stretch, v, std::max(0.0, level)) +
         f.soft_level_nm * state.soft_stretch[joint] + viscous * v +
         f.quadratic_nm_s2_rad2 * v * std::abs(v);
}

double Plant::motor_load(int joint, const PlantState& state, double t_s) const {
  const auto j = static_cast<std::size_t>(joint);
  const JointLoads& loads = robot_.joints[j].loads;
  double torque = friction_torque(joint, state, t_s) + loads.offset_nm +
                  loads.coupling_nm_s_rad * state.motor_dq[1 - joint] +
                  loads.belt_nm * state.belt_stretch[joint];
  if (loads.cogging_nm != 0.0) {
    torque += loads.cogging_nm *
              std::sin(loads.cogging_order * state.motor_q[joint] + loads.cogging_phase_rad);
  }
  return torque;
}

double Plant::link_load(int joint, const PlantState& state, double t_s) const {
  const JointLoads& loads = robot_.joints[static_cast<std::size_t>(joint)].loads;
  const double q = state.link_q[joint];
  double torque = loads.spring_nm_rad * (q - loads.spring_rest_rad);
  if (loads.periodic_nm != 0.0) {
    torque += loads.periodic_nm * std::sin(loads.periodic_rad_s * t_s + loads.periodic_phase_rad);
  }
  const double beyond = loads.stop_side * (q - loads.stop_position_rad);
  if (beyond > 0.0) torque += loads.stop_side * loads.stop_nm_rad * beyond;
  return torque + push(contacts_, joint, t_s);
}

Plant::Rates Plant::rates(const PlantState& state, double t_s,
                          const Vector2d& motor_torque_nm) const {
  PlanarArm::Terms terms = arm_.terms(state.link_q, state.link_dq);
  Vector2d motor_net, transmitted = Vector2d::Zero(), drive;
  for (int j = 0; j < 2; ++j) {
    const JointTransmission& t = robot_.joints[static_cast<std::size_t>(j)].transmission;
    motor_net[j] = motor_torque_nm[j] - motor_load(j, state, t_s);
    if (t.rigid()) {
      terms.mass(j, j) += t.rotor_inertia_kg_m2;
      drive[j] = motor_net[j];
    } else {
      drive[j] = transmitted[j] = transmitted_torque(j, state);
    }
    drive[j] -= link_load(j, state, t_s);
  }
  const Vector2d net = drive - terms.bias;
  const Eigen::Matrix2d& m = terms.mass;
  const double det = m(0, 0) * m(1, 1) - m(0, 1) * m(1, 0);
  Rates rates;
  rates.link_ddq = {(m(1, 1) * net[0] - m(0, 1) * net[1]) / det,
                    (m(0, 0) * net[1] - m(1, 0) * net[0]) / det};
  for (int j = 0; j < 2; ++j) {
    const JointTransmission& t = robot_.joints[static_cast<std::size_t>(j)].transmission;
    if (t.rigid()) {
      rates.motor_ddq[j] = rates.link_ddq[j];
      rates.gear_load_nm[j] = motor_net[j] - t.rotor_inertia_kg_m2 * rates.motor_ddq[j];
    } else {
      rates.motor_ddq[j] = (motor_net[j] - transmitted[j]) / t.rotor_inertia_kg_m2;
      rates.gear_load_nm[j] = transmitted[j];
    }
  }
  return rates;
}

void Plant::advance_bristles(PlantState& state, const Vector2d& velocity, double h_s) const {
  for (int j = 0; j < 2; ++j) {
    const auto i = static_cast<std::size_t>(j);
    state.stretch[j] = bristles_[i].advance(state.stretch[j], velocity[j], h_s);
    if (robot_.joints[i].friction.soft_level_nm != 0.0) {
      state.soft_stretch[j] = soft_bristles_[i].advance(state.soft_stretch[j], velocity[j], h_s);
    }
    if (robot_.joints[i].loads.belt_nm != 0.0) {
      state.belt_stretch[j] = belts_[i].advance(state.belt_stretch[j], velocity[1 - j], h_s);
    }
  }
}

void Plant::step(PlantState& state, double t_s, const Vector2d& motor_torque_nm, double h_s) const {
  const double half = 0.5 * h_s;
  const Rates first = rates(state, t_s, motor_torque_nm);
  PlantState middle = state;
  middle.motor_q += half * state.motor_dq;
  middle.link_q += half * state.link_dq;
  middle.motor_dq += half * first.motor_ddq;
  middle.link_dq += half * first.link_ddq;
  advance_bristles(middle, state.motor_dq, half);
  const Rates second = rates(middle, t_s + half, motor_torque_nm);
  state.motor_q += h_s * middle.motor_dq;
  state.link_q += h_s * middle.link_dq;
  state.motor_dq += h_s * second.motor_ddq;
  state.link_dq += h_s * second.link_ddq;
  advance_bristles(state, middle.motor_dq, h_s);
  state.gear_load_nm = second.gear_load_nm;
}

}  // namespace offnominal::sim::hidden
