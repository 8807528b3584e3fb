#include "explain/doctor.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>
#include <string>

#include "../compare/recorded_arm.hpp"
#include "hidden_case.hpp"
#include "serial_arm.hpp"
#include "support/repetitions.hpp"

namespace offnominal::desk {
namespace {

namespace hidden = sim::hidden;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Kinds that were found, each once, in words.
std::string found_in(const std::vector<DataFault>& faults) {
  std::string kinds;
  for (const DataFault& fault : faults) {
    const std::string kind = name_of(fault.kind);
    if (kinds.find(kind) == std::string::npos) kinds += (kinds.empty() ? "" : " ") + kind;
    EXPECT_FALSE(fault.words.empty());
    EXPECT_FALSE(fault.mend.empty());
  }
  return kinds;
}

std::vector<DataFault> examine_case(const hidden::Request& request) {
  const hidden::Case made = hidden::make_case(request);
  return examine(test::to_log(made.recording), test::to_robot(made.nominal));
}

hidden::Request request_of(int seed, bool noisy) {
  hidden::Request request;
  request.seed = static_cast<std::uint64_t>(seed);
  request.torque_noise_share = noisy ? 0.03 : 0.002;
  request.encoder_bits = noisy ? 13 : 19;
  return request;
}

constexpr int kSeeds = test::repetitions(3);

void expect_fault(hidden::DataFault fault, const std::string& kind) {
  for (int seed = 1; seed <= kSeeds; ++seed) {
    for (const bool noisy : {false, true}) {
      hidden::Request request = request_of(seed, noisy);
      request.fault = fault;
      const auto faults = examine_case(request);
      EXPECT_EQ(found_in(faults), kind) << "seed " << seed << " noisy " << noisy << ": "
                                        << (faults.empty() ? "" : faults.back().words);
    }
  }
}

TEST(Doctor, NamesPositionsInDegrees) { expect_fault(hidden::DataFault::kDegrees, "degrees"); }

TEST(Doctor, NamesTorqueOfTheWrongSign) {
  expect_fault(hidden::DataFault::kSwappedTorqueSign, "torque_sign");
}

TEST(Doctor, NamesStaleSamples) { expect_fault(hidden::DataFault::kStaleSamples, "stale_samples"); }

TEST(Doctor, NamesClocksThatDiffer) { expect_fault(hidden::DataFault::kClockSkew, "clock_skew"); }

TEST(Doctor, NamesTheJointWhoseTorqueHasTheWrongSign) {
  test::ArmRecording settings;
  settings.torque_noise = 0.05;
  Log log = test::record_arm(settings);
  log.tau.col(1) *= -1;
  const auto faults = examine(log, test::arm_description());
  ASSERT_EQ(faults.size(), 1U);
  EXPECT_EQ(faults[0].kind, DataFaultKind::kTorqueSign);
  EXPECT_EQ(faults[0].joint, 1);
  EXPECT_NEAR(faults[0].size, -1, 0.05);
}

// A tool that no file knows of weighs against a light last link, and turns its torque round. The
// sign is told by what the others carry; one that is wrong still is, with the tool or without.
TEST(Doctor, TakesNoToolForATorqueOfTheWrongSign) {
  RobotDescription robot = test::serial_arm(2);
  for (RobotEffect& effect : robot.effects) effect.parameters[0] *= 0.2;
  RobotDescription real = robot;
  // The last link has 2.1 kg at 0.086 m along x and 0.03 m along z.
  real.effects.push_back(test::effect_of(EffectKind::kTipPayload, 1, {4, -0.11, 0, -0.04}, false));
  const Log with_tool = test::record(real, {.duration_s = 20});
  EXPECT_EQ(found_in(examine(with_tool, robot)), "");
  for (const RobotDescription& one : {robot, real}) {
    Log turned = test::record(one, {.duration_s = 20});
    turned.tau.col(1) *= -1;
    const auto faults = examine(turned, one);
    ASSERT_EQ(faults.size(), 1U) << found_in(faults);
    EXPECT_EQ(faults[0].kind, DataFaultKind::kTorqueSign);
    EXPECT_EQ(faults[0].joint, 1);
  }
}

// A body far behind the flange would explain two or three of a wrist at once.
TEST(Doctor, NamesEveryTorqueOfTheWrongSignOfAWrist) {
  RobotDescription robot = test::serial_arm(5);
  for (RobotEffect& effect : robot.effects) effect.parameters[0] *= 0.1;
  const Log right = test::record(robot, {.duration_s = 20});
  for (const std::vector<Index>& wrong :
       {std::vector<Index>{3, 4}, std::vector<Index>{2, 4}, std::vector<Index>{2, 3, 4}}) {
    Log log = right;
    for (const Index joint : wrong) log.tau.col(joint) *= -1;
    std::vector<Index> told;
    for (const DataFault& fault : examine(log, robot)) {
      if (fault.kind == DataFaultKind::kTorqueSign) told.push_back(fault.joint);
    }
    EXPECT_EQ(told, wrong) << found_in(examine(log, robot));
  }
}

// Damping that somebody guessed for a simulator is more than all the rest of the torque: the signs
// are still told, and only those that are wrong.
TEST(Doctor, NamesTorquesOfTheWrongSignBesideAGuessedFriction) {
  test::ArmRecording settings;
  settings.torque_noise = 0.05;
  const Log right = test::record_arm(settings);
  RobotDescription robot = test::arm_description();
  for (int joint = 0; joint < 2; ++joint) {
    const double usual = right.dq.col(joint).norm() / right.tau.col(joint).norm();
    robot.effects.push_back(
        test::effect_of(EffectKind::kViscousFriction, joint, {2 / usual}, false));
  }
  EXPECT_EQ(found_in(examine(right, robot)), "");
  Log wrong = right;
  wrong.tau *= -1;
  const auto faults = examine(wrong, robot);
  ASSERT_EQ(faults.size(), 2U) << found_in(faults);
  for (std::size_t i = 0; i < faults.size(); ++i) {
    EXPECT_EQ(faults[i].kind, DataFaultKind::kTorqueSign);
    EXPECT_EQ(faults[i].joint, static_cast<Index>(i));
  }
}

// Without gravity friction is most of the torque. Positions times pi/180 take the guessed viscous
// part out of the model and leave the dry one as it is.
TEST(Doctor, TakesNoGuessedFrictionForDegrees) {
  for (const double times : {10.0, 30.0}) {
    RobotDescription robot = test::serial_arm(1);
    robot.effects.at(1).parameters[0] = 4;
    const Log log = test::record(robot, {.duration_s = 20});
    robot.effects.at(0).parameters[0] *= times;
    EXPECT_EQ(found_in(examine(log, robot)), "") << times;
  }
}

// A drive that counts torque the other way does so on every joint, also on one that does not tell.
TEST(Doctor, TurnsAllTorquesWhereEveryJointThatTellsIsTurned) {
  const RobotDescription robot = test::serial_arm(3);
  Log log = test::record(robot, {.duration_s = 20});
  std::mt19937_64 generator(1);
  std::normal_distribution<double> noise(0, 0.02);
  for (double& torque : log.tau.col(0)) torque = noise(generator);
  log.tau *= -1;
  const auto signs_in = [&](Log one) {
    auto faults = examine(one, robot);
    std::erase_if(faults,
                  [](const DataFault& fault) { return fault.kind != DataFaultKind::kTorqueSign; });
    return faults;
  };
  const auto faults = signs_in(log);
  ASSERT_EQ(faults.size(), 2U);
  EXPECT_THAT(faults[0].mend, testing::HasSubstr("all are taken for turned"));
  log.tau.col(1) *= -1;
  const auto one = signs_in(log);
  ASSERT_EQ(one.size(), 1U);
  EXPECT_THAT(one[0].mend, testing::Not(testing::HasSubstr("all are taken for turned")));
}

TEST(Doctor, KnowsTheJointInDegreesAndStillSeesAnotherFault) {
  test::ArmRecording settings;
  settings.torque_noise = 0.05;
  Log log = test::record_arm(settings);
  log.q.col(0) *= 180 / std::numbers::pi;
  log.tau.col(0) *= -1;
  const auto faults = examine(log, test::arm_description());
  ASSERT_EQ(faults.size(), 2U);
  EXPECT_EQ(faults[0].kind, DataFaultKind::kDegrees);
  EXPECT_EQ(faults[0].joint, 0);
  EXPECT_EQ(faults[1].kind, DataFaultKind::kTorqueSign);
  EXPECT_EQ(faults[1].joint, 0);
}

TEST(Doctor, MeasuresTheShiftOfTheTorque) {
  test::ArmRecording settings;
  settings.torque_noise = 0.05;
  for (const Index rows : {-25, 25}) {
    Log log = test::record_arm(settings);
    const MatrixXd tau = log.tau;
    for (Index i = 0; i < tau.rows(); ++i) {
      log.tau.row(i) = tau.row(std::clamp<Index>(i - rows, 0, tau.rows() - 1));
    }
    const auto faults = examine(log, test::arm_description());
    ASSERT_EQ(found_in(faults), "clock_skew") << rows;
    EXPECT_NEAR(faults[0].size, 1e-3 * static_cast<double>(rows), 1e-3);
  }
}

TEST(Doctor, FindsNothingInCleanRecordings) {
  for (int seed = 1; seed <= kSeeds; ++seed) {
    for (const bool noisy : {false, true}) {
      for (const auto excitation : {hidden::Excitation::kRich, hidden::Excitation::kPoor}) {
        hidden::Request request = request_of(seed, noisy);
        request.excitation = excitation;
        EXPECT_EQ(found_in(examine_case(request)), "") << "seed " << seed << " noisy " << noisy;
      }
    }
  }
}

TEST(Doctor, TakesNoHiddenEffectForAFault) {
  for (const auto effect : test::every_nth(hidden::all_hidden_effects(), 5)) {
    for (const bool noisy : {false, true}) {
      hidden::Request request = request_of(11, noisy);
      request.effects = {effect};
      EXPECT_EQ(found_in(examine_case(request)), "") << hidden::name(effect);
    }
  }
}

// A slow joint with a 12-bit encoder: its reading repeats a hundred times between two steps.
TEST(Doctor, ExcusesACoarseEncoderAtLowSpeed) {
  test::ArmRecording settings;
  settings.amplitude = 0.02;
  settings.torque_noise = 0.02;
  settings.encoder_step = 2 * std::numbers::pi / 4096;
  EXPECT_EQ(found_in(examine(test::record_arm(settings), test::arm_description())), "");
  settings.amplitude = 0.3;
  EXPECT_EQ(found_in(examine(test::record_arm(settings), test::arm_description())), "");
}

TEST(Doctor, ExcusesADriveThatRoundsItsTorque) {
  for (const double quantum : {0.05, 0.5}) {
    for (const double noise : {0.0, 0.02, 0.2}) {
      test::ArmRecording settings;
      settings.torque_noise = noise;
      Log log = test::record_arm(settings);
      log.tau = quantum * (log.tau / quantum).array().round().matrix();
      EXPECT_EQ(found_in(examine(log, test::arm_description())), "") << quantum << " " << noise;
    }
  }
}

TEST(Doctor, ExcusesSensorsThatAreReadFasterThanTheyAnswer) {
  Log log = test::record_arm({});
  for (Index i = 0; i < log.sample_count(); ++i) {
    log.q.row(i) = log.q.row(i - i % 4);
    log.tau.row(i) = log.tau.row(i - i % 5);
  }
  EXPECT_EQ(found_in(examine(log, test::arm_description())), "");
}

TEST(Doctor, FindsStaleSamplesBetweenTheStepsOfACoarseEncoder) {
  test::ArmRecording settings;
  settings.torque_noise = 0.02;
  settings.encoder_step = 2 * std::numbers::pi / 4096;
  Log log = test::record_arm(settings);
  for (Index start = 500; start + 20 < log.sample_count(); start += 500) {
    for (Index i = 1; i < 15; ++i) log.q.row(start + i) = log.q.row(start);
  }
  const auto faults = examine(log, test::arm_description());
  ASSERT_EQ(found_in(faults), "stale_samples");
  EXPECT_GT(faults[0].size, 0.01);
  EXPECT_LT(faults[0].size, 0.04);
}

TEST(Doctor, SaysNothingAboutARobotThatStands) {
  Log log = test::record_arm({});
  log.q.rowwise() = log.q.row(0).eval();
  log.dq.setZero();
  MatrixXd tau = log.tau;
  tau.rowwise() = log.tau.row(0).eval();
  log.tau = tau;
  EXPECT_EQ(found_in(examine(log, test::arm_description())), "");
  log.tau.setZero();
  EXPECT_EQ(found_in(examine(log, test::arm_description())), "");
  log.q.setZero();
  EXPECT_EQ(found_in(examine(log, test::arm_description())), "");
}

TEST(Doctor, SaysNothingAboutAFewSamples) {
  const Log whole = test::record_arm({});
  for (const Index rows : {1, 2, 3, 10, 11, 50, 200, 400, 1700}) {
    Log log = whole;
    log.t_s = whole.t_s.head(rows);
    log.q = whole.q.topRows(rows);
    log.dq = whole.dq.topRows(rows);
    log.tau = whole.tau.topRows(rows);
    EXPECT_EQ(found_in(examine(log, test::arm_description())), "") << rows;
  }
}

TEST(Doctor, FindsADriveAtItsLimit) {
  Log log = test::record_arm({});
  const double limit = 0.8 * log.tau.col(0).maxCoeff();
  log.tau.col(0) = log.tau.col(0).cwiseMin(limit);
  const auto faults = examine(log, test::arm_description());
  ASSERT_EQ(found_in(faults), "saturation");
  EXPECT_EQ(faults[0].joint, 0);
  EXPECT_NEAR(faults[0].size,
              static_cast<double>((log.tau.col(0).array() == limit).count()) /
                  static_cast<double>(log.sample_count()),
              0.01);
}

TEST(Doctor, FindsGapsInTheTime) {
  Log log = test::record_arm({});
  EXPECT_EQ(found_in(examine(log, test::arm_description())), "");
  log.t_s.tail(log.sample_count() - 7000).array() += 0.003;
  const auto faults = examine(log, test::arm_description());
  ASSERT_EQ(found_in(faults), "gaps");
  EXPECT_NEAR(faults[0].size, 0.004, 1e-9);
}

// Nothing but friction, which the model lacks: only the power tells the sign.
TEST(Doctor, KnowsTheSignOfTorqueFromItsPower) {
  Log log = test::record_arm({});
  RobotDescription robot = test::arm_description();
  robot.gravity_m_s2 = {0, 0, 0};
  for (RobotJoint& joint : robot.joints) joint.joint.mass_kg = 1e-6;
  log.tau = 3 * log.dq.array().sign().matrix() + log.dq;
  EXPECT_EQ(found_in(examine(log, robot)), "");
  log.tau *= -1;
  EXPECT_EQ(found_in(examine(log, robot)), "torque_sign");
}

TEST(Doctor, RefusesARobotWithAnotherNumberOfJoints) {
  RobotDescription robot = test::arm_description();
  robot.joints.pop_back();
  EXPECT_THROW(static_cast<void>(examine(test::record_arm({}), robot)), std::invalid_argument);
}

// A joint that is held while the other one moves: its encoder flickers between a few counts.
TEST(Doctor, HasNothingAgainstTheFlickerOfAJointThatStandsStill) {
  test::ArmRecording settings;
  settings.torque_noise = 0.05;
  Log log = test::record_arm(settings);
  constexpr double kCount = 6e-6;
  for (Index i = 0; i < log.sample_count(); ++i) {
    const double waver =
        std::sin(0.01 * static_cast<double>(i)) + 0.6 * std::sin(0.0037 * static_cast<double>(i));
    log.q(i, 1) = kCount * (50000 + std::round(1.4 * waver));
  }
  log.dq_derived = {true, true};
  for (const DataFault& fault : examine(log, test::arm_description())) {
    EXPECT_NE(fault.signal, FaultySignal::kPosition) << fault.words;
    EXPECT_NE(fault.kind, DataFaultKind::kWrapped) << fault.words;
  }
}

}  // namespace
}  // namespace offnominal::desk
