#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <offnominal/sim/hidden/case.hpp>
#include <utility>
#include <vector>

#include "log/log.hpp"
#include "log/sampling.hpp"
#include "robot/robot.hpp"

// Cases of the simulator's blind benchmark as the analysis sees them.

namespace offnominal::test {

// Nominal noise and motion; all else drawn from the seed.
inline sim::hidden::Case case_of(std::uint64_t seed,
                                 std::vector<sim::hidden::HiddenEffect> effects) {
  sim::hidden::Request request;
  request.seed = seed;
  request.effects = std::move(effects);
  return sim::hidden::make_case(request);
}

inline desk::Log to_log(const sim::hidden::Recording& recording) {
  desk::Log log;
  log.file = "hidden case";
  log.period_s = recording.t_s[1] - recording.t_s[0];
  log.t_s = recording.t_s;
  log.q = recording.q;
  log.dq.resize(recording.q.rows(), recording.q.cols());
  log.tau = recording.tau;
  log.dq_derived.assign(static_cast<std::size_t>(recording.q.cols()), true);
  desk::derive_velocities(log);
  return log;
}

// What the robot's owner would have written into its file.
inline desk::RobotDescription to_robot(const sim::hidden::Nominal& nominal) {
  desk::RobotDescription robot;
  robot.name = "hidden case";
  robot.gravity_m_s2 = {0, -nominal.gravity_m_s2, 0};
  for (std::size_t i = 0; i < nominal.joints.size(); ++i) {
    const sim::hidden::NominalLink& link = nominal.links[i];
    const sim::hidden::NominalJoint& known = nominal.joints[i];
    desk::RobotJoint joint;
    joint.name = i == 0 ? "shoulder" : "elbow";
    joint.joint.mass_kg = link.mass_kg;
    joint.joint.centre_of_mass_m = {link.centre_of_mass_m, 0, 0};
    // The moments about the axes in the plane do not act; any that a body can have will do.
    const double inertia = link.inertia_kg_m2;
    joint.joint.inertia_kg_m2 = {inertia / 2, inertia / 2, inertia, 0, 0, 0};
    if (i > 0) joint.joint.origin_m = {nominal.links[i - 1].length_m, 0, 0};
    joint.joint.min_position = known.position_min_rad;
    joint.joint.max_position = known.position_max_rad;
    joint.joint.max_velocity = known.velocity_limit_rad_s;
    joint.joint.max_torque = known.torque_limit_nm;
    joint.encoder.counts_per_unit = std::pow(2.0, nominal.encoder_bits) / (2 * std::numbers::pi);
    robot.joints.push_back(joint);
    const auto add = [&](EffectKind kind, std::array<double, kMaxEffectParameters> parameters) {
      desk::RobotEffect effect;
      effect.kind = kind;
      effect.joint = static_cast<std::uint8_t>(i);
      effect.parameters = parameters;
      effect.fitted = true;
      robot.effects.push_back(effect);
    };
    constexpr double kSmoothingRadS = 0.01;
    if (known.viscous_nm_s_rad != 0) add(EffectKind::kViscousFriction, {known.viscous_nm_s_rad});
    if (known.coulomb_nm != 0) {
      add(EffectKind::kCoulombFriction, {known.coulomb_nm, kSmoothingRadS});
    }
    if (known.rotor_inertia_kg_m2 != 0) {
      add(EffectKind::kRotorInertia, {known.rotor_inertia_kg_m2});
    }
  }
  return robot;
}

}  // namespace offnominal::test
