#include "offnominal/sim/hidden/plant.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace offnominal::sim::hidden {
namespace {

using Eigen::Vector2d;

constexpr double kBristleDampingRatio = 0.3;

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

MotorSide Plant::motor_side(int joint, const PlantState& state, double t_s) {
  return {state.motor_q[joint],
          state.motor_dq[joint],
          state.motor_dq[1 - joint],
          state.stretch[joint],
          state.belt_stretch[joint],
          state.gear_load_nm[joint],
          t_s};
}

double Plant::friction_torque(int joint, const PlantState& state, double t_s) const {
  const auto j = static_cast<std::size_t>(joint);
  const JointFriction& friction = robot_.joints[j].friction;
  const MotorSide at = motor_side(joint, state, t_s);
  return bristles_[j].torque(at.stretch, at.dq, friction.sliding_level(at)) +
         friction.soft_level_nm * state.soft_stretch[joint] + friction.viscous_torque(at);
}

double Plant::motor_load(int joint, const PlantState& state, double t_s) const {
  return friction_torque(joint, state, t_s) +
         robot_.joints[static_cast<std::size_t>(joint)].loads.on_motor(
             motor_side(joint, state, t_s));
}

double Plant::link_load(int joint, const PlantState& state, double t_s) const {
  return robot_.joints[static_cast<std::size_t>(joint)].loads.on_link(state.link_q[joint], t_s) +
         push(contacts_, joint, t_s);
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
