// What becomes of two joints' feedback: samples of both or of none, turns, observed velocities.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <offnominal/controller/sample_taker.hpp>
#include <offnominal/hal/messages.hpp>

namespace offnominal::controller {
namespace {

constexpr double kHalf = hal::kCarriedRangeRad / 2;

class TwoJoints {
 public:
  using Taker = SampleTaker<2, double>;

  TwoJoints() {
    for (Joint<double>& joint : config.monitor.chain.joints) joint.type = JointType::kRevolute;
    config.most_position = 1000;
    for (hal::JointFeedback& joint : feedback) {
      joint.encoder = joint.drive = hal::SourceState::kValid;
      joint.reading.has_velocity = true;
    }
  }
  // A new reading of both.
  void read(double q0, double q1) {
    time_us_ += 1000;
    feedback[0].reading.position = static_cast<float>(q0);
    feedback[1].reading.position = static_cast<float>(q1);
    for (hal::JointFeedback& joint : feedback) joint.encoder_time_us = time_us_;
    look();
  }
  // A tick with the readings that are there.
  void look() {
    const Taker taker(config);
    taker.screen(feedback, data);
    taker.take(feedback, data);
  }
  [[nodiscard]] bool is_settled() const { return Taker(config).is_settled(data); }

  ControllerConfig<2, double> config;
  Taker::Feedback feedback;
  Taker::Data data;

 private:
  Microseconds time_us_ = 0;
};

TEST(SampleTaker, NothingIsImplausibleBeforeAnythingWasRead) {
  const TwoJoints joints;
  EXPECT_EQ(joints.data.implausible, Status::kOk);
  EXPECT_FALSE(joints.data.fresh);
}

TEST(SampleTaker, AJointAtItsLimitIsASampleAndOneBeyondIsNone) {
  for (const std::size_t j : {std::size_t{0}, std::size_t{1}}) {
    TwoJoints joints;
    joints.config.monitor.chain.joints[j].min_position = -0.5;
    joints.config.monitor.chain.joints[j].max_position = 0.75;
    const auto status_at = [&](double position) {
      joints.read(j == 0 ? position : 0, j == 1 ? position : 0);
      EXPECT_EQ(joints.data.fresh, joints.data.implausible == Status::kOk);
      return joints.data.implausible;
    };
    EXPECT_EQ(status_at(-0.5), Status::kOk);
    EXPECT_EQ(status_at(-0.501), Status::kPositionOutOfRange);
    EXPECT_EQ(status_at(0.75), Status::kOk);
    EXPECT_EQ(status_at(0.751), Status::kPositionOutOfRange);
    EXPECT_EQ(status_at(std::numeric_limits<double>::quiet_NaN()), Status::kNonFinitePosition);
  }
}

TEST(SampleTaker, CountsWhatCannotBeWithoutEverBeginningAnew) {
  TwoJoints joints;
  for (int i = 1; i <= 300; ++i) {
    joints.read(2000, 0);
    ASSERT_EQ(joints.data.implausible_in_a_row, std::min(i, 255)) << i;
  }
  joints.look();
  EXPECT_EQ(joints.data.implausible_in_a_row, 255) << "the same reading";
  joints.read(0, 0);
  EXPECT_EQ(joints.data.implausible_in_a_row, 0);
}

TEST(SampleTaker, CountsTheTurnsOfEveryJointWithoutAnyLimit) {
  TwoJoints joints;
  joints.read(kHalf - 0.1, -kHalf + 0.1);
  joints.read(-kHalf + 0.1, kHalf - 0.1);
  EXPECT_NEAR(joints.data.sample.q[0], kHalf + 0.1, 1e-5);
  EXPECT_NEAR(joints.data.sample.q[1], -kHalf - 0.1, 1e-5);
  joints.read(kHalf - 0.1, -kHalf + 0.1);
  EXPECT_NEAR(joints.data.sample.q[0], kHalf - 0.1, 1e-5);
  EXPECT_NEAR(joints.data.sample.q[1], -kHalf + 0.1, 1e-5);
}

// A joint with a limit on either side comes to no end of what is carried by turning.
TEST(SampleTaker, AJointWithOneLimitDoesNotTurnForEver) {
  TwoJoints joints;
  joints.config.monitor.chain.joints[0].max_position = 1000;
  joints.config.monitor.chain.joints[1].min_position = -1000;
  joints.read(kHalf - 0.1, kHalf - 0.1);
  joints.read(-kHalf + 0.1, -kHalf + 0.1);
  EXPECT_NEAR(joints.data.sample.q[0], -kHalf + 0.1, 1e-5);
  EXPECT_NEAR(joints.data.sample.q[1], -kHalf + 0.1, 1e-5);
}

// From one end of what is carried to the other: not from a place that is none of its ends.
TEST(SampleTaker, CountsATurnBetweenTheEndsAlone) {
  const auto counts = [](double from, double to) {
    TwoJoints joints;
    joints.read(0, from);
    joints.read(0, to);
    EXPECT_NEAR(joints.data.sample.q[0], 0, 1e-5);
    return joints.data.turns[1].tens;
  };
  EXPECT_EQ(counts(kHalf - 0.1, -kHalf / 2 - 0.1), 1);
  EXPECT_EQ(counts(-kHalf + 0.1, kHalf / 2 + 0.1), -1);
  EXPECT_EQ(counts(kHalf - 0.1, -kHalf / 2 + 0.1), 0);
  EXPECT_EQ(counts(kHalf / 2 - 0.1, -kHalf + 0.1), 0);
  EXPECT_EQ(counts(kHalf + 0.5, -kHalf + 0.1), 1) << "a little beyond, as sensors are";
  EXPECT_EQ(counts(kHalf + 1.5, -kHalf + 0.1), 0) << "was not carried so";
  EXPECT_EQ(counts(-kHalf - 1.5, kHalf - 0.1), 0);
  EXPECT_EQ(counts(-kHalf - 0.5, kHalf - 0.1), -1);
}

TEST(SampleTaker, IsSettledWhereEveryJointIs) {
  TwoJoints joints;
  joints.feedback[0].reading.has_velocity = false;
  joints.read(0, 0);
  EXPECT_FALSE(joints.is_settled()) << "the second one sends its velocity";
  for (int i = 0; i < 100; ++i) joints.read(0, 0);
  EXPECT_TRUE(joints.is_settled());
  joints.feedback[1].reading.has_velocity = false;
  joints.read(0, 0);
  EXPECT_TRUE(joints.is_settled()) << "the second one was observed beside the first";
  for (hal::JointFeedback& joint : joints.feedback) joint.reading.has_velocity = true;
  joints.read(0, 0);
  joints.feedback[1].reading.has_velocity = false;
  joints.read(0, 0);
  EXPECT_FALSE(joints.is_settled()) << "nothing was observed meanwhile";
}

// GIVEN a velocity that was observed WHEN one is sent meanwhile THEN what was observed before it is
// not gone on with.
TEST(SampleTaker, ObservesAnewAfterAVelocityThatWasSent) {
  TwoJoints joints;
  joints.feedback[1].reading.has_velocity = false;
  for (int i = 0; i < 100; ++i) joints.read(0, 0.002 * i);
  EXPECT_NEAR(joints.data.sample.dq[1], 2, 1e-3);
  joints.feedback[1].reading.has_velocity = true;
  joints.feedback[1].reading.velocity = -3;
  joints.read(0, 0.2);
  EXPECT_EQ(joints.data.sample.dq[1], -3);
  EXPECT_EQ(joints.data.motion[1].observer.updates, 0U);
  joints.feedback[1].reading.has_velocity = false;
  joints.read(0, 0.2);
  EXPECT_EQ(joints.data.sample.dq[1], 0);
  EXPECT_EQ(joints.data.motion[1].observer.updates, 1U);
}

// GIVEN two joints of which one sends no velocity WHEN they accelerate THEN what is judged is of
// one time for both, and what controls is what came last.
TEST(SampleTaker, JudgesAllJointsAtOneTimeWhereOneSendsNoVelocity) {
  constexpr double kAcceleration = 4;
  TwoJoints joints;
  joints.feedback[1].reading.has_velocity = false;
  double time_s = 0;
  for (int i = 0; i < 1000; ++i) {
    time_s = 0.001 * i;
    const double q = kAcceleration * time_s * time_s / 2;
    joints.feedback[0].reading.velocity = static_cast<float>(kAcceleration * time_s);
    for (hal::JointFeedback& joint : joints.feedback) {
      joint.status.applied_torque = static_cast<float>(10 * time_s);
    }
    joints.read(q, q);
  }
  const auto& judged = joints.data.judged();
  EXPECT_EQ(&judged, &joints.data.observed);
  const double late_s = 0.5 * 0.001 + 2 * std::exp(-0.2) / (1 - std::exp(-0.2)) * 0.001;
  for (Eigen::Index j = 0; j < 2; ++j) {
    EXPECT_NEAR(judged.dq[j], kAcceleration * (time_s - late_s), 1e-3);
    EXPECT_NEAR(judged.tau[j], 10 * (time_s - late_s), 1e-4);
    EXPECT_NEAR(judged.q[j], kAcceleration * (time_s - late_s) * (time_s - late_s) / 2, 2e-4);
    EXPECT_NEAR(joints.data.sample.tau[j], 10 * time_s, 1e-5);
    EXPECT_NEAR(joints.data.sample.q[j], kAcceleration * time_s * time_s / 2, 1e-6);
  }
  EXPECT_NEAR(joints.data.sample.dq[0], kAcceleration * time_s, 1e-6) << "as it was sent";
  joints.feedback[1].reading.has_velocity = true;
  joints.read(2, 2);
  EXPECT_EQ(&joints.data.judged(), &joints.data.sample);
}

// In float: a position that can be, and a velocity that is beyond the largest number.
TEST(SampleTaker, ObservesAnewFromWhatTheObserverCannotFollow) {
  ControllerConfig<1, float> config;
  config.monitor.chain.joints[0].type = JointType::kPrismatic;
  config.most_position = std::numeric_limits<float>::max();
  const SampleTaker<1, float> taker(config);
  SampleTaker<1, float>::Data data;
  SampleTaker<1, float>::Feedback feedback;
  feedback[0].encoder = hal::SourceState::kValid;
  for (const float position : {0.0F, 1e-3F, 2e38F}) {
    feedback[0].encoder_time_us += 1000;
    feedback[0].reading = {position, 0, false};
    taker.screen(feedback, data);
    taker.take(feedback, data);
    ASSERT_TRUE(data.fresh);
  }
  EXPECT_EQ(data.sample.dq[0], 0.0F);
  EXPECT_EQ(data.motion[0].observer.updates, 1U);
  EXPECT_EQ(data.motion[0].observer.position, 2e38F);
}

}  // namespace
}  // namespace offnominal::controller
