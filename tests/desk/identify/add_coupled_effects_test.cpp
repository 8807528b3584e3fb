#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "added_value.hpp"
#include "common/error.hpp"
#include "desk/compare/recorded_arm.hpp"
#include "identify/add.hpp"

// Effects that depend on more than their own joint's motion: on the run's age, on another joint, on
// the load, on the whole torque. The recordings are the simulator's closed form and the effect's
// definition.

namespace {

using Eigen::Vector2d;
using offnominal::EffectKind;
using offnominal::test::arm_description;
using offnominal::test::ArmInstant;
using offnominal::test::ArmRecording;
using offnominal::test::effect_of;
using offnominal::test::HiddenTorque;
using offnominal::test::record_arm;
using offnominal::test::value_of;
using namespace offnominal::desk;
using namespace offnominal::desk;
using ::testing::HasSubstr;
namespace sim = offnominal::sim;

const ArmRecording kNoisy{.torque_noise = 0.1, .encoder_step = 2 * std::numbers::pi / (1 << 19)};

Vector2d rigid_torque(const ArmInstant& at, const sim::TwoLinkParameters& arm = {}) {
  return sim::mass_matrix(arm, at.q) * at.ddq + sim::velocity_torque(arm, {at.q, at.dq}) +
         sim::gravity_torque(arm, at.q);
}

AddResult add_to(const RobotDescription& robot, EffectKind kind, std::size_t joint,
                 const HiddenTorque& hidden, const ArmRecording& settings = kNoisy,
                 std::optional<double> inertia_deviation = {}) {
  AddRequest request;
  request.effects = {kind};
  request.joint = joint;
  request.inertia_deviation = inertia_deviation;
  return add(robot, request, {record_arm(settings, hidden)}, {});
}

double held_out_fall(const AddResult& result, std::size_t joint) {
  for (const BeforeAfter& one : result.held_out) {
    if (one.joint == joint) return one.after_rms / one.before_rms;
  }
  ADD_FAILURE() << "joint " << joint;
  return std::nan("");
}

TEST(AddDrift, GivenFrictionThatFadesThenItsSizeAndTimeConstantAreFound) {
  const AddResult result =
      add_to(arm_description(), EffectKind::kTemperatureDrift, 1, [](const ArmInstant& at) {
        const double fade = std::exp(-at.t_s / 6);
        return Vector2d(0, fade * (1.5 * std::tanh(at.dq[1] / 0.03) + 0.6 * at.dq[1]));
      });
  EXPECT_TRUE(result.objections.empty());
  EXPECT_NEAR(value_of(result, EffectKind::kTemperatureDrift, "level"), 1.5, 0.05);
  EXPECT_NEAR(value_of(result, EffectKind::kTemperatureDrift, "coefficient"), 0.6, 0.03);
  EXPECT_NEAR(value_of(result, EffectKind::kTemperatureDrift, "time_constant"), 6, 0.2);
  EXPECT_LT(held_out_fall(result, 1), 0.15);
}

// A recording's clock may start anywhere, its run starts at its first sample.
TEST(AddDrift, TimeCountsFromTheFirstSample) {
  Log log = record_arm(kNoisy, [](const ArmInstant& at) {
    return Vector2d(0, 2 * std::exp(-at.t_s / 5) * at.dq[1]);
  });
  log.t_s.array() += 1000;
  AddRequest request;
  request.effects = {EffectKind::kTemperatureDrift};
  request.joint = 1;
  request.set = {{"level", 0}, {"smoothing", 0.01}};
  const AddResult result = add(arm_description(), request, {log}, {});
  EXPECT_NEAR(value_of(result, EffectKind::kTemperatureDrift, "coefficient"), 2, 0.05);
  EXPECT_NEAR(value_of(result, EffectKind::kTemperatureDrift, "time_constant"), 5, 0.2);
}

TEST(AddCoupling, GivenTwoJointsThenTheOtherOneIsTheSource) {
  const AddResult result =
      add_to(arm_description(), EffectKind::kJointCoupling, 1, [](const ArmInstant& at) {
        return Vector2d(0, 0.8 * at.dq[0] - 0.5 * std::tanh(at.dq[0] / 0.05));
      });
  EXPECT_TRUE(result.objections.empty());
  EXPECT_EQ(value_of(result, EffectKind::kJointCoupling, "source_joint"), 1);
  EXPECT_NEAR(value_of(result, EffectKind::kJointCoupling, "coefficient"), 0.8, 0.02);
  EXPECT_NEAR(value_of(result, EffectKind::kJointCoupling, "level"), -0.5, 0.03);
  EXPECT_NEAR(value_of(result, EffectKind::kJointCoupling, "smoothing"), 0.05, 0.01);
  EXPECT_LT(held_out_fall(result, 1), 0.25);
}

// Three slides at right angles: each moves what is behind it, and nothing else couples them.
struct Slides {
  RobotDescription robot;
  Log log;
};

Slides slides_with_coupling(int joint, int source, double coefficient) {
  Slides slides;
  slides.robot.name = "slides";
  slides.robot.gravity_m_s2 = {0, 0, 0};
  const std::array<double, 3> behind{6, 3, 1};
  for (std::size_t i = 0; i < 3; ++i) {
    RobotJoint one;
    one.name = std::string(1, static_cast<char>('x' + i));
    one.joint.type = offnominal::JointType::kPrismatic;
    one.joint.axis = {i == 0 ? 1.0 : 0.0, i == 1 ? 1.0 : 0.0, i == 2 ? 1.0 : 0.0};
    one.joint.mass_kg = i == 2 ? behind[2] : behind[i] - behind[i + 1];
    slides.robot.joints.push_back(one);
  }
  constexpr Eigen::Index kSamples = 10000;
  Log& log = slides.log;
  log.file = "slides";
  log.period_s = 0.002;
  log.t_s = Eigen::VectorXd::LinSpaced(kSamples, 0, 0.002 * (kSamples - 1));
  log.dq_derived = {false, false, false};
  log.q.resize(kSamples, 3);
  log.dq.resize(kSamples, 3);
  log.tau.resize(kSamples, 3);
  std::mt19937_64 generator(3);
  std::normal_distribution<double> noise(0, 0.02);
  for (Eigen::Index i = 0; i < kSamples; ++i) {
    for (Eigen::Index k = 0; k < 3; ++k) {
      const double slow = 1.1 + 0.37 * static_cast<double>(k);
      const double fast = 4.3 - 0.7 * static_cast<double>(k);
      const double t = log.t_s[i];
      log.q(i, k) = 0.5 * std::sin(slow * t) + 0.1 * std::sin(fast * t);
      log.dq(i, k) = 0.5 * slow * std::cos(slow * t) + 0.1 * fast * std::cos(fast * t);
      const double ddq =
          -0.5 * slow * slow * std::sin(slow * t) - 0.1 * fast * fast * std::sin(fast * t);
      log.tau(i, k) = behind[static_cast<std::size_t>(k)] * ddq + noise(generator);
    }
    log.tau(i, joint) += coefficient * log.dq(i, source);
  }
  return slides;
}

TEST(AddCoupling, GivenThreeJointsThenTheSourceIsSearchedFor) {
  for (const auto& [joint, source] : {std::pair{0, 2}, {1, 0}, {2, 1}}) {
    const Slides slides = slides_with_coupling(joint, source, 1.2);
    AddRequest request;
    request.effects = {EffectKind::kJointCoupling};
    request.joint = static_cast<std::size_t>(joint);
    request.set = {{"level", 0}, {"smoothing", 0.01}};
    const AddResult result = add(slides.robot, request, {slides.log}, {});
    EXPECT_EQ(value_of(result, EffectKind::kJointCoupling, "source_joint"), source + 1);
    EXPECT_NEAR(value_of(result, EffectKind::kJointCoupling, "coefficient"), 1.2, 0.01);
  }
}

TEST(AddLoadFriction, GivenFrictionByTheLoadThenItsFactorIsFound) {
  const AddResult result =
      add_to(arm_description(), EffectKind::kLoadDependentFriction, 1, [](const ArmInstant& at) {
        return Vector2d(0, 0.1 * std::abs(rigid_torque(at)[1]) * std::tanh(at.dq[1] / 0.03));
      });
  EXPECT_TRUE(result.objections.empty());
  EXPECT_NEAR(value_of(result, EffectKind::kLoadDependentFriction, "factor"), 0.1, 0.002);
  EXPECT_NEAR(value_of(result, EffectKind::kLoadDependentFriction, "smoothing"), 0.03, 0.005);
  EXPECT_LT(held_out_fall(result, 1), 0.15);
}

TEST(AddTorqueScale, GivenAWrongTorqueConstantThenItsErrorIsFound) {
  for (const double error : {0.25, -0.2}) {
    const AddResult result =
        add_to(arm_description(), EffectKind::kTorqueScale, 0,
               [error](const ArmInstant& at) { return Vector2d(error * rigid_torque(at)[0], 0); });
    EXPECT_TRUE(result.objections.empty());
    EXPECT_NEAR(value_of(result, EffectKind::kTorqueScale, "error"), error, 0.002);
    EXPECT_LT(held_out_fall(result, 0), 0.1);
  }
}

// What the drive is told is a product of the two: the fit has to be about where it ends.
TEST(AddTorqueScale, GivenFrictionThatIsFittedAgainThenBothAreFound) {
  RobotDescription robot = arm_description();
  robot.effects = {effect_of(EffectKind::kViscousFriction, 1, {0.3}, true),
                   effect_of(EffectKind::kCoulombFriction, 1, {3.0, 0.02}, true)};
  const AddResult result = add_to(robot, EffectKind::kTorqueScale, 1, [](const ArmInstant& at) {
    const double load = rigid_torque(at)[1];
    const double told = 1.3 * (load + 0.8 * at.dq[1] + 1.5 * std::tanh(at.dq[1] / 0.02));
    return Vector2d(0, told - load);
  });
  EXPECT_TRUE(result.objections.empty());
  EXPECT_NEAR(value_of(result, EffectKind::kTorqueScale, "error"), 0.3, 0.003);
  EXPECT_NEAR(value_of(result, EffectKind::kViscousFriction, "coefficient"), 0.8, 0.02);
  EXPECT_NEAR(value_of(result, EffectKind::kCoulombFriction, "level"), 1.5, 0.03);
}

#ifndef OFFNOMINAL_SANITIZE  // the search of GivenFrictionByTheLoad again, minutes long there
TEST(AddLoadFriction, GivenFrictionThatGivesEnergyThenItObjects) {
  const AddResult result =
      add_to(arm_description(), EffectKind::kLoadDependentFriction, 1, [](const ArmInstant& at) {
        return Vector2d(0, -0.1 * std::abs(rigid_torque(at)[1]) * std::tanh(at.dq[1] / 0.03));
      });
  ASSERT_FALSE(result.objections.empty());
  EXPECT_THAT(result.objections[0],
              HasSubstr("load_dependent_friction.factor of joint 2 came out as -0.1"));
}

TEST(AddLoadFriction, GivenTheWrongMassThenRefittingInertiaFindsBoth) {
  ArmRecording heavy = kNoisy;
  heavy.arm.mass2_kg = 2.1;
  const AddResult result = add_to(
      arm_description(), EffectKind::kLoadDependentFriction, 0,
      [&](const ArmInstant& at) {
        const double load = rigid_torque(at, heavy.arm)[0];
        return Vector2d(0.12 * std::abs(load) * std::tanh(at.dq[0] / 0.03), 0);
      },
      heavy, 0.05);
  EXPECT_NEAR(result.robot.joints[1].joint.mass_kg, 2.1, 0.01);
  EXPECT_NEAR(value_of(result, EffectKind::kLoadDependentFriction, "factor"), 0.12, 0.003);
}
#endif

std::string refusal(const AddRequest& request, const RobotDescription& robot) {
  try {
    add(robot, request, {record_arm({.duration_s = 3})}, {});
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(AddCoupling, RefusesASourceThatIsNone) {
  AddRequest request;
  request.effects = {EffectKind::kJointCoupling};
  request.joint = 1;
  for (const double source : {2.0, 3.0, 1.5}) {
    request.set = {{"source_joint", source}};
    EXPECT_THAT(refusal(request, arm_description()), HasSubstr("a whole number from 1 to 2, not 2"))
        << source;
  }
  request.set = {{"source_joint", 1}};
  EXPECT_EQ(refusal(request, arm_description()), "accepted");
  RobotDescription one = arm_description();
  one.joints.pop_back();
  request.joint = 0;
  request.set = {};
  EXPECT_THAT(refusal(request, one), HasSubstr("joint_coupling follows another joint"));
}

TEST(AddLoadFriction, RefusesAFactorThatLocks) {
  AddRequest request;
  request.effects = {EffectKind::kLoadDependentFriction};
  request.set = {{"factor", 1.0}, {"smoothing", 0.01}};
  EXPECT_THAT(refusal(request, arm_description()), HasSubstr("0 or more, up to 0.95"));
}

}  // namespace
