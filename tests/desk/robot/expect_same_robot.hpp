#pragma once

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "robot/robot.hpp"

namespace offnominal::test {

/// Equal to the bit: 0 and -0 differ.
inline void expect_same(double a, double b) {
  EXPECT_EQ(std::bit_cast<std::uint64_t>(a), std::bit_cast<std::uint64_t>(b)) << a << " and " << b;
}

void expect_same(const desk::RobotJoint& a, const desk::RobotJoint& b);
void expect_same(const desk::RobotEffect& a, const desk::RobotEffect& b);
void expect_same(const desk::Channel& a, const desk::Channel& b);

template <typename List>
requires requires(const List& list) { list.size(); }
void expect_same(const List& a, const List& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) expect_same(a[i], b[i]);
}

inline void expect_same(const desk::RobotJoint& a, const desk::RobotJoint& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.source, b.source);
  EXPECT_EQ(a.joint.type, b.joint.type);
  expect_same(a.joint.axis, b.joint.axis);
  expect_same(a.joint.origin_m, b.joint.origin_m);
  expect_same(a.joint.rotation, b.joint.rotation);
  expect_same(a.joint.mass_kg, b.joint.mass_kg);
  expect_same(a.joint.centre_of_mass_m, b.joint.centre_of_mass_m);
  expect_same(a.joint.inertia_kg_m2, b.joint.inertia_kg_m2);
  expect_same(a.joint.min_position, b.joint.min_position);
  expect_same(a.joint.max_position, b.joint.max_position);
  expect_same(a.joint.max_velocity, b.joint.max_velocity);
  expect_same(a.joint.max_torque, b.joint.max_torque);
  expect_same(a.encoder.counts_per_unit, b.encoder.counts_per_unit);
  expect_same(a.kp, b.kp);
  expect_same(a.kd, b.kd);
}

inline void expect_same(const desk::RobotEffect& a, const desk::RobotEffect& b) {
  EXPECT_EQ(a.kind, b.kind);
  EXPECT_EQ(a.joint, b.joint);
  EXPECT_EQ(a.of_motor, b.of_motor);
  expect_same(a.parameters, b.parameters);
  EXPECT_EQ(a.fitted, b.fitted);
  EXPECT_EQ(a.source, b.source);
}

inline void expect_same(const desk::EstimatorSettings& a, const desk::EstimatorSettings& b) {
  expect_same(a.period_s, b.period_s);
  expect_same(a.alpha, b.alpha);
  expect_same(a.fast_alpha, b.fast_alpha);
  EXPECT_EQ(a.hidden_units, b.hidden_units);
  expect_same(a.learning_rate, b.learning_rate);
  expect_same(a.weight_radius, b.weight_radius);
  expect_same(a.initial_weight_range, b.initial_weight_range);
  EXPECT_EQ(a.seed, b.seed);
  EXPECT_EQ(a.dead_zone, b.dead_zone);
  EXPECT_EQ(a.torque_signal, b.torque_signal);
  EXPECT_EQ(a.space, b.space);
  EXPECT_EQ(a.source, b.source);
}

inline void expect_same(const desk::ArmingSettings& a, const desk::ArmingSettings& b) {
  expect_same(a.position_window, b.position_window);
  expect_same(a.speed, b.speed);
  expect_same(a.torque_rate, b.torque_rate);
  expect_same(a.ramp_s, b.ramp_s);
  EXPECT_EQ(a.source, b.source);
}

inline void expect_same(const std::vector<desk::JointBoundSettings>& a,
                        const std::vector<desk::JointBoundSettings>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (!a[i].at.empty()) {
      EXPECT_EQ(a[i].variable, b[i].variable);
    }
    expect_same(a[i].at, b[i].at);
    expect_same(a[i].value, b[i].value);
    expect_same(a[i].momentum_error, b[i].momentum_error);
    expect_same(a[i].act_ratio, b[i].act_ratio);
  }
}

inline void expect_same(const desk::BoundSettings& a, const desk::BoundSettings& b) {
  ASSERT_EQ(a.kind, b.kind);
  EXPECT_EQ(a.source, b.source);
  expect_same(a.velocity_error, b.velocity_error);
  expect_same(a.constant.value, b.constant.value);
  expect_same(a.scaled_norm.scale, b.scaled_norm.scale);
  expect_same(a.scaled_norm.offset, b.scaled_norm.offset);
  expect_same(a.scaled_norm.matrix, b.scaled_norm.matrix);
  EXPECT_EQ(a.table.variable, b.table.variable);
  EXPECT_EQ(a.table.joint, b.table.joint);
  expect_same(a.table.at, b.table.at);
  expect_same(a.table.value, b.table.value);
  expect_same(a.joints, b.joints);
  expect_same(a.fast, b.fast);
}

inline void expect_same(const desk::DriveSettings& a, const desk::DriveSettings& b) {
  EXPECT_EQ(a.protocol, b.protocol);
  expect_same(a.shared, b.shared);
  expect_same(a.of_joints, b.of_joints);
  EXPECT_EQ(a.source, b.source);
}

inline void expect_same(const desk::TransmissionSettings& a, const desk::TransmissionSettings& b) {
  expect_same(a.ratio, b.ratio);
  expect_same(a.matrix, b.matrix);
  expect_same(a.offset_rad, b.offset_rad);
  expect_same(a.torque_constant, b.torque_constant);
  EXPECT_EQ(a.source, b.source);
}

inline void expect_same(const std::vector<std::optional<desk::Channel>>& a,
                        const std::vector<std::optional<desk::Channel>>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_EQ(a[i].has_value(), b[i].has_value());
    if (a[i]) expect_same(*a[i], *b[i]);
  }
}

inline void expect_same(const desk::Channel& a, const desk::Channel& b) {
  EXPECT_EQ(a.source, b.source);
  EXPECT_EQ(a.scale, b.scale);
  EXPECT_EQ(a.offset, b.offset);
  EXPECT_EQ(a.scale_source, b.scale_source);
  EXPECT_EQ(a.unit, b.unit);
  expect_same(a.sum, b.sum);
}

inline void expect_same(const desk::ChannelMap& a, const desk::ChannelMap& b) {
  EXPECT_EQ(a.at_rest, b.at_rest);
  EXPECT_EQ(a.dbc, b.dbc);
  expect_same(a.time, b.time);
  expect_same(a.more_times, b.more_times);
  expect_same(a.period_s, b.period_s);
  expect_same(a.position, b.position);
  expect_same(a.velocity, b.velocity);
  EXPECT_EQ(a.position_of, b.position_of);
  EXPECT_EQ(a.velocity_of, b.velocity_of);
  EXPECT_EQ(a.torque_of, b.torque_of);
  expect_same(a.sensor_torque, b.sensor_torque);
  expect_same(a.torque, b.torque);
  ASSERT_EQ(a.payloads.size(), b.payloads.size());
  for (std::size_t i = 0; i < a.payloads.size(); ++i) {
    EXPECT_EQ(a.payloads[i].recording, b.payloads[i].recording);
    EXPECT_EQ(a.payloads[i].payload.mass_kg, b.payloads[i].payload.mass_kg);
    EXPECT_EQ(a.payloads[i].payload.place_m, b.payloads[i].payload.place_m);
  }
  ASSERT_EQ(a.extra.size(), b.extra.size());
  for (const auto& [name, channel] : a.extra) {
    ASSERT_TRUE(b.extra.contains(name)) << name;
    expect_same(channel, b.extra.at(name));
  }
}

inline void expect_same(const desk::RobotDescription& a, const desk::RobotDescription& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.source, b.source);
  expect_same(a.gravity_m_s2, b.gravity_m_s2);
  expect_same(a.joints, b.joints);
  expect_same(a.effects, b.effects);
  expect_same(a.estimator, b.estimator);
  expect_same(a.arming, b.arming);
  ASSERT_EQ(a.bound.has_value(), b.bound.has_value());
  if (a.bound) expect_same(*a.bound, *b.bound);
  ASSERT_EQ(a.transmission.has_value(), b.transmission.has_value());
  if (a.transmission) expect_same(*a.transmission, *b.transmission);
  ASSERT_EQ(a.drives.has_value(), b.drives.has_value());
  if (a.drives) expect_same(*a.drives, *b.drives);
  ASSERT_EQ(a.channels.has_value(), b.channels.has_value());
  if (a.channels) expect_same(*a.channels, *b.channels);
}

}  // namespace offnominal::test
