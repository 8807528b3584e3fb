// What a controller asks of a reference, and of arm and configuration before it commands torque.
#include <gtest/gtest.h>

#include <limits>
#include <offnominal/controller/arming_check.hpp>

#include "joint_on_desk.hpp"

namespace offnominal::test {
namespace {

using controller::Fault;
using hal::DriveMode;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinite = std::numeric_limits<double>::infinity();

using TwoJoints = controller::ControllerConfig<2, double>;

// Two joints of which both are asked: the second is the narrower one.
TwoJoints two_joints() {
  TwoJoints config;
  for (Joint<double>& joint : config.monitor.chain.joints) {
    joint.max_torque = 10;
    joint.max_velocity = 4;
  }
  config.gains.kp = {0.5, 0.25};
  config.gains.kd = {0.25, 0.5};
  config.arming.position_window = {0.5, 0.25};
  config.arming.speed = {0.25, 0.125};
  return config;
}

TEST(CheckReference, TakesWhatIsAtALimitAndNothingBeyond) {
  const TwoJoints config = two_joints();
  controller::PositionRange<2, double> range;
  range.lowest << -1, -2;
  range.highest << 1.5, 0.5;
  const auto judged = [&](double q0, double q1, double dq0, double dq1) {
    Reference<2, double> reference;
    reference.q << q0, q1;
    reference.dq << dq0, dq1;
    return check_reference(reference, config.monitor.chain, range);
  };
  EXPECT_EQ(judged(-1, -2, -4, -4), Fault::kNone);
  EXPECT_EQ(judged(1.5, 0.5, 4, 4), Fault::kNone);
  EXPECT_EQ(judged(-1.001, 0, 0, 0), Fault::kReferenceOutOfRange);
  EXPECT_EQ(judged(1.501, 0, 0, 0), Fault::kReferenceOutOfRange);
  EXPECT_EQ(judged(0, -2.001, 0, 0), Fault::kReferenceOutOfRange);
  EXPECT_EQ(judged(0, 0.501, 0, 0), Fault::kReferenceOutOfRange);
  EXPECT_EQ(judged(0, 0, -4.001, 0), Fault::kReferenceOutOfRange);
  EXPECT_EQ(judged(0, 0, 0, 4.001), Fault::kReferenceOutOfRange);
  EXPECT_EQ(judged(0, 0, 0, kNone), controller::fault_of(Status::kNonFiniteReference));
}

TEST(CheckArming, AsksEveryJointAndTakesWhatIsAtTheEdge) {
  const auto judged = [](auto&& change) {
    TwoJoints config = two_joints();
    JointSample<2, double> sample;
    Reference<2, double> reference;
    change(config, sample, reference);
    return check_arming(config, config.monitor.chain, sample, reference);
  };
  for (const int i : {0, 1}) {
    SCOPED_TRACE(i);
    const auto j = static_cast<std::size_t>(i);
    const double window = two_joints().arming.position_window[j];
    const double speed = two_joints().arming.speed[j];
    for (const double sign : {-1.0, 1.0}) {
      // Powers of two: what is at the edge is so to the last bit.
      const auto far = [&](double by) {
        return judged([&](auto&, auto& sample, auto& reference) {
          sample.q[i] = 1;
          reference.q[i] = 1 + sign * by;
        });
      };
      EXPECT_EQ(far(window), Fault::kNone);
      EXPECT_EQ(far(1.01 * window), Fault::kReferenceFarFromArm);
      const auto moving = [&](double by) {
        return judged([&](auto&, auto& sample, auto& reference) {
          sample.dq[i] = reference.dq[i] = sign * by;
        });
      };
      EXPECT_EQ(moving(speed), Fault::kNone);
      EXPECT_EQ(moving(1.01 * speed), Fault::kArmMoving);
      const auto apart = [&](double by) {
        return judged([&](auto&, auto&, auto& reference) { reference.dq[i] = sign * by; });
      };
      EXPECT_EQ(apart(speed), Fault::kNone);
      EXPECT_EQ(apart(1.01 * speed), Fault::kReferenceMoving);
    }
    const auto without = [&](auto member) {
      return judged([&](auto& config, auto&, auto&) { (config.gains.*member)[j] = 0; });
    };
    EXPECT_EQ(without(&ComputedTorqueGains<2, double>::kp), Fault::kNoGains);
    EXPECT_EQ(without(&ComputedTorqueGains<2, double>::kd), Fault::kNoGains);
    for (const double limit : {std::numeric_limits<double>::max(), kInfinite, kNone}) {
      EXPECT_EQ(judged([&](auto& config, auto&, auto&) {
                  config.monitor.chain.joints[j].max_torque = limit;
                }),
                Fault::kNoTorqueLimit);
    }
  }
}

// A number that is none, or that no joint can follow, never becomes a command.
TEST(ArmedController, AReferenceThatIsNoneIsAFaultBeforeAnyCommand) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInf = std::numeric_limits<float>::infinity();
  const auto non_finite = controller::fault_of(Status::kNonFiniteReference);
  struct Case {
    Reference<1, float> reference;
    Fault fault;
  };
  for (const Case& wrong :
       {Case{at(kNan), non_finite}, Case{at(0, kNan), non_finite}, Case{at(0, 0, kNan), non_finite},
        Case{at(-kInf), non_finite}, Case{at(0, kInf), non_finite},
        Case{at(1e30F), Fault::kReferenceOutOfRange}, Case{at(3.1F), Fault::kReferenceOutOfRange},
        Case{at(-3.1F), Fault::kReferenceOutOfRange},
        Case{at(0, 5.1F), Fault::kReferenceOutOfRange},
        Case{at(0, -5.1F), Fault::kReferenceOutOfRange},
        Case{at(0, 0, 3e38F), controller::fault_of(Status::kNumericOverflow)}}) {
    auto config = JointOnDesk::config();
    config.monitor.chain.joints[0].min_position = -3;
    config.monitor.chain.joints[0].max_position = 3;
    config.monitor.chain.joints[0].max_velocity = 5;
    config.safe_mode = DriveMode::kDamping;
    JointOnDesk joint(config);
    ASSERT_EQ(joint.start(), Fault::kNone);
    joint.ticks(100);
    ASSERT_EQ(joint.mode(), DriveMode::kTorque);
    joint.reference_at = [&](double) { return wrong.reference; };
    joint.tick();
    EXPECT_EQ(joint.data->fault, wrong.fault) << name_of(wrong.fault);
    EXPECT_EQ(joint.mode(), DriveMode::kDamping);
    EXPECT_EQ(joint.torque(), 0.0F);
    EXPECT_EQ(joint.drive.heartbeat.fault, static_cast<std::uint8_t>(wrong.fault));
    EXPECT_GE(joint.bus.dropped, 1);
  }
}

TEST(ArmedController, WithoutLimitsAReferenceStillHasToBePlausible) {
  JointOnDesk joint;
  ASSERT_EQ(joint.start(), Fault::kNone);
  joint.ticks(10);
  joint.reference_at = [](double) { return at(1001); };
  joint.tick();
  EXPECT_EQ(joint.data->fault, Fault::kReferenceOutOfRange);
}

}  // namespace
}  // namespace offnominal::test
