#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <offnominal/control/computed_torque.hpp>
#include <offnominal/model/forward_dynamics.hpp>
#include <offnominal/model/inverse_dynamics.hpp>
#include <offnominal/monitor.hpp>
#include <random>
#include <set>
#include <string>
#include <type_traits>
#include <vector>

#include "models/by_joint.hpp"
#include "models/emps.hpp"
#include "models/every_effect.hpp"
#include "models/two_link.hpp"
#include "robot/monitor_config_of.hpp"
#include "robot/robot_file.hpp"
#include "support/places.hpp"
#include "support/seed.hpp"

// What a controller computes with a generated header, against what the tools compute with the robot
// file: to the bit.

namespace offnominal::desk {
namespace {

// The generated constants of one robot, and its file.
template <typename S>
struct GeneratedTwoLink {
  using Scalar = S;
  using Memory = models::two_link::Memory;
  using Space = models::two_link::Space;
  static constexpr int kJoints = models::two_link::kJoints;
  static constexpr int kHiddenUnits = models::two_link::kHiddenUnits;
  static constexpr const auto& kConfig = models::two_link::kMonitorConfig<S>;
  static constexpr const auto& kGains = models::two_link::kComputedTorqueGains<S>;
  static constexpr const auto& kArming = models::two_link::kArmingConfig<S>;
  static constexpr const auto& kEncoders = models::two_link::kEncoderCountsPerUnit<S>;
  static constexpr const auto& kNames = models::two_link::kJointNames;
  inline static const std::string kFile = (test::source_dir() / "robots/two_link.toml").string();
};
template <typename S>
struct GeneratedEmps {
  using Scalar = S;
  using Memory = models::emps::Memory;
  using Space = models::emps::Space;
  static constexpr int kJoints = models::emps::kJoints;
  static constexpr int kHiddenUnits = models::emps::kHiddenUnits;
  static constexpr const auto& kConfig = models::emps::kMonitorConfig<S>;
  static constexpr const auto& kGains = models::emps::kComputedTorqueGains<S>;
  static constexpr const auto& kArming = models::emps::kArmingConfig<S>;
  static constexpr const auto& kEncoders = models::emps::kEncoderCountsPerUnit<S>;
  static constexpr const auto& kNames = models::emps::kJointNames;
  inline static const std::string kFile = (test::source_dir() / "robots/emps.toml").string();
};
template <typename S>
struct GeneratedEveryEffect {
  using Scalar = S;
  using Memory = models::every_effect::Memory;
  using Space = models::every_effect::Space;
  static constexpr int kJoints = models::every_effect::kJoints;
  static constexpr int kHiddenUnits = models::every_effect::kHiddenUnits;
  static constexpr const auto& kConfig = models::every_effect::kMonitorConfig<S>;
  static constexpr const auto& kGains = models::every_effect::kComputedTorqueGains<S>;
  static constexpr const auto& kArming = models::every_effect::kArmingConfig<S>;
  static constexpr const auto& kEncoders = models::every_effect::kEncoderCountsPerUnit<S>;
  static constexpr const auto& kNames = models::every_effect::kJointNames;
  inline static const std::string kFile =
      (test::source_dir() / "tests/desk/codegen/every_effect.toml").string();
};
template <typename S>
struct GeneratedByJoint {
  using Scalar = S;
  using Memory = models::by_joint::Memory;
  using Space = models::by_joint::Space;
  static constexpr int kJoints = models::by_joint::kJoints;
  static constexpr int kHiddenUnits = models::by_joint::kHiddenUnits;
  static constexpr const auto& kConfig = models::by_joint::kMonitorConfig<S>;
  static constexpr const auto& kGains = models::by_joint::kComputedTorqueGains<S>;
  static constexpr const auto& kArming = models::by_joint::kArmingConfig<S>;
  static constexpr const auto& kEncoders = models::by_joint::kEncoderCountsPerUnit<S>;
  static constexpr const auto& kNames = models::by_joint::kJointNames;
  inline static const std::string kFile =
      (test::source_dir() / "tests/desk/codegen/by_joint.toml").string();
};

// Not only equal: the same bits, so that 0 and -0 differ and NaN equals itself.
template <typename Scalar>
auto bits(Scalar value) {
  using Bits = std::conditional_t<sizeof(Scalar) == 4, std::uint32_t, std::uint64_t>;
  return std::bit_cast<Bits>(value);
}
template <typename A, typename B>
void expect_same_bits(const A& a, const B& b, const std::string& what) {
  ASSERT_EQ(static_cast<std::size_t>(a.size()), static_cast<std::size_t>(b.size())) << what;
  for (std::size_t i = 0; i < static_cast<std::size_t>(a.size()); ++i) {
    const auto index = static_cast<std::ptrdiff_t>(i);
    EXPECT_EQ(bits(a.data()[index]), bits(b.data()[index]))
        << what << "[" << i << "]: " << a.data()[index] << " and " << b.data()[index];
  }
}

template <typename Scalar>
std::vector<Scalar> numbers_in(const Joint<Scalar>& joint) {
  std::vector<Scalar> all{static_cast<Scalar>(joint.type),
                          joint.mass_kg,
                          joint.min_position,
                          joint.max_position,
                          joint.max_velocity,
                          joint.max_torque};
  const auto append = [&all](const auto& list) { all.insert(all.end(), list.begin(), list.end()); };
  append(joint.axis);
  append(joint.origin_m);
  append(joint.rotation);
  append(joint.centre_of_mass_m);
  append(joint.inertia_kg_m2);
  return all;
}

template <typename Scalar>
std::vector<Scalar> numbers_in(const EstimatorConfig<Scalar>& config) {
  return {config.period_s,
          config.alpha,
          config.learning_rate,
          config.weight_radius,
          static_cast<Scalar>(config.dead_zone),
          static_cast<Scalar>(config.hidden_units),
          config.initial_weight_range};
}

template <int N, typename Scalar>
std::vector<Scalar> numbers_in(const UncertaintyBound<N, Scalar>& bound) {
  std::vector<Scalar> all{static_cast<Scalar>(bound.kind),
                          bound.velocity_error,
                          bound.offset,
                          bound.scale,
                          static_cast<Scalar>(bound.variable),
                          static_cast<Scalar>(bound.joint),
                          static_cast<Scalar>(bound.points)};
  all.insert(all.end(), bound.matrix.begin(), bound.matrix.end());
  all.insert(all.end(), bound.at.begin(), bound.at.end());
  all.insert(all.end(), bound.value.begin(), bound.value.end());
  return all;
}

template <int N, typename Scalar>
std::vector<Scalar> numbers_in(const TorqueBound<N, Scalar>& bound) {
  std::vector<Scalar> all{bound.fast.alpha};
  for (const auto* bounds : {&bound.joints, &bound.fast.joints}) {
    for (const JointBound<Scalar>& joint : *bounds) {
      all.push_back(static_cast<Scalar>(joint.variable));
      all.push_back(static_cast<Scalar>(joint.points));
      all.push_back(joint.momentum_error);
      all.push_back(joint.act_ratio);
      all.insert(all.end(), joint.at.begin(), joint.at.end());
      all.insert(all.end(), joint.value.begin(), joint.value.end());
    }
  }
  return all;
}

template <int N, typename Scalar, typename Space>
JointSample<N, Scalar> random_sample(std::mt19937_64& generator,
                                     const MonitorConfig<N, Scalar, Space>& config) {
  std::uniform_real_distribution<Scalar> unit(-1, 1);
  JointSample<N, Scalar> sample;
  for (Eigen::Index i = 0; i < N; ++i) {
    const Joint<Scalar>& joint = config.chain.joints[static_cast<std::size_t>(i)];
    const auto within = [&](Scalar limit, Scalar most) {
      return unit(generator) * std::min(limit, most);
    };
    sample.q[i] = within(std::min(joint.max_position, -joint.min_position), Scalar(1));
    sample.dq[i] = within(joint.max_velocity, Scalar(2));
    sample.tau[i] = within(joint.max_torque, Scalar(40));
  }
  return sample;
}

template <typename Generated>
class GeneratedModel : public testing::Test {
 protected:
  RobotDescription robot_ = read_robot_file(Generated::kFile);
  MonitorConfig<Generated::kJoints, typename Generated::Scalar, typename Generated::Space> host_ =
      monitor_config_of<Generated::kJoints, typename Generated::Scalar, typename Generated::Space>(
          robot_);
  std::mt19937_64 generator_ = test::seeded_generator();
};

using AllGenerated =
    testing::Types<GeneratedTwoLink<float>, GeneratedTwoLink<double>, GeneratedEmps<float>,
                   GeneratedEmps<double>, GeneratedEveryEffect<float>, GeneratedEveryEffect<double>,
                   GeneratedByJoint<float>, GeneratedByJoint<double>>;
TYPED_TEST_SUITE(GeneratedModel, AllGenerated);

TYPED_TEST(GeneratedModel, HoldsTheHostsConfigurationToTheBit) {
  const auto& generated = TypeParam::kConfig;
  const auto& host = this->host_;
  for (std::size_t i = 0; i < host.chain.joints.size(); ++i) {
    expect_same_bits(numbers_in(generated.chain.joints[i]), numbers_in(host.chain.joints[i]),
                     "joint");
    EXPECT_EQ(TypeParam::kNames[i], this->robot_.joints[i].name);
    EXPECT_EQ(TypeParam::kEncoders[i], static_cast<typename TypeParam::Scalar>(
                                           this->robot_.joints[i].encoder.counts_per_unit));
  }
  expect_same_bits(generated.chain.gravity_m_s2, host.chain.gravity_m_s2, "gravity");
  expect_same_bits(generated.chain.transmission.motor_per_joint,
                   host.chain.transmission.motor_per_joint, "transmission");
  expect_same_bits(generated.chain.transmission.motor_offset_rad,
                   host.chain.transmission.motor_offset_rad, "motor offset");
  expect_same_bits(numbers_in(generated.estimator), numbers_in(host.estimator), "estimator");
  EXPECT_EQ(generated.estimator.seed, host.estimator.seed);
  expect_same_bits(numbers_in(generated.bound), numbers_in(host.bound), "bound");
  EXPECT_EQ(generated.torque_signal, host.torque_signal);
  expect_same_bits(generated.max_compensation, host.max_compensation, "max_compensation");
  const auto gains = gains_of<TypeParam::kJoints, typename TypeParam::Scalar>(this->robot_);
  expect_same_bits(TypeParam::kGains.kp, gains.kp, "kp");
  expect_same_bits(TypeParam::kGains.kd, gains.kd, "kd");
  const auto arming = arming_of<TypeParam::kJoints, typename TypeParam::Scalar>(this->robot_);
  expect_same_bits(TypeParam::kArming.position_window, arming.position_window, "window");
  expect_same_bits(TypeParam::kArming.speed, arming.speed, "speed");
  expect_same_bits(TypeParam::kArming.torque_rate, arming.torque_rate, "torque rate");
  EXPECT_EQ(TypeParam::kArming.ramp_s, arming.ramp_s);
}

TYPED_TEST(GeneratedModel, GivesTheHostsTorqueForEveryEffect) {
  constexpr int kN = TypeParam::kJoints;
  using Scalar = typename TypeParam::Scalar;
  const auto& generated = TypeParam::kConfig.chain;
  const auto& host = this->host_.chain;
  ASSERT_EQ(generated.effects.size, host.effects.size);
  ASSERT_EQ(static_cast<std::size_t>(host.effects.size), this->robot_.effects.size());
  const auto only = [](Chain<kN, Scalar> chain, std::size_t effect) {
    const Effect<Scalar> kept = chain.effects.items[effect];
    chain.effects = {};
    EXPECT_TRUE(chain.effects.add(kept));
    return make_model(chain);
  };
  for (std::size_t i = 0; i < host.effects.size; ++i) {
    SCOPED_TRACE(info_of(host.effects.items[i].kind)->name);
    EXPECT_EQ(generated.effects.items[i].kind, host.effects.items[i].kind);
    EXPECT_EQ(generated.effects.items[i].of_motor, host.effects.items[i].of_motor);
    const auto with_generated = only(generated, i);
    const auto with_host = only(host, i);
    for (int sample = 0; sample < 20; ++sample) {
      const auto at = random_sample(this->generator_, this->host_);
      const Vector<kN, Scalar> ddq = Scalar(3) * at.dq;
      const double time_s = 0.1 * sample;
      expect_same_bits(inverse_dynamics(with_generated, at.q, at.dq, ddq, time_s),
                       inverse_dynamics(with_host, at.q, at.dq, ddq, time_s), "torque");
    }
  }
}

TYPED_TEST(GeneratedModel, GivesTheHostsDynamics) {
  constexpr int kN = TypeParam::kJoints;
  using Scalar = typename TypeParam::Scalar;
  const auto generated = make_model(TypeParam::kConfig.chain);
  const auto host = make_model(this->host_.chain);
  for (int i = 0; i < 200; ++i) {
    const auto at = random_sample(this->generator_, this->host_);
    const double time_s = 0.01 * static_cast<double>(i);
    ForwardDynamics<kN, Scalar> a;
    ForwardDynamics<kN, Scalar> b;
    ASSERT_EQ(forward_dynamics(generated, at.q, at.dq, at.tau, time_s, a), Status::kOk);
    ASSERT_EQ(forward_dynamics(host, at.q, at.dq, at.tau, time_s, b), Status::kOk);
    expect_same_bits(a.ddq, b.ddq, "ddq");
    expect_same_bits(a.inertia, b.inertia, "M");
  }
}

TYPED_TEST(GeneratedModel, TakesTheHostsSteps) {
  constexpr int kN = TypeParam::kJoints;
  using Scalar = typename TypeParam::Scalar;
  using Watch = Monitor<kN, TypeParam::kHiddenUnits, Scalar, typename TypeParam::Memory,
                        typename TypeParam::Space>;
  Watch generated;
  Watch host;
  ASSERT_EQ(Watch::create(TypeParam::kConfig, generated), Status::kOk);
  ASSERT_EQ(Watch::create(this->host_, host), Status::kOk);
  typename Watch::State a;
  typename Watch::State b;
  typename Watch::Output out_a;
  typename Watch::Output out_b;
  const auto first = random_sample(this->generator_, this->host_);
  ASSERT_EQ(generated.reset(first, a), Status::kOk);
  ASSERT_EQ(host.reset(first, b), Status::kOk);
  // Samples without a physical connection: the estimator learns all the time.
  for (int tick = 0; tick < 500; ++tick) {
    const auto sample = random_sample(this->generator_, this->host_);
    ASSERT_EQ(generated.step(sample, a, out_a), Status::kOk);
    ASSERT_EQ(host.step(sample, b, out_b), Status::kOk);
    expect_same_bits(out_a.error, out_b.error, "e");
    expect_same_bits(out_a.psi_hat, out_b.psi_hat, "psi_hat");
    expect_same_bits(out_a.compensation.torque, out_b.compensation.torque, "compensation");
    ASSERT_EQ(bits(out_a.threshold), bits(out_b.threshold));
    ASSERT_FALSE(this->HasFailure()) << "tick " << tick;
  }
  expect_same_bits(a.estimator.weights.w1, b.estimator.weights.w1, "W1");
  EXPECT_GT(out_a.psi_hat.norm(), 0);
}

// The robot of this test is worth its name.
TEST(GeneratedModelOfEveryEffect, HasEveryEffect) {
  std::set<EffectKind> found;
  for (const auto& effect : models::every_effect::kChain<float>.effects.view()) {
    found.insert(effect.kind);
  }
  for (const EffectInfo& info : kAllEffectInfos)
    EXPECT_TRUE(found.contains(info.kind)) << info.name;
}

}  // namespace
}  // namespace offnominal::desk
