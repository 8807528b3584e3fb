#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "../compare/recorded_arm.hpp"
#include "common/error.hpp"
#include "compare/inverse_model.hpp"
#include "compare/motion.hpp"
#include "desk/support/temporary_folder.hpp"
#include "explain/doctor.hpp"
#include "hidden_case.hpp"
#include "log/csv_text.hpp"
#include "log/read_log.hpp"
#include "robot/channels.hpp"
#include "robot/robot_file.hpp"
#include "serial_arm.hpp"
#include "support/places.hpp"
#include "support/recordings.hpp"
#include "support/repetitions.hpp"

// What the doctor says of units, signs and folded positions, and that it says nothing else.

namespace offnominal::desk {
namespace {

namespace hidden = sim::hidden;
using Eigen::Index;
using testing::HasSubstr;

constexpr double kPi = std::numbers::pi;

std::string words_of(const std::vector<DataFault>& faults) {
  std::string words;
  for (const DataFault& fault : faults) words += fault.words + "\n";
  return words;
}

Log recorded(double rate_hz = 500) {
  return test::record_arm({.duration_s = 12, .rate_hz = rate_hz, .torque_noise = 0.05});
}

std::vector<DataFault> examined(const Log& log) { return examine(log, test::arm_description()); }

void fold(Log& log, Index joint, double range, double low) {
  for (Index i = 0; i < log.sample_count(); ++i) {
    double& q = log.q(i, joint);
    q -= range * std::floor((q - low) / range);
  }
}

// Two turns of joint 2, there and back, each sample of the torque as the model has it at q = 0.
Log turning() {
  Log log = recorded();
  for (Index i = 0; i < log.sample_count(); ++i) {
    const double angle = 2 * kPi * 0.1 * log.t_s[i];
    log.q(i, 1) = 6 * std::sin(angle);
    log.dq(i, 1) = 6 * 2 * kPi * 0.1 * std::cos(angle);
  }
  return log;
}

TEST(Doctor, NamesTimesThatAreNotInSeconds) {
  for (const bool with_velocity : {true, false}) {
    for (const double factor : {1e3, 1e6, 1e9}) {
      Log log = recorded();
      if (!with_velocity) log.dq_derived = {true, true};
      log.t_s *= factor;
      log.period_s *= factor;
      const auto faults = examined(log);
      ASSERT_EQ(faults.size(), 1U) << factor << words_of(faults);
      EXPECT_EQ(faults[0].kind, DataFaultKind::kTimeUnit);
      EXPECT_EQ(faults[0].size, factor);
      EXPECT_EQ(faults[0].joint, -1);
    }
  }
}

// 5 % beside rad/s and degrees; Excel counts days.
TEST(Doctor, NamesTimesInMinutesHoursAndDaysByTheVelocities) {
  for (const double seconds : {60.0, 3600.0, 86400.0}) {
    Log log = recorded();
    log.t_s /= seconds;
    log.period_s /= seconds;
    const auto faults = examined(log);
    ASSERT_EQ(faults.size(), 1U) << seconds << words_of(faults);
    EXPECT_EQ(faults[0].kind, DataFaultKind::kTimeUnit);
    EXPECT_DOUBLE_EQ(faults[0].size, 1 / seconds);
    EXPECT_EQ(faults[0].joint, -1);
  }
  // A velocity that is 5 % too small beside positions in degrees.
  Log degrees = recorded();
  degrees.q *= 180 / kPi;
  degrees.dq *= 180 / kPi / 60;
  EXPECT_THAT(words_of(examined(degrees)), HasSubstr("are in degrees"));
}

// 10 kHz in ms looks like 10 Hz, which a recording may have: only the velocity tells.
TEST(Doctor, TellsAFastRecordingInMillisecondsByItsVelocity) {
  Log log = recorded(10000);
  log.t_s *= 1e3;
  log.period_s *= 1e3;
  const auto faults = examined(log);
  ASSERT_EQ(faults.size(), 1U) << words_of(faults);
  EXPECT_EQ(faults[0].kind, DataFaultKind::kTimeUnit);
}

// A pendulum, swung as `angle` says, with torques that its model has but for noise.
RobotDescription pendulum(double limit) {
  RobotDescription robot = test::arm_description();
  robot.joints.resize(1);
  robot.effects.clear();
  robot.joints[0].joint.min_position = -limit;
  robot.joints[0].joint.max_position = limit;
  return robot;
}

// -1 to 1, without a pattern.
double noise(double seed, Index i) {
  return std::sin(1e3 * std::sin(seed * static_cast<double>(i)));
}

template <typename Angle>
Log swung(const RobotDescription& robot, double rate_hz, double duration_s, Angle angle) {
  const auto rows = static_cast<Index>(rate_hz * duration_s);
  Log log;
  log.period_s = 1 / rate_hz;
  log.t_s = Eigen::VectorXd::LinSpaced(rows, 0, static_cast<double>(rows - 1) / rate_hz);
  Motion motion{log.t_s, Eigen::MatrixXd(rows, 1), Eigen::MatrixXd(rows, 1),
                Eigen::MatrixXd(rows, 1)};
  constexpr double kStep = 1e-4;
  for (Index i = 0; i < rows; ++i) {
    const double t = log.t_s[i];
    motion.q(i, 0) = angle(t);
    motion.dq(i, 0) = (angle(t + kStep) - angle(t - kStep)) / (2 * kStep);
    motion.ddq(i, 0) = (angle(t + kStep) - 2 * angle(t) + angle(t - kStep)) / (kStep * kStep);
  }
  log.q = motion.q;
  log.dq = motion.dq;
  log.tau = model_torque(robot, motion);
  for (Index i = 0; i < rows; ++i) log.tau(i, 0) *= 1 + 0.01 * noise(1e3, i);
  log.dq_derived = {false};
  return log;
}

double slow_turns(double t) { return 1.5 * t + 2 * std::sin(1.1 * t); }

// GIVEN a joint that turns several times and a file whose limits are one turn
// THEN the torque, which fits in radians, is believed, folded or not.
TEST(Doctor, TakesTurnsBeyondTheLimitsForDegreesOnlyWhereTheTorqueDoes) {
  const RobotDescription robot = pendulum(kPi);
  Log log = swung(robot, 500, 30, slow_turns);
  EXPECT_EQ(words_of(examine(log, robot)), "");
  Log without = log;
  without.dq_derived = {true};
  EXPECT_EQ(words_of(examine(without, robot)), "");
  Log rubbing = log;  // a friction that the model does not have yet
  rubbing.tau +=
      log.tau.norm() / std::sqrt(static_cast<double>(log.tau.size())) * log.dq.cwiseSign();
  EXPECT_EQ(words_of(examine(rubbing, robot)), "");
  Log degrees = log;
  degrees.q *= 180 / kPi;
  degrees.dq *= 180 / kPi;
  EXPECT_THAT(words_of(examine(degrees, robot)), HasSubstr("are in degrees"));
  fold(log, 0, 2 * kPi, -kPi);
  const auto faults = examine(log, robot);
  ASSERT_EQ(faults.size(), 1U) << words_of(faults);
  EXPECT_EQ(faults[0].kind, DataFaultKind::kWrapped);
  log.tau *= 0.01;  // a torque that says nothing
  for (const DataFault& fault : examine(log, robot)) EXPECT_NE(fault.kind, DataFaultKind::kDegrees);
}

// GIVEN two samples in a second and no velocity, as of a quasi-static recording
// THEN the time is not taken for ms, and where the torque cannot tell nothing is refused.
TEST(Doctor, TakesASlowRecordingForOneInMillisecondsOnlyWhereTheTorqueDoes) {
  const RobotDescription robot = pendulum(10);
  Log log = swung(robot, 2, 2000,
                  [](double t) { return 1.5 * std::sin(0.01 * t) + 0.3 * std::sin(0.05 * t); });
  log.dq_derived = {true};
  EXPECT_EQ(words_of(examine(log, robot)), "");
  RobotDescription light = robot;
  light.joints[0].joint.mass_kg = 1e-9;
  const auto faults = examine(log, light);
  ASSERT_FALSE(faults.empty());
  EXPECT_THAT(faults[0].words, HasSubstr("the time may be in ms"));
  EXPECT_FALSE(spoils(faults[0], RestsOn::kTorque));
  EXPECT_FALSE(spoils(faults[0], RestsOn::kVelocityToo));
}

// 10 kHz in ms without velocities: a sample every 0.1 s, a thousand times the file's period.
TEST(Doctor, TellsAFastRecordingInMillisecondsByThePeriodOfTheFile) {
  RobotDescription robot = pendulum(10);
  robot.estimator.period_s = 1e-4;
  Log log =
      swung(robot, 10000, 5, [](double t) { return std::sin(2 * t) + 0.3 * std::sin(9 * t); });
  log.dq_derived = {true};
  EXPECT_EQ(words_of(examine(log, robot)), "");
  log.t_s *= 1e3;
  log.period_s *= 1e3;
  const auto faults = examine(log, robot);
  ASSERT_EQ(faults.size(), 1U) << words_of(faults);
  EXPECT_THAT(faults[0].words, HasSubstr("the time is in ms"));
  EXPECT_TRUE(spoils(faults[0], RestsOn::kTorque));
  // 10 Hz in s are as far from it, and are believed.
  Log slow = swung(robot, 10, 300, [](double t) { return std::sin(0.5 * t); });
  slow.dq_derived = {true};
  EXPECT_EQ(words_of(examine(slow, robot)), "");
}

// Each with its joint, and mended by the lines that are proposed.
TEST(Doctor, NamesAVelocityThatIsNotThatOfItsPosition) {
  const test::TemporaryFolder folder;
  const Log right = recorded();
  struct Case {
    const char* words;
    void (*make)(Log&);
    std::size_t faults;
  };
  for (const Case& one : {Case{"the velocity of joint 2 never changes, it is 0 throughout",
                               [](Log& log) { log.dq.col(1).setZero(); }, 1},
                          Case{"the velocity of joint 1 is not that of its position",
                               [](Log& log) { log.dq.col(0).swap(log.dq.col(1)); }, 2},
                          Case{"the velocity of joint 1 comes 0.3 s after",
                               [](Log& log) {
                                 const Eigen::VectorXd dq = log.dq.col(0);
                                 for (Index i = 0; i < dq.size(); ++i)
                                   log.dq(i, 0) = dq[std::max<Index>(0, i - 150)];
                               },
                               1},
                          Case{"the velocity of joint 1 has nothing in common",
                               [](Log& log) {
                                 for (Index i = 0; i < log.sample_count(); ++i) {
                                   log.dq(i, 0) = std::sin(1e3 * std::sin(static_cast<double>(i)));
                                 }
                               },
                               1}}) {
    SCOPED_TRACE(one.words);
    Log log = right;
    one.make(log);
    test::put(folder / "a.csv", csv_text(log));
    const auto faults = examined(read_log(folder / "a.csv", 2, std::nullopt));
    ASSERT_EQ(faults.size(), one.faults) << words_of(faults);
    EXPECT_EQ(faults[0].kind, DataFaultKind::kVelocity);
    EXPECT_THAT(faults[0].words, HasSubstr(one.words));
    EXPECT_FALSE(spoils(faults[0], RestsOn::kTorque));
    EXPECT_TRUE(spoils(faults[0], RestsOn::kVelocityToo));
    std::string channels;
    for (const std::string& line : faults.back().channels) channels += line + "\n";
    test::put(folder / "channels.toml", channels);
    const Log mended =
        read_log(folder / "a.csv", 2, read_channels_file(folder / "channels.toml", 2));
    EXPECT_EQ(words_of(examined(mended)), "");
  }
}

// Velocities as real drives give them: filtered, coarse, of the motor before a gear with play, at
// rest for most of the time, in a slow log or a short one.
TEST(Doctor, TakesNoHonestVelocityForAStranger) {
  const Log right = recorded();
  const auto expect_nothing = [](const char* what, const Log& log) {
    for (const DataFault& fault : examined(log)) {
      EXPECT_NE(fault.kind, DataFaultKind::kVelocity) << what << ": " << fault.words;
    }
  };
  Log log = right;
  for (Index i = 1; i < log.sample_count(); ++i) {  // a filter of 30 ms
    log.dq.row(i) = log.dq.row(i - 1) + (right.dq.row(i) - log.dq.row(i - 1)) * 0.002 / 0.03;
  }
  expect_nothing("filtered", log);
  log = right;
  log.dq = 0.24 * (log.dq / 0.24).array().round().matrix();
  expect_nothing("coarse", log);
  log = right;
  for (Index joint = 0; joint < 2; ++joint) {
    double link = log.q(0, joint);
    for (double& q : log.q.col(joint)) {
      link = std::clamp(link, q - 0.02, q + 0.02);
      q = link;
    }
  }
  expect_nothing("with play", log);
  log = right;
  log.q.bottomRows(5000).rowwise() = log.q.row(1000).eval();
  log.dq.bottomRows(5000).setZero();
  expect_nothing("mostly at rest", log);
  log = right;
  for (Index i = 0; i < log.sample_count(); ++i) {
    log.q.row(i) = right.q.row(0).array() + 1e-4 * noise(1.0, i);
    log.dq.row(i).setConstant(0.01 * noise(2.0, i));
  }
  expect_nothing("noise at rest", log);
  for (const double rate_hz : {10.0, 25.0}) expect_nothing("slow", recorded(rate_hz));
  log = right;
  for (const Index rows : {10, 30, 100, 300}) {
    log.t_s = right.t_s.head(rows);
    log.q = right.q.topRows(rows);
    log.dq = right.dq.topRows(rows);
    log.tau = right.tau.topRows(rows);
    expect_nothing("short", log);
  }
}

// A joint that stands or turns at the fold, with noise, in even samples and in uneven ones: it is
// unfolded as it is read, before a spline could swing beyond the fold.
TEST(Doctor, HasNothingAgainstPositionsThatRestAtAFoldOfOneTurn) {
  const test::TemporaryFolder folder;
  const RobotDescription robot = pendulum(10);
  for (const bool even : {true, false}) {
    Log log = swung(robot, 200, 20, [](double t) {
      return kPi + 0.2 * (1 - std::cos(std::clamp(t - 6, 0.0, 4 * kPi)));
    });
    const Eigen::MatrixXd whole = log.q;
    for (Index i = 0; i < log.sample_count(); ++i) {
      log.q(i, 0) += 1e-3 * noise(1.0, i);
      if (!even) log.t_s[i] += 1e-3 * noise(3.0, i);
    }
    fold(log, 0, 2 * kPi, -kPi);
    test::put(folder / "a.csv", csv_text(log));
    const Log read = read_log(folder / "a.csv", robot);
    EXPECT_NEAR(read.q.maxCoeff() - read.q.minCoeff(), whole.maxCoeff() - whole.minCoeff(), 0.02);
    EXPECT_THAT(read.remarks, testing::Contains(HasSubstr("unfolded"))) << even;
    const auto faults = examine(read, robot);
    EXPECT_TRUE(faults.empty()) << even << ": " << faults.front().words;
  }
}

// Set points within a turn, a sample each, from one to any other.
TEST(Doctor, TakesNoJumpsBetweenSetPointsForFolds) {
  const RobotDescription robot = pendulum(10);
  Log log = swung(robot, 1, 400, [](double t) { return 3.14 * std::sin(1e3 * std::sin(t)); });
  log.dq_derived = {true};
  for (const DataFault& fault : examine(log, robot)) {
    EXPECT_NE(fault.kind, DataFaultKind::kWrapped) << fault.words;
  }
}

TEST(Doctor, NamesTheUnitOfAVelocity) {
  struct Case {
    double per_si;
    const char* words;
  };
  for (const Case& one : {Case{180 / kPi, "is in deg/s"}, Case{30 / kPi, "is in rpm"},
                          Case{0.5 / kPi, "is in turns/s"}, Case{-1, "has the wrong sign"},
                          Case{0.02, "is not that of its position"}}) {
    Log log = recorded();
    log.dq.col(1) *= one.per_si;
    const auto faults = examined(log);
    ASSERT_EQ(faults.size(), 1U) << one.words << words_of(faults);
    EXPECT_EQ(faults[0].kind, DataFaultKind::kVelocity);
    EXPECT_EQ(faults[0].joint, 1);
    EXPECT_NEAR(faults[0].size / one.per_si, 1, 0.02);
    EXPECT_THAT(faults[0].words, HasSubstr(one.words));
    EXPECT_FALSE(spoils(faults[0], RestsOn::kTorque));
    EXPECT_TRUE(spoils(faults[0], RestsOn::kVelocityToo));
  }
}

TEST(Doctor, TellsDegreesByTheVelocityWhereNoTorqueDoes) {
  Log log = recorded();
  RobotDescription robot = test::arm_description();
  robot.gravity_m_s2 = {0, 0, 0};
  for (RobotJoint& joint : robot.joints) joint.joint.mass_kg = 1e-6;
  log.tau = log.dq;
  ASSERT_EQ(words_of(examine(log, robot)), "");
  log.q *= 180 / kPi;
  const auto faults = examine(log, robot);
  ASSERT_EQ(faults.size(), 1U) << words_of(faults);
  EXPECT_EQ(faults[0].kind, DataFaultKind::kDegrees);
  EXPECT_EQ(faults[0].joint, -1);
}

TEST(Doctor, NamesVelocitiesInDegreesWithTheirPositions) {
  Log log = recorded();
  log.q *= 180 / kPi;
  log.dq *= 180 / kPi;
  const auto faults = examined(log);
  ASSERT_EQ(faults.size(), 1U) << words_of(faults);
  EXPECT_EQ(faults[0].kind, DataFaultKind::kDegrees);
  EXPECT_THAT(faults[0].words, HasSubstr("so is the velocity of joint 2"));
}

TEST(Doctor, NamesPositionsThatAreFoldedIntoATurn) {
  struct Case {
    double range, low;
    const char* words;
  };
  for (const Case& one : {Case{2 * kPi, -kPi, "one turn, 2 pi"}, Case{2 * kPi, 0, "one turn, 2 pi"},
                          Case{4.096, 0, "its encoder's 2^12 counts"}, Case{5, -2, "5 rad"}}) {
    Log log = turning();
    fold(log, 1, one.range, one.low);
    RobotDescription robot = test::arm_description();
    robot.joints[1].encoder.counts_per_unit = 1000;
    std::vector<DataFault> found;
    for (const DataFault& fault : examine(log, robot)) {
      if (fault.kind == DataFaultKind::kWrapped) found.push_back(fault);
    }
    ASSERT_EQ(found.size(), 1U) << one.words;
    EXPECT_EQ(found[0].joint, 1);
    EXPECT_NEAR(found[0].size, one.range, 0.01 * one.range);
    EXPECT_THAT(found[0].words, HasSubstr(one.words));
    ASSERT_TRUE(found[0].at_s.has_value());
    const auto row = static_cast<Index>(std::llround(*found[0].at_s / log.period_s));
    double largest = 0;
    for (Index i = row - 2; i <= row + 2; ++i) {
      largest = std::max(largest, std::abs(log.q(i + 1, 1) - log.q(i, 1)));
    }
    EXPECT_GT(largest, 0.9 * one.range) << "no jump at the time that was named";
  }
}

TEST(Doctor, SeesThroughFoldedPositionsWhatElseIsWrong) {
  Log log =
      test::record_arm({.duration_s = 12, .rate_hz = 500, .torque_noise = 0.05, .amplitude = 2.5});
  ASSERT_GT(log.q.col(1).cwiseAbs().maxCoeff(), kPi + 0.1);
  fold(log, 1, 2 * kPi, -kPi);
  log.tau.col(0) *= -1;
  const auto faults = examined(log);
  ASSERT_EQ(faults.size(), 2U) << words_of(faults);
  EXPECT_EQ(faults[0].kind, DataFaultKind::kWrapped);
  EXPECT_EQ(faults[0].joint, 1);
  EXPECT_EQ(faults[1].kind, DataFaultKind::kTorqueSign);
  EXPECT_EQ(faults[1].joint, 0);
}

TEST(Doctor, NamesTheUnitFirstWhereAFoldIsOneOfDegrees) {
  Log log =
      test::record_arm({.duration_s = 12, .rate_hz = 500, .torque_noise = 0.05, .amplitude = 2.5});
  log.q *= 180 / kPi;
  log.dq *= 180 / kPi;
  fold(log, 1, 360, -180);
  for (const DataFault& fault : examined(log)) {
    if (fault.kind != DataFaultKind::kWrapped) continue;
    EXPECT_EQ(fault.mend.find("say unit = \"deg\""), 0U) << fault.mend;
    return;
  }
  ADD_FAILURE() << "no fold was found";
}

TEST(Doctor, TakesNoStepOrSpikeForAFoldedPosition) {
  Log log = recorded();
  log.q(3000, 0) += 2 * kPi;  // one sample, and back
  for (const DataFault& fault : examined(log)) EXPECT_NE(fault.kind, DataFaultKind::kWrapped);
  Log shifted = recorded();
  shifted.q.col(0).tail(3000).array() += 2 * kPi;  // set anew, up, whatever the pace
  shifted.q.col(0).tail(1000).array() -= 5;
  for (const DataFault& fault : examined(shifted)) EXPECT_NE(fault.kind, DataFaultKind::kWrapped);
}

// The lines that are proposed mend what was named: written to a file and read with it, nothing is
// left to name.
TEST(Doctor, ProposesChannelsThatMendTheFault) {
  const test::TemporaryFolder folder;
  struct Case {
    const char* name;
    double t, q, dq, tau;
  };
  for (const Case& one :
       {Case{"time", 1e3, 1, 1, 1}, Case{"degrees", 1, 180 / kPi, 1, 1},
        Case{"both in degrees", 1, 180 / kPi, 180 / kPi, 1}, Case{"velocity", 1, 1, 30 / kPi, 1},
        Case{"torque", 1, 1, 1, -1}, Case{"all", 1e3, 180 / kPi, 30 / kPi, -1}}) {
    SCOPED_TRACE(one.name);
    const Log log = recorded();
    std::ofstream csv(folder / "a.csv");
    csv.precision(12);
    csv << "t,q1,q2,dq1,dq2,tau1,tau2\n";
    for (Index i = 0; i < log.sample_count(); ++i) {
      csv << one.t * log.t_s[i];
      for (const double value :
           {one.q * log.q(i, 0), one.q * log.q(i, 1), one.dq * log.dq(i, 0), one.dq * log.dq(i, 1),
            one.tau * log.tau(i, 0), one.tau * log.tau(i, 1)}) {
        csv << ',' << value;
      }
      csv << '\n';
    }
    csv.close();
    const auto faults = examined(read_log(folder / "a.csv", 2, std::nullopt));
    ASSERT_FALSE(faults.empty());
    // Of several faults the last proposal holds all that was found before it.
    std::ofstream channels(folder / "channels.toml");
    for (const std::string& line : faults.back().channels) {
      channels << line << '\n';
      EXPECT_THAT(faults.back().mend, HasSubstr(line));
    }
    channels.close();
    const Log mended =
        read_log(folder / "a.csv", 2, read_channels_file(folder / "channels.toml", 2));
    EXPECT_EQ(words_of(examined(mended)), "");
    EXPECT_NEAR(mended.period_s, log.period_s, 1e-9);
    EXPECT_LT((mended.q - log.q).cwiseAbs().maxCoeff(), 1e-6);
    EXPECT_LT((mended.dq - log.dq).cwiseAbs().maxCoeff(), 1e-6);
    EXPECT_LT((mended.tau - log.tau).cwiseAbs().maxCoeff(), 1e-6);
  }
}

// Kinds of faults that are new words of one thing: a unit, a sign, a folded position.
bool is_of_units(const DataFault& fault) {
  return fault.kind == DataFaultKind::kTimeUnit || fault.kind == DataFaultKind::kVelocity ||
         fault.kind == DataFaultKind::kWrapped || fault.kind == DataFaultKind::kDegrees ||
         fault.kind == DataFaultKind::kTorqueSign;
}

TEST(Doctor, NamesNoUnitWrongInSimulatedRecordings) {
  for (int seed = 1; seed <= test::repetitions(6); ++seed) {
    hidden::Request request;
    request.seed = static_cast<std::uint64_t>(seed);
    request.encoder_bits = seed % 2 == 0 ? 12 : 19;
    request.torque_noise_share = 0.03;
    request.excitation = seed % 3 == 0 ? hidden::Excitation::kPoor : hidden::Excitation::kRich;
    const hidden::Case made = hidden::make_case(request);
    const Log log = test::to_log(made.recording);
    for (const DataFault& fault : examine(log, test::to_robot(made.nominal))) {
      EXPECT_FALSE(is_of_units(fault)) << "seed " << seed << ": " << fault.words;
    }
  }
}

// Two of the real recordings have gaps that no verb reads over; they are named as such.
std::optional<Log> read_if_whole(const std::filesystem::path& file, const RobotDescription& robot) {
  try {
    return read_log(file, robot);
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("a gap of"));
    EXPECT_THAT((std::vector<std::string>{"gravity_compensation.csv", "acc_current.txt"}),
                testing::Contains(file.filename().string()));
    return std::nullopt;
  }
}

struct Real {
  std::string folder, robot, channels;
};

TEST(Doctor, NamesNoUnitWrongInRealRecordings) {
  // Theirs has columns of its own; bam's robot file leaves the measured velocity out.
  const std::string bam =
      "time = \"t\"\nposition = [\"q1\"]\nvelocity = [\"dq1\"]\n"
      "torque = [{source = \"tau1\", scale = 0.1242, unit = \"V\"}]\n";
  const std::string dfki =
      "time = \"time\"\nposition = [\"position\"]\nvelocity = [\"velocity\"]\n"
      "torque = [\"torque\"]\n";
  const test::TemporaryFolder folder;
  int seen = 0;
  for (const Real& real :
       {Real{"emps", "emps.toml", ""}, Real{"bam_xl330/csv", "bam_xl330.toml", ""},
        Real{"bam_xl330/csv", "bam_xl330.toml", bam}, Real{"dfki_pendulum", "pendulum", dfki}}) {
    const auto recordings = test::recordings_dir() / real.folder;
    if (!std::filesystem::exists(recordings)) continue;
    RobotDescription robot;
    if (real.robot == "pendulum") {
      // SOURCE.txt: m g l = 3.3 N m, q = 0 hangs down.
      robot = read_robot_file(test::source_dir() / "robots" / "bam_xl330.toml");
      robot.effects.clear();
      robot.channels.reset();
      robot.joints[0].joint.mass_kg = 0.68;
      robot.joints[0].joint.centre_of_mass_m = {0, 0, -0.5};
      robot.joints[0].joint.min_position = -20;
      robot.joints[0].joint.max_position = 20;
      robot.joints[0].joint.max_torque = 12;
    } else {
      robot = read_robot_file(test::source_dir() / "robots" / real.robot);
    }
    if (!real.channels.empty()) {
      test::put(folder / "channels.toml", real.channels);
      robot.channels = read_channels_file(folder / "channels.toml", 1);
    }
    for (const auto& entry : std::filesystem::directory_iterator(recordings)) {
      const auto extension = entry.path().extension();
      if (extension != ".csv" && extension != ".mat") continue;
      const auto log = read_if_whole(entry.path(), robot);
      if (!log) continue;
      ++seen;
      for (const DataFault& fault : examine(*log, robot)) {
        EXPECT_FALSE(is_of_units(fault)) << entry.path() << ": " << fault.words;
      }
    }
  }
  if (seen == 0) GTEST_SKIP() << "no recordings in " << test::recordings_dir();
}

// A motor that turns on and on, 500 to 1000 times a second: its positions and velocities are right.
TEST(Doctor, NamesNoUnitWrongInRecordingsOfAFreeMotor) {
  const auto recordings = test::recordings_dir() / "laas_cogging";
  if (!std::filesystem::exists(recordings)) GTEST_SKIP() << "there is no " << recordings;
  RobotDescription robot = read_robot_file(test::source_dir() / "robots" / "mn4004.toml");
  const test::TemporaryFolder folder;
  for (const char* name : {"rolling_data1.txt", "rolling_data2.txt", "acc_current.txt"}) {
    test::put(folder / "channels.toml",
              "time = \"Time\"\nposition = [\"Position\"]\nvelocity = [\"Velocity\"]\n"
              "torque = [\"Iq\"]\n");
    robot.channels = read_channels_file(folder / "channels.toml", 1);
    const auto log = read_if_whole(recordings / name, robot);
    if (!log) continue;
    for (const DataFault& fault : examine(*log, robot)) {
      EXPECT_FALSE(is_of_units(fault)) << name << ": " << fault.words;
    }
  }
}

TEST(DoctorOfGravity, SaysWhichWayItPointsWhereTheFileHasItOtherwise) {
  const RobotDescription file = test::serial_arm(6);
  for (const std::array<double, 3> mounted : {std::array{0.0, 9.81, 0.0}, {-9.81, 0.0, 0.0}}) {
    RobotDescription robot = file;
    robot.gravity_m_s2 = mounted;
    const std::vector<DataFault> faults = examine(test::record(robot, {.duration_s = 12}), file);
    ASSERT_EQ(faults.size(), 1U) << words_of(faults);
    EXPECT_EQ(faults[0].kind, DataFaultKind::kGravity);
    EXPECT_TRUE(faults[0].certain);
    EXPECT_NEAR(faults[0].size, 90, 2);
    EXPECT_THAT(faults[0].mend, HasSubstr(mounted[1] > 0 ? "gravity_m_s2 = [0, 9.81, 0]"
                                                         : "gravity_m_s2 = [-9.81, 0, 0]"));
    EXPECT_TRUE(spoils(faults[0], RestsOn::kTorque));
  }
}

TEST(DoctorOfGravity, SaysSoOfATiltAndOfAFileWithoutAny) {
  const RobotDescription file = test::serial_arm(6);
  RobotDescription tilted = file;
  tilted.gravity_m_s2 = {0, 9.81 * std::sin(0.8), -9.81 * std::cos(0.8)};
  const Log log = test::record(tilted, {.duration_s = 12});
  const std::vector<DataFault> faults = examine(log, file);
  ASSERT_EQ(faults.size(), 1U) << words_of(faults);
  EXPECT_NEAR(faults[0].size, 0.8 * 180 / kPi, 2);
  EXPECT_THAT(faults[0].mend, HasSubstr("gravity_m_s2 = [0"));
  RobotDescription weightless = file;
  weightless.gravity_m_s2 = {0, 0, 0};
  const std::vector<DataFault> none = examine(test::record(file, {.duration_s = 12}), weightless);
  ASSERT_EQ(none.size(), 1U) << words_of(none);
  EXPECT_EQ(none[0].kind, DataFaultKind::kGravity);
  EXPECT_THAT(none[0].mend, HasSubstr("gravity_m_s2 = [0, 0, -9.81]"));
}

// A controller that carries gravity apart logs what is left.
TEST(DoctorOfGravity, SaysThatTheTorquesHaveNone) {
  const RobotDescription file = test::serial_arm(6);
  RobotDescription weightless = file;
  weightless.gravity_m_s2 = {0, 0, 0};
  const std::vector<DataFault> faults = examine(test::record(weightless, {.duration_s = 12}), file);
  ASSERT_EQ(faults.size(), 1U) << words_of(faults);
  EXPECT_EQ(faults[0].kind, DataFaultKind::kGravity);
  EXPECT_TRUE(faults[0].certain);
  EXPECT_THAT(faults[0].words, HasSubstr("the torques are without gravity"));
  EXPECT_THAT(faults[0].mend, HasSubstr("record the whole torque"));
}

// A spring carries one joint, or its drive's controller: it is nobody's fault for sure, and no
// other mounting of the arm.
TEST(DoctorOfGravity, SaysWhichJointsTorqueHasNone) {
  const RobotDescription file = test::serial_arm(6);
  RobotDescription weightless = file;
  weightless.gravity_m_s2 = {0, 0, 0};
  for (const Index joint : {1, 2}) {
    Log log = test::record(file, {.duration_s = 12});
    log.tau.col(joint) = test::record(weightless, {.duration_s = 12}).tau.col(joint);
    const std::vector<DataFault> faults = examine(log, file);
    ASSERT_EQ(faults.size(), 1U) << words_of(faults);
    EXPECT_EQ(faults[0].kind, DataFaultKind::kGravity);
    EXPECT_EQ(faults[0].joint, joint);
    EXPECT_FALSE(faults[0].certain);
    EXPECT_THAT(faults[0].words, HasSubstr("may be without gravity"));
    EXPECT_THAT(faults[0].mend, HasSubstr(fmt::format("position_torque --joint {}", joint + 1)));
  }
}

TEST(DoctorOfGravity, SaysNothingOfLinksThatAreOffOrOfWhatIsCarried) {
  const RobotDescription file = test::serial_arm(6);
  RobotDescription robot = file;
  for (RobotJoint& joint : robot.joints) {
    joint.joint.mass_kg *= 1.4;
    joint.joint.centre_of_mass_m[1] -= 0.04;
  }
  robot.joints.back().joint.mass_kg += 2;
  EXPECT_EQ(words_of(examine(test::record(robot, {.duration_s = 12}), file)), "");
}

}  // namespace
}  // namespace offnominal::desk
