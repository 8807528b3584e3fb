// What the doctor says of repeats and jumps, and of rows that hold no sample: nothing of what real
// encoders do at rest or under a hand, and all that a recording that fails does.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "../compare/recorded_arm.hpp"
#include "common/error.hpp"
#include "desk/support/temporary_folder.hpp"
#include "explain/doctor.hpp"
#include "log/csv_text.hpp"
#include "log/read_log.hpp"
#include "log/sampling.hpp"
#include "robot/channels.hpp"
#include "robot/robot_file.hpp"
#include "support/places.hpp"
#include "support/recordings.hpp"
#include "support/seed.hpp"

namespace offnominal::desk {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double kTwelveBits = 2 * std::numbers::pi / 4096;

// "stuck 2 torque; ..." of what is said of repeats and jumps.
std::string breaks_in(const std::vector<DataFault>& faults) {
  std::string words;
  for (const DataFault& fault : faults) {
    if (fault.kind != DataFaultKind::kStaleSamples && fault.kind != DataFaultKind::kStuck &&
        fault.kind != DataFaultKind::kJump) {
      continue;
    }
    words += fault.words + "; ";
  }
  return words;
}

std::string all_words(const std::vector<DataFault>& faults) {
  std::string words;
  for (const DataFault& fault : faults) words += fault.words + "; ";
  return words;
}

// As a computer stamps what a drive measured evenly.
void jitter_stamps(Log& log, double share) {
  std::mt19937_64 generator(test::test_seed());
  std::uniform_real_distribution<double> off(-share, share);
  for (Index i = 0; i < log.sample_count(); ++i) log.t_s[i] += off(generator) * log.period_s;
  make_even(log);
}

Log jittered_arm(double amplitude = 1) {
  test::ArmRecording settings;
  settings.rate_hz = 500;
  settings.torque_noise = 0.05;
  settings.encoder_step = kTwelveBits;
  settings.amplitude = amplitude;
  return test::record_arm(settings);
}

struct Real {
  std::string folder, robot, channels;
};

// A recorder that dropped rows and stamped the others on: every joint has gone on as if time had
// passed, and none counts from another zero.
TEST(DoctorOfRows, TakesRowsThatAreMissingForNoOtherZero) {
  const Log whole = jittered_arm();
  const Index lost = 60;
  const Index from = whole.sample_count() / 3;
  const Index rows = whole.sample_count() - lost;
  Log log = whole;
  log.t_s.conservativeResize(rows);
  for (Eigen::MatrixXd Log::*column : {&Log::q, &Log::dq, &Log::tau}) {
    (log.*column) = Eigen::MatrixXd((whole.*column).topRows(rows));
    (log.*column).bottomRows(rows - from) = (whole.*column).bottomRows(rows - from);
  }
  const std::vector<DataFault> faults = examine(log, test::arm_description());
  const std::string words = breaks_in(faults);
  EXPECT_THAT(words, ::testing::HasSubstr("as if rows were missing there"));
  EXPECT_THAT(words, ::testing::Not(::testing::HasSubstr("another zero")));
  for (const DataFault& fault : faults) {
    for (const FaultSpan& span : fault.spans) {
      EXPECT_LE(span.samples.count(), 8) << fault.words;
      EXPECT_NEAR(static_cast<double>(span.samples.first), static_cast<double>(from), 8);
    }
  }
  // One joint alone that goes on from elsewhere does count from another zero.
  Log jumped = whole;
  jumped.q.col(1).tail(rows - from).array() += 0.3;
  EXPECT_THAT(breaks_in(examine(jumped, test::arm_description())),
              ::testing::HasSubstr("another zero"));
}

TEST(DoctorOfRows, SaysNoRepeatAndNoJumpOfRealRecordings) {
  const std::string free_motor =
      "time = \"Time\"\nposition = [\"Position\"]\nvelocity = [\"Velocity\"]\n"
      "torque = [{source = \"Iq\", unit = \"A\", scale = 0.0318}]\n";
  const test::TemporaryFolder folder;
  int seen = 0;
  for (const Real& real :
       {Real{"emps", "emps.toml", ""}, Real{"bam_xl330/csv", "bam_xl330.toml", ""},
        Real{"dfki_pendulum", "dfki_pendulum.toml", ""}, Real{"kuka_kr300", "kuka_kr300.toml", ""},
        Real{"laas_cogging", "mn4004.toml", free_motor}}) {
    const auto recordings = test::recordings_dir() / real.folder;
    if (!std::filesystem::exists(recordings)) continue;
    RobotDescription robot = read_robot_file(test::source_dir() / "robots" / real.robot);
    if (!real.channels.empty()) {
      test::put(folder / "channels.toml", real.channels);
      robot.channels = read_channels_file(folder / "channels.toml", robot.joint_count());
    }
    for (const auto& entry : std::filesystem::directory_iterator(recordings)) {
      const std::string name = entry.path().filename().string();
      const auto extension = entry.path().extension();
      // A hold map is no recording in time, and a table is none at all.
      if (name == "SOURCE.txt" || name == "README.txt" || name == "cogging_tableau.txt" ||
          name == "stopped_data.txt" ||
          (extension != ".csv" && extension != ".mat" && extension != ".txt")) {
        continue;
      }
      ++seen;
      EXPECT_EQ(breaks_in(examine(read_log(entry.path(), robot), robot)), "") << entry.path();
    }
  }
  if (seen == 0) GTEST_SKIP() << "no recordings in " << test::recordings_dir();
}

// GIVEN an encoder of 12 bits and stamps that are off by 2 % WHEN the recording is resampled THEN
// its steps are still no stale samples, and stale samples are.
TEST(DoctorOfRows, ExcusesACoarseEncoderUnderUnevenStamps) {
  for (const double amplitude : {1.0, 0.3, 0.05}) {
    Log log = jittered_arm(amplitude);
    jitter_stamps(log, 0.02);
    ASSERT_TRUE(log.recorded);
    EXPECT_EQ(all_words(examine(log, test::arm_description())), "") << amplitude;
  }
}

// A joint that stands where its encoder is about to count: the spline between uneven stamps swings
// at each change of the count, which is no position that is folded into one count.
TEST(DoctorOfRows, HasNothingAgainstOneCountOfAJointThatStandsUnderUnevenStamps) {
  Log log = jittered_arm();
  for (Index i = 0; i < log.sample_count(); ++i) {
    log.q(i, 1) = kTwelveBits * (i > log.sample_count() / 2 && i % 700 < 90 ? 12 : 11);
  }
  log.dq_derived = {true, true};
  jitter_stamps(log, 0.3);
  ASSERT_TRUE(log.recorded);
  for (const DataFault& fault : examine(log, test::arm_description())) {
    EXPECT_NE(fault.kind, DataFaultKind::kWrapped) << fault.words;
    EXPECT_FALSE(fault.kind == DataFaultKind::kJump && fault.joint == 1) << fault.words;
  }
}

TEST(DoctorOfRows, FindsStaleSamplesUnderUnevenStamps) {
  Log log = jittered_arm();
  for (Index start = 500; start + 20 < log.sample_count(); start += 500) {
    for (Index i = 1; i < 15; ++i) log.q.row(start + i) = log.q.row(start);
  }
  jitter_stamps(log, 0.02);
  const auto faults = examine(log, test::arm_description());
  ASSERT_THAT(faults, testing::SizeIs(2)) << all_words(faults);
  for (const DataFault& fault : faults) {
    EXPECT_EQ(fault.kind, DataFaultKind::kStaleSamples);
    EXPECT_GT(fault.spans.size(), 10U);
    EXPECT_NEAR(fault.spans[0].from_s, log.t_s[501], 0.01);
    EXPECT_NEAR(static_cast<double>(fault.spans[0].first_row), 502, 1);
  }
}

// A joint that stands, its encoder within a few counts of one value: it moves at first, then rests.
TEST(DoctorOfRows, ExcusesTheDustOfAJointThatRests) {
  for (const bool uneven : {false, true}) {
    Log log = jittered_arm();
    std::mt19937_64 generator(test::test_seed());
    std::uniform_int_distribution<int> length(3, 60);
    std::uniform_int_distribution<int> dust(-2, 2);
    const Index from = log.sample_count() / 2;
    const double held = log.q(from, 1);
    for (Index i = from; i < log.sample_count();) {
      const Index count = std::min<Index>(length(generator), log.sample_count() - i);
      log.q.col(1).segment(i, count).setConstant(held + dust(generator) * kTwelveBits);
      i += count;
    }
    log.dq.col(1).tail(log.sample_count() - from).setZero();
    if (uneven) jitter_stamps(log, 0.02);
    EXPECT_EQ(breaks_in(examine(log, test::arm_description())), "") << uneven;
  }
}

// An arm that holds a pose and is pushed: it gives way by a few printed digits at a time.
TEST(DoctorOfRows, ExcusesAHeldPoseThatIsPushedByHand) {
  constexpr double kDigit = 1e-4;
  for (const bool uneven : {false, true}) {
    Log log = jittered_arm();
    std::mt19937_64 generator(test::test_seed());
    std::uniform_int_distribution<int> length(1, 70);
    std::uniform_int_distribution<int> step(-3, 3);
    for (Index joint = 0; joint < 2; ++joint) {
      double digits = 0;
      for (Index i = 0; i < log.sample_count();) {
        const bool pushed = (i / 1000) % 3 == 1;
        const Index count = std::min<Index>(pushed ? 1 + length(generator) / 20 : length(generator),
                                            log.sample_count() - i);
        log.q.col(joint).segment(i, count).setConstant(-1.3705 + digits * kDigit);
        digits += pushed ? step(generator) : step(generator) / 3;
        i += count;
      }
    }
    log.dq.setZero();
    if (uneven) jitter_stamps(log, 0.02);
    EXPECT_EQ(breaks_in(examine(log, test::arm_description())), "") << uneven;
  }
}

TEST(DoctorOfRows, FindsATorqueThatDropsToZeroWhileTheJointMoves) {
  for (const Index rows : {25, 50}) {
    Log log = jittered_arm();
    Index from = 2000;
    while (std::min(std::abs(log.tau(from - 1, 0)), std::abs(log.tau(from + rows, 0))) < 50 ||
           std::abs(log.dq(from, 0)) < 0.3) {
      ++from;
    }
    log.tau.col(0).segment(from, rows).setZero();
    const auto faults = examine(log, test::arm_description());
    ASSERT_THAT(faults, testing::SizeIs(1)) << rows << ": " << all_words(faults);
    EXPECT_EQ(faults[0].kind, DataFaultKind::kStuck);
    EXPECT_EQ(faults[0].joint, 0);
    EXPECT_NEAR(static_cast<double>(faults[0].spans[0].first_row), static_cast<double>(from) + 1,
                1);
    EXPECT_EQ(faults[0].spans[0].samples.count(), rows);
  }
}

TEST(DoctorOfRows, FindsATorqueThatIsOffForManyRows) {
  for (const Index rows : {4, 20, 100}) {
    Log log = jittered_arm();
    log.tau.col(1).segment(3000, rows).array() += 3 * log.tau.col(1).cwiseAbs().maxCoeff();
    const auto faults = examine(log, test::arm_description());
    ASSERT_THAT(faults, testing::SizeIs(1)) << rows << ": " << all_words(faults);
    EXPECT_EQ(faults[0].kind, DataFaultKind::kJump);
    EXPECT_EQ(faults[0].signal, FaultySignal::kTorque);
    EXPECT_EQ(faults[0].spans[0].samples.first, 3000);
    EXPECT_EQ(faults[0].spans[0].samples.count(), rows);
  }
}

// A torque that was there accelerates the joint: a drive that is off for a moment, and a blow.
TEST(DoctorOfRows, ExcusesATorqueThatTheJointAnswersTo) {
  for (const double level : {0.0, 3.0}) {
    // One link without friction, driven by what is recorded.
    test::ArmRecording settings;
    settings.rate_hz = 500;
    Log log = test::record_arm(settings);
    RobotDescription robot = test::arm_description();
    robot.joints.pop_back();
    robot.gravity_m_s2 = {0, 0, -9.81};
    std::mt19937_64 generator(test::test_seed());
    std::normal_distribution<double> noise(0, 0.003);
    const double inertia = 0.5;
    double q = 0;
    double dq = 0;
    log.q.conservativeResize(log.sample_count(), 1);
    log.dq = log.q;
    log.tau = log.q;
    log.dq_derived = {false};
    for (Index i = 0; i < log.sample_count(); ++i) {
      double tau = 0.5 * std::cos(1.3 * log.t_s[i]) - 0.05 * q;
      if (i >= 5100 && i < 5130) tau = level;
      log.q(i, 0) = q;
      log.dq(i, 0) = dq;
      log.tau(i, 0) = tau == 0 ? 0 : tau + noise(generator);
      dq += tau / inertia * log.period_s;
      q += dq * log.period_s;
    }
    EXPECT_EQ(breaks_in(examine(log, robot)), "") << level;
  }
}

TEST(DoctorOfRows, NamesATorqueThatIsCutOffMostOfTheTime) {
  Log log = jittered_arm();
  VectorXd sizes = log.tau.col(0).cwiseAbs();
  std::sort(sizes.begin(), sizes.end());
  const double limit = sizes[sizes.size() * 2 / 5];
  log.tau.col(0) = log.tau.col(0).cwiseMax(-limit).cwiseMin(limit);
  const auto faults = examine(log, test::arm_description());
  ASSERT_FALSE(faults.empty());
  EXPECT_EQ(faults[0].kind, DataFaultKind::kSaturation);
  EXPECT_EQ(faults[0].joint, 0);
  EXPECT_GT(faults[0].size, 0.5);
}

}  // namespace
}  // namespace offnominal::desk
