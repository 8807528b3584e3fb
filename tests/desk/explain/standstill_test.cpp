// A joint that dry friction holds shows nothing of the model: such stretches must not count.

#include "compare/standstill.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "explain/explain.hpp"
#include "log/read_log.hpp"
#include "robot/robot_file.hpp"
#include "sticking_pendulum.hpp"
#include "support/recordings.hpp"
#include "support/robots.hpp"

namespace offnominal::desk {
namespace {

ExplainOptions few_draws() {
  ExplainOptions options;
  options.bootstrap_draws = 399;
  options.threads = 2;
  return options;
}

bool names(const std::vector<EffectAt>& same, const std::string& effect) {
  return std::any_of(same.begin(), same.end(),
                     [&](const EffectAt& one) { return one.name() == effect; });
}

// 100 Hz, 1000 counts per rad: moves for 2 s, then as `rest` says, then moves for 2 s again.
Log interrupted_by(const Eigen::VectorXd& rest) {
  Log log;
  log.period_s = 0.01;
  log.q.resize(400 + rest.size(), 1);
  log.q.col(0).head(200).setLinSpaced(0, 1);
  log.q.col(0).segment(200, rest.size()) = 1.01 + rest.array();
  log.q.col(0).tail(200).setLinSpaced(1.02, 2);
  log.t_s = 0.01 * Eigen::VectorXd::LinSpaced(log.q.rows(), 0, static_cast<double>(log.q.rows()));
  return log;
}

TEST(MovingSamples, AreNotThoseOfALongStandstill) {
  Eigen::VectorXd flicker = Eigen::VectorXd::Zero(80);
  flicker[40] = 0.001;
  const Eigen::VectorXd moving = moving_samples(interrupted_by(flicker), 0, 1000);
  EXPECT_EQ(moving.segment(200, 80).sum(), 0);
  EXPECT_EQ(moving.sum(), 400);
}

// 100 Hz, top speed 1: moves, is as slow as `speed`, and moves on.
Eigen::VectorXd moving_beside(const Eigen::VectorXd& speed) {
  Eigen::VectorXd whole = Eigen::VectorXd::Ones(400 + speed.size());
  whole.segment(200, speed.size()) = speed;
  Eigen::VectorXd moving = Eigen::VectorXd::Ones(whole.size());
  leave_out_sticking(whole, 1, 0.01, moving);
  return moving;
}

TEST(Sticking, IsLeftOutWithWhatTheFilterSmears) {
  const Eigen::VectorXd moving = moving_beside(Eigen::VectorXd::Constant(20, 0.015));
  EXPECT_EQ(moving.segment(196, 28).sum(), 0);
  EXPECT_EQ(moving.sum(), 392);
}

TEST(Sticking, IsNotAReversal) {
  EXPECT_EQ(moving_beside(Eigen::VectorXd::LinSpaced(9, -0.015, 0.015)).minCoeff(), 1);
}

TEST(Sticking, IsNotALongSlowMotionUnlessItStopsInBetween) {
  Eigen::VectorXd slow = Eigen::VectorXd::Constant(60, 0.015);
  EXPECT_EQ(moving_beside(slow).minCoeff(), 1);
  slow[30] = 0.001;
  EXPECT_EQ(moving_beside(slow).sum(), 392);
}

TEST(Sticking, IsKeptWhereHardlyAnythingElseWouldBeLeft) {
  EXPECT_EQ(moving_beside(Eigen::VectorXd::Zero(9000)).minCoeff(), 1);
}

TEST(MovingSamples, AreThoseOfAShortRestToo) {
  EXPECT_EQ(moving_samples(interrupted_by(Eigen::VectorXd::Zero(40)), 0, 1000).minCoeff(), 1);
}

TEST(MovingSamples, AreAllWhereNothingIsKnownOfTheEncoderOrNothingMoves) {
  EXPECT_EQ(moving_samples(interrupted_by(Eigen::VectorXd::Zero(80)), 0, 0).minCoeff(), 1);
  Log still = interrupted_by(Eigen::VectorXd::Zero(80));
  still.q.setConstant(0.3);
  EXPECT_EQ(moving_samples(still, 0, 1000).minCoeff(), 1);
}

TEST(Standstill, LoadDependentFrictionIsNamedThoughItHoldsTheJointMostOfTheTime) {
  const Log log = test::recording_of({.load_factor = 0.3});
  RobotDescription robot = test::pendulum();
  const double counts_per_unit = robot.joints[0].encoder.counts_per_unit;
  // Nothing known of the encoder: the speed alone says where the joint sticks.
  for (const double known : {counts_per_unit, 0.0}) {
    robot.joints[0].encoder.counts_per_unit = known;
    const Explanation e = explain(robot, {log}, {}, few_draws());
    ASSERT_EQ(e.verdict, Verdict::kFound) << e.words;
    ASSERT_EQ(e.found.size(), 1U);
    EXPECT_EQ(e.found[0].what.name(), "load_dependent_friction");
    EXPECT_NEAR(e.found[0].parameters[0].value.value, 0.3, 0.015);
  }
}

TEST(Standstill, CoulombFrictionIsNotTakenForIt) {
  const Log log = test::recording_of({.load_factor = 0, .dry_nm = 0.06});
  const Explanation e = explain(test::pendulum(), {log}, {}, few_draws());
  ASSERT_FALSE(e.found.empty()) << e.words;
  EXPECT_EQ(e.found[0].what.name(), "coulomb_friction");
}

TEST(Standstill, NothingIsFoundWhereNothingIsMissing) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const Log log = test::recording_of({.seed = seed, .load_factor = 0});
    const Explanation e = explain(test::pendulum(), {log}, {}, few_draws());
    EXPECT_EQ(e.verdict, Verdict::kExplained) << e.words;
  }
}

// Twelve recordings of a servo with plastic gears, robots/bam_xl330.toml: four gains, three
// motions.
class BamXl330 : public ::testing::Test {
 protected:
  void SetUp() override {
    robot_ = read_robot_file(test::kRobots / "bam_xl330.toml");
    const auto folder = test::recordings_dir() / "bam_xl330/csv";
    for (const char* gain : {"kp100", "kp200", "kp400", "kp800"}) {
      for (const char* motion : {"sin_sin", "sin_time_square", "up_and_down"}) {
        const auto file = folder / (std::string(gain) + "_" + motion + ".csv");
        if (!std::filesystem::exists(file)) {
          GTEST_SKIP() << "no recording at " << file << "; OFFNOMINAL_DATA names its folder";
        }
        logs_.push_back(read_log(file, robot_));
      }
    }
  }

  void know(EffectKind kind, double first) {
    RobotEffect effect;
    effect.kind = kind;
    effect.parameters = {first, 0.03};
    effect.fitted = true;
    robot_.effects.push_back(effect);
  }

  RobotDescription robot_;
  std::vector<Log> logs_;
};

TEST_F(BamXl330, LoadDependentFrictionComesFirst) {
  const Explanation e = explain(robot_, logs_, {}, few_draws());
  ASSERT_FALSE(e.found.empty());
  // By the load, alone (the authors' model M3) or with another share where the load drives the gear
  // back (M5).
  EXPECT_THAT(e.found[0].what.name(), ::testing::AnyOf("load_dependent_friction", "gear_loss"))
      << e.words;
  for (const Finding& one : e.found) EXPECT_NE(one.what.name(), "coulomb_friction");
  // Beside links as wide as the recordings ask for, which take some of it by themselves.
  EXPECT_LT(e.joints[0].holdout_after, 0.5 * e.joints[0].rms_before);
}

TEST_F(BamXl330, BesideItCoulombFrictionIsDropped) {
  know(EffectKind::kLoadDependentFriction, 0.3);
  const std::vector<Log> gentle(logs_.begin(), logs_.begin() + 6);
  const Explanation e = explain(robot_, gentle, {}, few_draws());
  // At most another value of what the file knows, that other effects would not show, or the doubt
  // that the loss depends on which way power flows (the authors' model M5).
  EXPECT_THAT(e.verdict,
              ::testing::AnyOf(Verdict::kExplained, Verdict::kParameterShift, Verdict::kNotExcited))
      << e.words;
  if (e.suspected) {
    EXPECT_EQ(e.suspected->what.name(), "gear_loss") << e.words;
  }
  EXPECT_THAT(e.found, ::testing::IsEmpty()) << e.words;
  EXPECT_LT(e.joints[0].rms_after, 1.5 * e.joints[0].noise_floor);
  const auto coulomb = std::find_if(e.rejected.begin(), e.rejected.end(), [](const Rejection& one) {
    return one.what.name() == "coulomb_friction";
  });
  ASSERT_NE(coulomb, e.rejected.end());
  EXPECT_GT(coulomb->p_value, 0.05);
}

TEST_F(BamXl330, NoChoiceOfRecordingsGivesBareCoulombFriction) {
  for (std::size_t motion = 0; motion < 3; ++motion) {
    std::vector<Log> chosen;
    for (std::size_t i = motion; i < logs_.size(); i += 3) chosen.push_back(logs_[i]);
    const Explanation e = explain(robot_, chosen, {}, few_draws());
    for (const Finding& one : e.found) {
      if (one.what.name() != "coulomb_friction") continue;
      ASSERT_FALSE(e.ambiguous.empty()) << e.words;
      EXPECT_TRUE(names(e.ambiguous[0], "load_dependent_friction")) << e.words;
    }
  }
}

}  // namespace
}  // namespace offnominal::desk
