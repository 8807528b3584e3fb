#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <offnominal/diagnosis/isolation.hpp>
#include <random>
#include <string>

#include "core/contest_of.hpp"
#include "core/planted_fault.hpp"
#include "core/print_status.hpp"
#include "support/repetitions.hpp"
#include "support/seed.hpp"

// Which fault it is, of robots that get one exactly as its hypothesis says.

namespace offnominal::test {
namespace {

constexpr int kFaultUnits = 6;
constexpr int kRunTicks = 8000;

template <int N>
using WatchOf = Monitor<N, kFaultUnits, double, WithoutMemory, TorqueSpace>;

// `after_tick`: what is asked of each tick, with the states of the isolation and the monitor's
// output.
template <int N, typename AfterTick>
IsolationState<N, double> isolated(PlantedRobot<N>& robot, const AfterTick& after_tick) {
  using Watch = WatchOf<N>;
  Watch monitor;
  EXPECT_EQ(Watch::create(robot.config, monitor), Status::kOk);
  Isolation<N, double> isolation;
  EXPECT_EQ((Isolation<N, double>::create({}, robot.config, isolation)), Status::kOk);
  typename Watch::State state;
  typename Watch::Output output;
  IsolationState<N, double> isolating;
  isolation.reset(isolating);
  EXPECT_EQ(monitor.reset(robot.sample(0), state), Status::kOk);
  for (std::uint64_t tick = 1; tick <= kRunTicks; ++tick) {
    const JointSample<N, double> sample = robot.sample(tick);
    if (monitor.step(sample, state, output) != Status::kOk) {
      ADD_FAILURE() << "refused at tick " << tick;
      break;
    }
    isolation.step(monitor.model(), sample, state.tick, output, isolating);
    after_tick(isolating, output);
  }
  return isolating;
}
template <int N>
IsolationState<N, double> isolated(PlantedRobot<N>& robot) {
  return isolated(robot, [](const auto& /*state*/, const auto& /*output*/) {});
}

// A fault that its monitor sees late, as its torque is small at first, has been taken for the
// model's own error until then.
template <int N>
bool is_seen_soon(const IsolationState<N, double>& state) {
  constexpr double kSoonS = 0.3;
  return state.triggered &&
         static_cast<double>(state.detection_tick) * kPlantedPeriodS < kPlantedAtS + kSoonS;
}

struct Asked {
  FaultKind kind;
  double size;
  double size_within;      // share; 0: it has none
  double least_right = 1;  // share of the runs that are judged
};

// What is right of an answer that has the kind.
void check(const FaultDiagnosis<double>& said, const PlantedFault& fault, double size_within) {
  EXPECT_TRUE(said.decided);
  EXPECT_EQ(said.joint, fault.joint);
  EXPECT_GT(said.time_s, kPlantedAtS);
  EXPECT_LE(said.time_s, kPlantedAtS + 4.5);
  EXPECT_GE(said.onset_s, kPlantedAtS - 0.1);
  if (size_within <= 0) return;
  EXPECT_NEAR(said.size, fault.size, size_within * std::abs(fault.size));
  EXPECT_GT(said.deviation, 0);
}

// Plants it into robots. Two hypotheses can be one on a motion: a constant torque and the loss of a
// constant torque, say. Hence not every run has to be right, where that is said.
template <int N>
void expect_named(const Asked& asked) {
  std::mt19937_64 generator = seeded_generator();
  int judged = 0;
  int right = 0;
  for (int run = 0; run < 20; ++run) {
    const bool of_last = asked.kind == FaultKind::kPayload;
    const PlantedFault fault{asked.kind, of_last ? N - 1 : run % N, asked.size};
    PlantedRobot<N> robot(generator, fault);
    const IsolationState<N, double> state = isolated(robot);
    if (!is_seen_soon(state)) continue;
    ++judged;
    const FaultDiagnosis<double>& said = state.diagnosis;
    SCOPED_TRACE("run " + std::to_string(run) + ", joint " + std::to_string(fault.joint + 1));
    if (said.kind == asked.kind) {
      ++right;
      check(said, fault, asked.size_within);
    } else {
      std::cout << "run " << run << ", joint " << fault.joint + 1 << ": " << name_of(said.kind)
                << " of joint " << said.joint + 1 << ", confidence " << said.confidence << '\n';
    }
  }
  EXPECT_GE(judged, 8);
  EXPECT_GE(right, asked.least_right * judged);
}

TEST(Isolation, NamesFrictionItsJointAndItsSize) {
  expect_named<2>({FaultKind::kFriction, 3, 0.05, 0.85});
  expect_named<7>({FaultKind::kFriction, 3, 0.05, 0.85});
}
TEST(Isolation, NamesLostTorqueItsJointAndItsShare) {
  expect_named<2>({FaultKind::kLostTorque, 0.3, 0.05, 0.85});
  expect_named<7>({FaultKind::kLostTorque, 0.3, 0.05, 0.85});
}
TEST(Isolation, NamesAnOffsetItsJointAndItsSize) {
  expect_named<2>({FaultKind::kOffset, -3, 0.05, 0.75});
  expect_named<7>({FaultKind::kOffset, 3, 0.05, 0.75});
}
TEST(Isolation, NamesAPayloadAndItsMass) { expect_named<7>({FaultKind::kPayload, 2, 0.15, 0.85}); }
TEST(Isolation, NamesAnEncoderThatJumpsItsJointAndByHowMuch) {
  expect_named<2>({FaultKind::kEncoderJump, 0.3, 0.01});
  expect_named<7>({FaultKind::kEncoderJump, -0.3, 0.01});
}
// How far from what acts on the arm beside its model, rms over the last three seconds and all
// joints as a share of it, each the sum over robots whose fault was named right: the law's load,
// and psi_hat.
struct LeftOver {
  double acting = 0;
  double law = 0;
  double network = 0;
  int named = 0;
};
LeftOver left_over(const PlantedFault& planted, std::mt19937_64& generator) {
  constexpr double kFromS = 5;
  LeftOver sums;
  for (int run = 0; run < 8; ++run) {
    PlantedFault fault = planted;
    if (fault.kind != FaultKind::kPayload) fault.joint = run % 7;
    PlantedRobot<7> robot(generator, fault);
    LeftOver of_run;
    const auto take = [&](const IsolationState<7, double>& state, const auto& output) {
      if (output.time_s < kFromS || !state.law.known) return;
      of_run.acting += robot.beside.squaredNorm();
      of_run.law += (state.law.load - robot.beside).squaredNorm();
      of_run.network += (output.psi_hat - robot.beside).squaredNorm();
    };
    const FaultDiagnosis<double> said = isolated(robot, take).diagnosis;
    if (said.kind != fault.kind || said.joint != fault.joint) continue;
    ++sums.named;
    sums.acting += of_run.acting;
    sums.law += of_run.law;
    sums.network += of_run.network;
  }
  return sums;
}
TEST(FaultLaw, SaysWhatANamedFaultDoesToTheJointsAtEachTick) {
  std::mt19937_64 generator = seeded_generator();
  for (const PlantedFault& fault :
       {PlantedFault{FaultKind::kFriction, 0, 3}, PlantedFault{FaultKind::kLostTorque, 0, 0.3},
        PlantedFault{FaultKind::kOffset, 0, 3}}) {
    const LeftOver left = left_over(fault, generator);
    SCOPED_TRACE(name_of(fault.kind));
    ASSERT_GE(left.named, 5);
    EXPECT_LT(std::sqrt(left.law / left.acting), 0.1);
    EXPECT_LT(left.law, 0.02 * left.network);
  }
}
// Arms that reverse within a second: most of what a payload does to them is inertia, which the load
// has a filter's time later.
TEST(FaultLaw, HasThePayloadsWeightAtOnceAndItsInertiaAFiltersTimeLater) {
  std::mt19937_64 generator = seeded_generator();
  const LeftOver left = left_over({FaultKind::kPayload, 6, 2}, generator);
  ASSERT_GE(left.named, 5);
  EXPECT_LT(std::sqrt(left.law / left.acting), 0.5);
  EXPECT_LT(left.law, 0.5 * left.network);
}
TEST(FaultLaw, IsThereForNoKindThatHasNone) {
  std::mt19937_64 generator = seeded_generator();
  int decided = 0;
  for (const PlantedFault& fault :
       {PlantedFault{FaultKind::kContact, 3, 20}, PlantedFault{FaultKind::kEncoderJump, 3, 0.3},
        PlantedFault{FaultKind::kEncoderJump, 5, 0.3}}) {
    PlantedRobot<7> robot(generator, fault);
    const IsolationState<7, double> state = isolated(robot);
    EXPECT_EQ(state.diagnosis.kind, fault.kind);
    decided += state.diagnosis.decided ? 1 : 0;
    EXPECT_FALSE(state.law.known) << name_of(fault.kind);
  }
  EXPECT_EQ(decided, 3);
}
// What acts on a joint that is healthy is what was learnt of it: nothing before it is detected.
TEST(FaultLaw, OfAJointLeavesTheOthersToTheNetwork) {
  std::mt19937_64 generator = seeded_generator();
  PlantedRobot<7> robot(generator, {FaultKind::kFriction, 3, 4});
  int known = 0;
  isolated(robot, [&](const IsolationState<7, double>& state, const auto& output) {
    if (!state.law.known) return;
    ++known;
    for (Eigen::Index i = 0; i < 7; ++i) {
      if (i == 3) continue;
      ASSERT_EQ(state.law.load[i], output.psi_hat[i]) << "joint " << i + 1;
    }
  });
  EXPECT_GT(known, 1000);
}
// At the tick that names it, which is often just after the joint turned round: what the filter
// holds is of before.
TEST(FaultLaw, IsRightFromItsFirstTickOn) {
  std::mt19937_64 generator = seeded_generator();
  int asked = 0;
  for (int run = 0; run < 14; ++run) {
    PlantedRobot<7> robot(generator, {FaultKind::kFriction, run % 7, 4});
    bool first = true;
    const auto state =
        isolated(robot, [&](const IsolationState<7, double>& at, const auto& /*output*/) {
          const auto joint = static_cast<Eigen::Index>(at.law.joint);
          if (!at.law.known || !first || joint != run % 7) return;
          first = false;
          if (std::abs(std::abs(robot.beside[joint]) - 4) > 0.1) return;
          ++asked;
          EXPECT_NEAR(at.law.load[joint], robot.beside[joint], 0.5) << "run " << run;
        });
    EXPECT_TRUE(state.triggered);
  }
  EXPECT_GE(asked, 8);
}
// A friction that is gone would be pushed against for ever.
TEST(FaultLaw, IsTakenBackWhereTheFaultIsOver) {
  std::mt19937_64 generator = seeded_generator();
  int known = 0;
  for (const FaultKind kind :
       {FaultKind::kFriction, FaultKind::kLostTorque, FaultKind::kOffset, FaultKind::kPayload}) {
    const bool is_share = kind == FaultKind::kLostTorque;
    PlantedRobot<7> robot(generator,
                          {kind, kind == FaultKind::kPayload ? 6 : 2, is_share ? 0.5 : 4.0});
    robot.over_at_s = 4.8;
    bool was_known = false;
    const auto state =
        isolated(robot, [&](const IsolationState<7, double>& at, const auto& output) {
          was_known = was_known || (at.law.known && output.time_s < robot.over_at_s);
        });
    known += was_known ? 1 : 0;
    EXPECT_FALSE(state.law.known) << name_of(kind);
    EXPECT_TRUE(state.diagnosis.decided) << "what it was stays said";
  }
  EXPECT_GE(known, 3);
}

// No torque shows it: the bound allows any.
TEST(Isolation, SeesAnEncoderThatJumpsWhereNoTorqueTellsOfIt) {
  std::mt19937_64 generator = seeded_generator();
  for (Eigen::Index joint = 0; joint < 7; ++joint) {
    const PlantedFault fault{FaultKind::kEncoderJump, joint, joint % 2 == 0 ? 0.03 : -0.03};
    PlantedRobot<7> robot(generator, fault);
    for (auto& bound : robot.config.bound.joints) bound.value[0] = 1e6;
    const IsolationState<7, double> state = isolated(robot);
    ASSERT_TRUE(state.triggered) << "joint " << joint + 1;
    EXPECT_NEAR(static_cast<double>(state.detection_tick) * kPlantedPeriodS, kPlantedAtS, 0.0011);
    EXPECT_EQ(state.diagnosis.kind, FaultKind::kEncoderJump);
    check(state.diagnosis, fault, 0.05);
  }
}
// Detected before the first block that shows it has ended, and after a small error of the model
// that has lasted for as long as is looked back: that error is not the fault's beginning.
TEST(Isolation, TakesNoSmallErrorFromBeforeForTheBeginning) {
  std::mt19937_64 generator = seeded_generator();
  int named = 0;
  for (int run = 0; run < 14; ++run) {
    PlantedRobot<7> robot(generator, {FaultKind::kFriction, run % 7, 4});
    robot.error_before = 0.08;
    const IsolationState<7, double> state = isolated(robot);
    if (!is_seen_soon(state)) continue;
    EXPECT_GE(state.diagnosis.onset_s, kPlantedAtS - 0.05) << "run " << run;
    named += state.diagnosis.kind == FaultKind::kFriction ? 1 : 0;
  }
  EXPECT_GE(named, 12);
}
// A joint that hardly moves when its encoder sticks does not show it.
TEST(Isolation, NamesAnEncoderThatSticks) {
  expect_named<7>({FaultKind::kEncoderStuck, 0, 0, 0.85});
}
// What tells it from an encoder that sticks is only what the other joints feel.
// Two of three it is; of the 20 robots that either compiler draws 14 and 13.
TEST(Isolation, NamesAJointThatIsLocked) { expect_named<7>({FaultKind::kLockedJoint, 20, 0, 0.6}); }

// Until a joint stands still, more friction and a constant torque are one. What then acts on it, no
// more than that friction, its friction holds; a constant torque would have moved it.
TEST(Isolation, TakesForFrictionWhatHoldsAJointThatStands) {
  IsolationState<2, double> state;
  IsolationScales<2, double> scales{OwnValues<2, double>::Ones(), {}};
  scales.thresholds = {1, 1};
  for (int block = 0; block < 30; ++block) {
    Vector<kOwnRegressors, double> own = Vector<kOwnRegressors, double>::Zero();
    own[kSignRegressor] = 1;
    own[kOneRegressor] = 1;
    take(state.joints[0].own, own, 2.0, 9.0);
    state.joints[0].largest_own = own;
  }
  state.blocks = 60;
  state.alarmed = {true, false};
  const auto share_of_friction = [&](double largest_held) {
    state.joints[0].largest_held = largest_held;
    state.joints[0].held.evidence = 12;
    const Contest<double> contest =
        contest_of(state, scales, EncoderTimes<double>{100, 0, 0, 0, 1000, 1e4});
    EXPECT_EQ(contest.kind, FaultKind::kFriction);
    return contest.share();
  };
  EXPECT_GT(share_of_friction(-1.9), 0.99);
  EXPECT_LT(share_of_friction(8), 0.9) << "no friction of 2 N m holds 8";
}

TEST(Isolation, CallsAPushAContactWhicheverLinkItMeets) {
  std::mt19937_64 generator = seeded_generator();
  for (int run = 0; run < repetitions(20); ++run) {
    PlantedRobot<7> robot(generator, {FaultKind::kContact, 2 + run % 5, 6});
    const FaultDiagnosis<double> said = isolated(robot).diagnosis;
    EXPECT_STREQ(name_of(said.kind), "contact") << "run " << run;
    EXPECT_EQ(said.joint, 2 + run % 5) << "run " << run;
    EXPECT_NEAR(std::abs(said.size), 6, 2) << "run " << run;
  }
}

// Two faults at once. Where both pause it looks like a push that is over.
TEST(Isolation, LeavesUnknownWhatNoHypothesisOfTheBankExplains) {
  std::mt19937_64 generator = seeded_generator();
  int unknown = 0;
  for (int run = 0; run < 20; ++run) {
    PlantedRobot<7> robot(generator, {FaultKind::kUnknown, 3 + run % 4, 3});
    const IsolationState<7, double> state = isolated(robot);
    EXPECT_TRUE(state.triggered) << "run " << run;
    const FaultKind said = state.diagnosis.kind;
    unknown += said == FaultKind::kUnknown ? 1 : 0;
    EXPECT_TRUE(said == FaultKind::kUnknown || said == FaultKind::kContact)
        << "run " << run << ": " << name_of(said);
  }
  EXPECT_GE(unknown, 15);
}

// Two kinds that are one on an arm that stands stay two, for as long as it does.
TEST(Isolation, IsNotPressedForTimeByAnArmThatStands) {
  std::mt19937_64 generator = seeded_generator();
  int open = 0;
  for (int run = 0; run < 20; ++run) {
    PlantedRobot<2> robot(generator, {FaultKind::kOffset, run % 2, 3});
    robot.stand();
    const IsolationState<2, double> state = isolated(robot);
    EXPECT_TRUE(state.triggered) << "run " << run;
    const FaultDiagnosis<double>& said = state.diagnosis;
    EXPECT_EQ(said.decided, said.kind != FaultKind::kUnknown && said.confidence >= 0.99)
        << "run " << run << ", " << name_of(said.kind) << " " << said.confidence;
    open += said.decided ? 0 : 1;
  }
  EXPECT_GE(open, 10);
}

TEST(Isolation, IsSilentWhereNothingIsPlanted) {
  std::mt19937_64 generator = seeded_generator();
  for (int run = 0; run < repetitions(10); ++run) {
    PlantedRobot<7> robot(generator, {});
    const IsolationState<7, double> state = isolated(robot);
    EXPECT_FALSE(state.triggered);
    EXPECT_FALSE(state.diagnosis.decided);
    EXPECT_EQ(state.diagnosis.time_s, 0);
  }
}

// The same samples with their number of joints known at run time only.
TEST(Isolation, SaysTheSameToTheBitWhereTheNumberOfJointsIsOneOfRunTime) {
  std::mt19937_64 generator = seeded_generator();
  PlantedRobot<7> robot(generator, {FaultKind::kPayload, 6, 1.5});
  using Fixed = Monitor<7, kFaultUnits, double, WithoutMemory, TorqueSpace>;
  using AtRunTime = Monitor<kRuntimeJoints, kFaultUnits, double, WithoutMemory, TorqueSpace>;
  MonitorConfig<kRuntimeJoints, double, TorqueSpace> config;
  config.chain.joints.assign(7, {});
  config.bound.joints.assign(7, {});
  config.max_compensation.assign(7, 0);
  for (std::size_t i = 0; i < 7; ++i) {
    config.chain.joints[i] = robot.config.chain.joints[i];
    config.bound.joints[i] = robot.config.bound.joints[i];
  }
  config.chain.gravity_m_s2 = robot.config.chain.gravity_m_s2;
  config.estimator = robot.config.estimator;
  Fixed monitor;
  AtRunTime other;
  ASSERT_EQ(Fixed::create(robot.config, monitor), Status::kOk);
  ASSERT_EQ(AtRunTime::create(config, other), Status::kOk);
  Isolation<7, double> isolation;
  Isolation<kRuntimeJoints, double> other_isolation;
  ASSERT_EQ((Isolation<7, double>::create({}, robot.config, isolation)), Status::kOk);
  ASSERT_EQ((Isolation<kRuntimeJoints, double>::create({}, config, other_isolation)), Status::kOk);
  Fixed::State state;
  Fixed::Output output;
  AtRunTime::State other_state;
  AtRunTime::Output other_output;
  IsolationState<7, double> said;
  IsolationState<kRuntimeJoints, double> other_said;
  isolation.reset(said);
  other_isolation.reset(other_said);
  for (std::uint64_t tick = 0; tick < 4000; ++tick) {
    const JointSample<7, double> now = robot.sample(tick);
    const JointSample<kRuntimeJoints, double> same{now.q, now.dq, now.tau};
    if (tick == 0) {
      ASSERT_EQ(monitor.reset(now, state), Status::kOk);
      ASSERT_EQ(other.reset(same, other_state), Status::kOk);
      continue;
    }
    ASSERT_EQ(monitor.step(now, state, output), Status::kOk);
    ASSERT_EQ(other.step(same, other_state, other_output), Status::kOk);
    isolation.step(monitor.model(), now, state.tick, output, said);
    other_isolation.step(other.model(), same, other_state.tick, other_output, other_said);
  }
  EXPECT_STREQ(name_of(said.diagnosis.kind), "payload");
  EXPECT_EQ(other_said.diagnosis.kind, said.diagnosis.kind);
  EXPECT_EQ(other_said.diagnosis.size, said.diagnosis.size);
  EXPECT_EQ(other_said.diagnosis.deviation, said.diagnosis.deviation);
  EXPECT_EQ(other_said.diagnosis.confidence, said.diagnosis.confidence);
  EXPECT_EQ(other_said.diagnosis.time_s, said.diagnosis.time_s);
  ASSERT_TRUE(said.law.known && other_said.law.known);
  for (Eigen::Index i = 0; i < 7; ++i) EXPECT_EQ(other_said.law.load[i], said.law.load[i]);
}

TEST(Isolation, RefusesAConfigurationThatMeansNothing) {
  const MonitorConfig<2, double, TorqueSpace> watched;
  Isolation<2, double> isolation;
  IsolationConfig<double> config;
  config.block_s = 0;
  EXPECT_EQ((Isolation<2, double>::create(config, watched, isolation)), Status::kInvalidLimit);
  config = {};
  config.least_s = 5;
  EXPECT_EQ((Isolation<2, double>::create(config, watched, isolation)), Status::kInvalidLimit);
  config = {};
  config.confidence = 1;
  EXPECT_EQ((Isolation<2, double>::create(config, watched, isolation)), Status::kInvalidLimit);
}

}  // namespace
}  // namespace offnominal::test
