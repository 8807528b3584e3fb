#include <gtest/gtest.h>

#include <cmath>
#include <offnominal/diagnosis/isolation_size.hpp>
#include <offnominal/diagnosis/isolation_verdict.hpp>
#include <offnominal/diagnosis/known_friction.hpp>

#include "core/contest_of.hpp"

// What a verdict is made of: no kind without evidence, no size that cannot be.

namespace offnominal::test {
namespace {

using SeenState = IsolationState<2, double>;
using TwoScales = IsolationScales<2, double>;

constexpr EncoderTimes<double> kTimes{100, 0, 0, 0, 1000, 1e4};

TwoScales scales_of(double holding) {
  TwoScales scales;
  scales.own.setOnes();
  scales.thresholds = {1, 1};
  scales.friction = {KnownFriction<double>{holding, holding, 0, 0.005},
                     KnownFriction<double>{holding, holding, 0, 0.005}};
  return scales;
}

// Blocks of the second joint, of noise 0.3, with what each regressor is; any torque explains them
// too.
SeenState seen(const Vector<kOwnRegressors, double>& own, double torque, int blocks = 40) {
  SeenState state;
  JointEvidence<double>& joint = state.joints[1];
  for (int block = 0; block < blocks; ++block) {
    Vector<kOwnRegressors, double> now = own;
    now[kSignRegressor] *= block % 2 == 0 ? 1 : -1;
    take(joint.own, now, torque * (own[kSignRegressor] != 0 && block % 2 != 0 ? -1 : 1), 1 / 0.09);
    joint.largest_own = joint.largest_own.cwiseMax(own.cwiseAbs());
  }
  joint.any.evidence = 0.45 * blocks * torque * torque / 0.09;
  joint.moved = state.blocks = state.moved = static_cast<std::uint32_t>(blocks);
  state.alarmed = {false, true};
  return state;
}
Vector<kOwnRegressors, double> only(OwnRegressor which, double value) {
  Vector<kOwnRegressors, double> own = Vector<kOwnRegressors, double>::Zero();
  own[which] = value;
  return own;
}

TEST(IsolationVerdict, NamesNoKindBeforeThereIsEvidence) {
  const Contest<double> contest = contest_of(SeenState{}, scales_of(1), kTimes);
  EXPECT_EQ(contest.kind, FaultKind::kUnknown);
  EXPECT_GT(contest.share(), 0.4);
}

TEST(IsolationVerdict, KnowsThatADriveLosesNoMoreThanItsTorque) {
  const auto share = [](double lost) {
    const SeenState state = seen(only(kTorqueRegressor, -4), -4 * lost);
    const Contest<double> contest = contest_of(state, scales_of(1), kTimes);
    return contest.kind == FaultKind::kLostTorque && contest.joint == 1 ? contest.share() : 0;
  };
  EXPECT_GT(share(0.4), 0.99);
  EXPECT_GT(share(1.0), 0.99);
  EXPECT_LT(share(3.0), 0.01);
}

TEST(IsolationVerdict, KnowsThatAJointLosesNoMoreThanItsFriction) {
  const auto kind = [](double size, double known) {
    const SeenState state = seen(only(kSignRegressor, 1), size);
    return contest_of(state, scales_of(known), kTimes).kind;
  };
  EXPECT_EQ(kind(2, 0.5), FaultKind::kFriction);
  EXPECT_EQ(kind(-2, 3), FaultKind::kFriction);
  EXPECT_NE(kind(-2, 0.5), FaultKind::kFriction);
}

// An error of the model that is seen for certain, and too small to have set off the alarm.
TEST(IsolationVerdict, DoesNotTakeForTheFaultWhatIsTooSmallForTheAlarm) {
  const auto kind = [](double size) {
    const SeenState state = seen(only(kSignRegressor, 1), size, 600);
    return contest_of(state, scales_of(1), kTimes).kind;
  };
  EXPECT_EQ(kind(0.5), FaultKind::kFriction);
  EXPECT_EQ(kind(0.02), FaultKind::kUnknown);
}

// One joint's alarm is not the doing of another that never had one, however far that is off.
TEST(IsolationVerdict, DoesNotBlameAJointThatWasNeverDetected) {
  SeenState state = seen(only(kSignRegressor, 1), 2);
  EXPECT_EQ(contest_of(state, scales_of(1), kTimes).kind, FaultKind::kFriction);
  state.alarmed = {true, false};
  EXPECT_EQ(contest_of(state, scales_of(1), kTimes).kind, FaultKind::kUnknown);
}

TEST(IsolationSize, OfAPayloadIsThatOfABody) {
  const auto is_body = [](double mass, double deviation) {
    return detail::is_body<2, double>({mass, deviation, 0}, 0.62);
  };
  EXPECT_TRUE(is_body(0.5, 0.1));
  EXPECT_TRUE(is_body(0.16, 0.05));
  EXPECT_FALSE(is_body(0.74, 0.36)) << "an encoder that sticks";
  EXPECT_FALSE(is_body(0.001, 0.002));
  EXPECT_TRUE(is_body(-0.5, 0.1));
  EXPECT_FALSE(is_body(-0.5, 0.2));
  EXPECT_FALSE(is_body(-0.99, 0.3)) << "more than the link has";
}

TEST(IsolationVerdict, WidensTheRangeOfASizeThatLeavesMoreThanNoise) {
  const auto fits = detail::measure_from<2, double>(2, 0.01, 90, 100, 20);
  const auto leaves = detail::measure_from<2, double>(2, 0.01, 90, 590, 20);
  EXPECT_NEAR(fits.deviation, std::sqrt(0.01 + 0.08 * 0.08), 1e-12);
  EXPECT_NEAR(leaves.deviation, std::sqrt(0.25 + 0.08 * 0.08), 1e-12);
}

// One that stands alone for longer than ever; several that do, or have done so before, are a
// program.
TEST(IsolationVerdict, WeighsAJointThatStandsByWhatIsKnownOfIt) {
  const auto evidence = [](Standing standing, std::uint32_t joints) {
    return detail::standing_evidence(standing, 60'000,
                                     EncoderTimes<double>{100, 0, 0, 0, 1000, 1e4, joints});
  };
  EXPECT_GT(evidence({400, 20}, 1), 3);
  EXPECT_LT(evidence({400, 300}, 1), 0);
  EXPECT_LT(evidence({400, 20}, 2), 0);
  EXPECT_GT(evidence({400, 20}, 1), evidence({150, 20}, 1)) << "the longer, the more";
}

// A moment of 1 kg m and some mass: nobody carries 0.1 kg ten metres away.
TEST(IsolationVerdict, TakesForAPayloadOnlyWhatAToolReaches) {
  const auto against = [](double mass, double deviation) {
    RegressionFit<kTipParameters, double> fit;
    fit.theta << mass, 0.6, 0, -0.8;
    fit.covariance *= deviation * deviation;
    const Vector<kTipParameters, double> ones = Vector<kTipParameters, double>::Ones();
    return detail::beyond_reach(fit, ones, 0.6);
  };
  EXPECT_EQ(against(2, 0.01), 0);
  EXPECT_EQ(against(-2, 0.01), 0) << "nor of one that is lost";
  EXPECT_LT(against(0.1, 0.01), -100);
  EXPECT_LT(against(-0.1, 0.01), -100);
  EXPECT_GT(against(0.1, 2), -1) << "its mass may as well be another";
}

// A wrist that turns about the axis of the joint before it, and one whose inertia that hardly
// feels.
TEST(IsolationVerdict, KnowsWhoseRunningAwayTheOthersWouldFeel) {
  TwoScales scales = scales_of(1);
  scales.alpha = 10;
  scales.speeds = {2, 2};
  Matrix<2, 2, double> inertia = Matrix<2, 2, double>::Identity();
  inertia(0, 1) = inertia(1, 0) = 0.02;
  EXPECT_FALSE((detail::runs_away_felt<2, double>(inertia, 1, scales)));
  inertia(0, 1) = inertia(1, 0) = -0.03;
  EXPECT_TRUE((detail::runs_away_felt<2, double>(inertia, 1, scales)));
  scales.thresholds = {2, 2};
  EXPECT_FALSE((detail::runs_away_felt<2, double>(inertia, 1, scales)));
}

// What stopped when the fault had long been seen is its effect, not its cause.
TEST(IsolationVerdict, BlamesNoEncoderThatStoppedAfterTheDetection) {
  EncoderWatch<double> watch;
  watch.steps = 1000;
  watch.known_for = 60'000;
  watch.stopped = watch.stopped_at_once = true;
  watch.still = watch.slow_for = 300;
  watch.exact = watch.slow = {300, 20};
  const auto evidence = [&](std::uint32_t least, std::uint32_t within) {
    return detail::stop_evidence(watch, EncoderTimes<double>{100, least, 0, 0, within, 1e4});
  };
  EXPECT_TRUE(evidence(250, 800).may_stick);
  EXPECT_TRUE(evidence(250, 800).may_lock);
  EXPECT_FALSE(evidence(350, 800).may_stick);
  EXPECT_FALSE(evidence(350, 800).may_lock);
}

TEST(KnownFriction, IsOfTheJointsWithTheirMotors) {
  Chain<2, double> chain;
  const auto add = [&](EffectKind kind, std::uint8_t joint, double first, double second,
                       bool of_motor) {
    Effect<double> effect{kind, joint, {first, second}};
    effect.of_motor = of_motor;
    EXPECT_TRUE(chain.effects.add(effect));
  };
  chain.transmission.motor_per_joint = {50, 0, 0, -20};
  add(EffectKind::kCoulombFriction, 0, 3, 0.02, false);
  add(EffectKind::kViscousFriction, 0, 2, 0, false);
  add(EffectKind::kStribeckFriction, 0, 0.5, 0.1, false);
  add(EffectKind::kCoulombFriction, 1, 0.1, 0.4, true);
  add(EffectKind::kViscousFriction, 1, 0.01, 0, true);
  const auto friction = known_friction<2, double>(chain, 0.005);
  EXPECT_DOUBLE_EQ(friction[0].dry, 3);
  EXPECT_DOUBLE_EQ(friction[0].holding, 3.5);
  EXPECT_DOUBLE_EQ(friction[0].viscous, 2);
  EXPECT_DOUBLE_EQ(friction[0].width, 0.02);
  EXPECT_DOUBLE_EQ(friction[1].dry, 2) << "0.1 N m at a motor that turns 20 times";
  EXPECT_DOUBLE_EQ(friction[1].viscous, 4);
  EXPECT_DOUBLE_EQ(friction[1].width, 0.02) << "0.4 rad/s of the motor";
  const auto bare = known_friction<2, double>({}, 0.005);
  EXPECT_DOUBLE_EQ(bare[1].width, 0.005);
}

}  // namespace
}  // namespace offnominal::test
