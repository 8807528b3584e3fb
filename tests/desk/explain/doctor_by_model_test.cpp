#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "explain/doctor.hpp"
#include "serial_arm.hpp"

// What a torque alone does not tell of a recording, and the model beside it does.

namespace offnominal::desk {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr Index kSecond = 1;

std::string all_words(const std::vector<DataFault>& faults) {
  std::string words;
  for (const DataFault& fault : faults) words += fault.words + "\n";
  return words;
}

const DataFault* fault_in(const std::vector<DataFault>& faults, DataFaultKind kind) {
  const auto found = std::find_if(faults.begin(), faults.end(), [kind](const DataFault& fault) {
    return fault.kind == kind && fault.joint == kSecond;
  });
  return found == faults.end() ? nullptr : &*found;
}

// Noise that changes the torque from one row to the next as much as the start does.
Log noisy_recording(const RobotDescription& robot) {
  return test::record(robot, {.duration_s = 12, .torque_noise_nm = 0.4, .seed = 5});
}

TEST(DoctorByModel, NamesATorqueThatComesUpFromNothing) {
  const RobotDescription robot = test::serial_arm(3);
  const Log whole = noisy_recording(robot);
  EXPECT_EQ(fault_in(examine(whole, robot), DataFaultKind::kStart), nullptr);
  Log log = whole;
  constexpr double kTimeConstantS = 0.04;
  for (Index i = 0; i < 50; ++i) {
    log.tau(i, kSecond) *= 1 - std::exp(-log.t_s[i] / kTimeConstantS);
  }
  const auto faults = examine(log, robot);
  const DataFault* start = fault_in(faults, DataFaultKind::kStart);
  ASSERT_NE(start, nullptr);
  EXPECT_EQ(start->signal, FaultySignal::kTorque);
  EXPECT_GT(start->spans.at(0).to_s, kTimeConstantS);
  EXPECT_LT(start->spans.at(0).to_s, 0.4);
}

// A joint that its controller holds against what the others do: a torque against each of its small
// motions, positions that stay for long and then move on by a step.
TEST(DoctorByModel, FindsNoFaultOfAJointThatIsHeld) {
  const RobotDescription robot = test::serial_arm(3);
  Log log = test::record(robot, {.duration_s = 20, .torque_noise_nm = 0.01, .seed = 3});
  constexpr double kCount = 0.002;
  constexpr double kWay = 0.006;
  for (Index i = 0; i < log.sample_count(); ++i) {
    const double t = log.t_s[i];
    const double slow = std::sin(0.9 * t) + 0.7 * std::sin(1.7 * t);
    log.q(i, kSecond) = kCount * std::round(kWay * std::clamp(1.6 * slow, -1.0, 1.0) / kCount);
    log.dq(i, kSecond) = kWay * (0.9 * std::cos(0.9 * t) + 1.2 * std::cos(1.7 * t));
    log.tau(i, kSecond) = -30 * log.dq(i, kSecond);
  }
  for (const DataFault& fault : examine(log, robot)) {
    EXPECT_NE(fault.joint, kSecond) << fault.words;
    EXPECT_FALSE(fault.joint < 0 && fault.certain) << fault.words;
  }
}

// An encoder that is dead from a moment on at which the joint had hardly moved.
TEST(DoctorByModel, FindsADeadEncoderWhoseVelocityGoesOn) {
  const RobotDescription robot = test::serial_arm(3);
  Log log = test::record(robot, {.duration_s = 20, .torque_noise_nm = 0.01, .seed = 3});
  const double start = log.q(0, kSecond);
  for (Index i = 0; i < log.sample_count(); ++i) {
    const double t = log.t_s[i];
    log.q(i, kSecond) = start + 0.02 * std::sin(5 * std::min(t, 1.0));
    log.dq(i, kSecond) = t < 1 ? 0.1 * std::cos(5 * t) : 0.8 * std::sin(0.7 * t);
  }
  log.dq_derived[kSecond] = false;
  EXPECT_NE(fault_in(examine(log, robot), DataFaultKind::kStuck), nullptr)
      << all_words(examine(log, robot));
}

// A torque of a few dozen steps, whose largest is held as long as it would be below its peak.
Log rounded_recording(const RobotDescription& robot, double cut_off) {
  Log log = test::record(robot, {.duration_s = 20, .torque_noise_nm = 0.01, .seed = 3});
  auto tau = log.tau.col(kSecond);
  const double step = tau.cwiseAbs().maxCoeff() / 30;
  const double limit = step * std::floor(cut_off * tau.maxCoeff() / step);
  tau = (step * (tau / step).array().round()).cwiseMin(limit).matrix().eval();
  return log;
}

TEST(DoctorByModel, NamesACoarseTorqueThatIsCutOff) {
  const RobotDescription robot = test::serial_arm(3);
  EXPECT_EQ(fault_in(examine(rounded_recording(robot, 2), robot), DataFaultKind::kSaturation),
            nullptr);
  const Log log = rounded_recording(robot, 0.6);
  const auto faults = examine(log, robot);
  const DataFault* limit = fault_in(faults, DataFaultKind::kSaturation);
  ASSERT_NE(limit, nullptr);
  const double most = log.tau.col(kSecond).maxCoeff();
  for (const FaultSpan& span : limit->spans) {
    EXPECT_EQ(log.tau(span.samples.first, kSecond), most);
  }
}

// A filter behind the steps ends each of them in values that are printed alike.
TEST(DoctorByModel, ExcusesACoarseTorqueBehindAFilter) {
  const RobotDescription robot = test::serial_arm(3);
  Log log = rounded_recording(robot, 2);
  auto tau = log.tau.col(kSecond);
  tau = (3 * tau / tau.cwiseAbs().maxCoeff()).array().round().matrix().eval();
  double filtered = tau[0];
  for (double& value : tau) {
    filtered += 0.4 * (value - filtered);
    value = 1e-4 * std::round(1e4 * filtered);
  }
  EXPECT_EQ(fault_in(examine(log, robot), DataFaultKind::kStaleSamples), nullptr);
}

// The drive only makes up for friction, and somebody's hand moves the mass: in degrees the arm
// would hardly have moved, and nearly all of the torque were friction's.
TEST(DoctorByModel, TakesNoHandThatMovesAnArmForDegrees) {
  RobotDescription robot = test::serial_arm(1);
  robot.effects.at(0).parameters[0] = 0;
  robot.joints[0].joint.mass_kg = 0.01;
  robot.joints[0].joint.inertia_kg_m2 = {1e-4, 1e-4, 1e-4, 0, 0, 0};
  const Log log = test::record(robot, {.duration_s = 20});
  ASSERT_LT(log.q.cwiseAbs().maxCoeff(), 2 * std::numbers::pi);
  robot.joints[0].joint.inertia_kg_m2 = {1, 1, 1, 0, 0, 0};
  for (const DataFault& fault : examine(log, robot)) {
    EXPECT_NE(fault.kind, DataFaultKind::kDegrees) << fault.words;
  }
}

// Some degrees to and fro are less than a turn in radians.
TEST(DoctorByModel, NamesDegreesOfASmallMotion) {
  const RobotDescription robot = test::serial_arm(3);
  Log log = test::record(robot, {.duration_s = 20});
  const double largest = log.q.cwiseAbs().maxCoeff();
  log.q *= 4 / largest;
  log.dq *= 4 / largest;
  for (Index joint = 0; joint < 3; ++joint) log.dq_derived[static_cast<std::size_t>(joint)] = true;
  // The torque of that motion in radians, slow enough to be gravity and friction.
  constexpr double kRadPerDegree = std::numbers::pi / 180;
  Motion motion;
  motion.t_s = log.t_s;
  motion.q = kRadPerDegree * log.q;
  motion.dq = kRadPerDegree * log.dq;
  motion.ddq = Eigen::MatrixXd::Zero(log.q.rows(), 3);
  const Index rows = log.q.rows();
  for (Index i = 1; i + 1 < rows; ++i) {
    motion.ddq.row(i) = (motion.dq.row(i + 1) - motion.dq.row(i - 1)) / (2 * log.period_s);
  }
  log.tau = model_torque(robot, motion);
  const auto faults = examine(log, robot);
  const bool named = std::any_of(faults.begin(), faults.end(), [](const DataFault& fault) {
    return fault.kind == DataFaultKind::kDegrees;
  });
  EXPECT_TRUE(named) << all_words(faults);
}

// It goes at one pace, then slowly: nothing settles.
TEST(DoctorByModel, TakesNoFastMotionBeforeASlowOneForAStart) {
  const RobotDescription robot = test::serial_arm(1);
  constexpr Index kRows = 4000;
  Motion motion;
  motion.t_s = VectorXd::LinSpaced(kRows, 0, 0.005 * (kRows - 1));
  motion.q = Eigen::MatrixXd::Zero(kRows, 1);
  motion.dq = motion.q;
  motion.ddq = motion.q;
  for (Index i = 0; i < kRows; ++i) {
    const double slow = 0.05 * std::sin(motion.t_s[i]);
    motion.dq(i, 0) = slow + 0.5 * (1 - std::tanh(5 * (motion.t_s[i] - 1.5)));
    motion.q(i, 0) = i > 0 ? motion.q(i - 1, 0) + 0.005 * motion.dq(i - 1, 0) : 0;
    if (i > 0) motion.ddq(i, 0) = (motion.dq(i, 0) - motion.dq(i - 1, 0)) / 0.005;
  }
  Log log;
  log.file = "fast, then slow";
  log.t_s = motion.t_s;
  log.period_s = 0.005;
  log.q = motion.q;
  log.dq = motion.dq;
  log.tau = model_torque(robot, motion);
  log.dq_derived = {true};
  EXPECT_EQ(all_words(examine(log, robot)), "");
}

// A joint that moves from one rest to another.
struct TwoRests {
  Log log;
  Index moves = 0;  // row in the middle of the motion
};
TwoRests two_rests(const RobotDescription& robot) {
  constexpr double kRate = 250;
  constexpr double kDuration = 12;
  const auto rows = static_cast<Index>(kRate * kDuration);
  Motion motion;
  motion.t_s = VectorXd::LinSpaced(rows, 0, kDuration - 1 / kRate);
  motion.q = Eigen::MatrixXd::Constant(rows, 2, 0.3);
  motion.dq = Eigen::MatrixXd::Zero(rows, 2);
  motion.ddq = motion.dq;
  // To and fro, then a rest, a move of 1 s at 6 s, a rest, and to and fro again.
  for (Index i = 0; i < rows; ++i) {
    const double t = motion.t_s[i];
    const double away = t < 4 ? 4 - t : t > 9 ? t - 9 : 0;
    const double pace = 2 * std::numbers::pi / 2;
    motion.q(i, kSecond) = 0.3 * (1 - std::cos(pace * away));
    motion.dq(i, kSecond) = (t < 4 ? -1 : 1) * 0.3 * pace * std::sin(pace * away);
    motion.ddq(i, kSecond) = away > 0 ? 0.3 * pace * pace * std::cos(pace * away) : 0;
    const double part = std::clamp(t - 6, 0.0, 1.0);
    const double angle = 2 * std::numbers::pi;
    motion.q(i, kSecond) += 0.9 * (part - std::sin(angle * part) / angle);
    if (part > 0 && part < 1) {
      motion.dq(i, kSecond) = 0.9 * (1 - std::cos(angle * part));
      motion.ddq(i, kSecond) = 0.9 * angle * std::sin(angle * part);
    }
  }
  TwoRests recorded;
  recorded.log.file = "two rests";
  recorded.log.t_s = motion.t_s;
  recorded.log.period_s = 1 / kRate;
  recorded.log.q = motion.q;
  recorded.log.dq = motion.dq;
  recorded.log.tau = model_torque(robot, motion);
  recorded.log.dq_derived = {true, true};
  recorded.moves = static_cast<Index>(6.5 * kRate);
  return recorded;
}

Log with_noise(Log log) {
  std::mt19937_64 generator(test::test_seed());
  std::normal_distribution<double> noise(0, 0.02);
  for (double& torque : log.tau.reshaped()) torque += noise(generator);
  return log;
}

// A position that sticks in one rest and goes on in the other looks like one that is counted from
// another zero there: the torque changed meanwhile, or it did not.
TEST(DoctorByModel, TellsAPositionThatSticksFromOneOfAnotherZero) {
  const RobotDescription robot = test::serial_arm(2);
  const TwoRests real = two_rests(robot);
  const Index first = real.moves - 250;
  const Index last = real.moves + 300;
  Log sticks = real.log;
  sticks.q.col(kSecond).segment(first, last - first).setConstant(sticks.q(first, kSecond));
  const auto faults = examine(with_noise(sticks), robot);
  EXPECT_NE(fault_in(faults, DataFaultKind::kStuck), nullptr) << all_words(faults);
  EXPECT_EQ(fault_in(faults, DataFaultKind::kJump), nullptr) << all_words(faults);

  Log moved = sticks;
  // The torque of a joint that rests all the while, and goes on as it did from there.
  for (Index i = first; i < moved.sample_count(); ++i) {
    const Index from = i < last ? first - 1 : i;
    if (i < last) moved.tau.row(i) = moved.tau.row(from);
  }
  moved.tau.bottomRows(moved.sample_count() - last) =
      moved.tau.row(first - 1).replicate(moved.sample_count() - last, 1);
  moved.q.col(kSecond).tail(moved.sample_count() - last).setConstant(real.log.q(last, kSecond));
  const auto others = examine(with_noise(moved), robot);
  EXPECT_EQ(fault_in(others, DataFaultKind::kStuck), nullptr) << all_words(others);
  EXPECT_NE(fault_in(others, DataFaultKind::kJump), nullptr) << all_words(others);
}

}  // namespace
}  // namespace offnominal::desk
