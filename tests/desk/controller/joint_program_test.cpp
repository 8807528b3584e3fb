// The controller program's loop with one joint at the other end of an in-process bus.
#include "loop/joint_program.hpp"

#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <offnominal/hal/bus/in_process_bus.hpp>
#include <optional>
#include <string>

#include "common/error.hpp"
#include "desk/sil/serial_robot.hpp"
#include "desk/support/temporary_folder.hpp"
#include "drives/drive_table.hpp"
#include "log/csv_log.hpp"
#include "robot/robot_file.hpp"
#include "support/places.hpp"

namespace offnominal::desk {
namespace {

using controller::Fault;
using hal::ControllerState;

// A point of 2 kg at the end of 1 m, which turns under gravity.
RobotDescription robot(const std::string& position, const std::string& arming) {
  return parse_robot(
      "format = 1\nname = \"pendulum\"\ngravity_m_s2 = [0.0, -9.81, 0.0]\n"
      "[[joint]]\nname = \"j\"\ntype = \"revolute\"\naxis = [0.0, 0.0, 1.0]\n"
      "[joint.link]\nmass_kg = 2.0\ncentre_of_mass_m = [1.0, 0.0, 0.0]\n"
      "[joint.limits]\nposition = " +
          position +
          "\nvelocity = 10.0\ntorque = 100.0\n"
          "[joint.control]\nkp_per_s2 = 100.0\nkd_per_s = 20.0\n"
          "[arming]\n" +
          arming + "[uncertainty_bound]\nkind = \"constant\"\nvalue = 20.0\n",
      "pendulum.toml");
}

class Pendulum final : public TickTimer {
 public:
  using Net = hal::InProcessNet<2>;

  Pendulum(Net& net, const DriveSettings& drives)
      : net_(net), port_(net.port(1)), drives_(emulated_drives(drives, {.joints = 1})) {}
  realtime::Tick wait() override {
    before_tick(++ticks);
    now_us_ += period_us();
    net_.set_time(now_us_);
    std::array<hal::ReceivedFrame, 4> come;
    const std::size_t count = port_.receive(come);
    for (std::size_t i = 0; i < count; ++i) drives_->take(come[i]);
    drives_->tick(now_us_);
    move();
    const std::array<std::optional<hal::EncoderReading>, 1> readings{
        hal::EncoderReading{static_cast<float>(q), static_cast<float>(dq), true}};
    std::array<hal::Frame, 4> frames;
    const std::size_t made =
        drives_->frames(readings, std::array{drives_->torque_nm(0, dq)}, frames);
    for (std::size_t i = 0; i < made; ++i) static_cast<void>(port_.send(frames[i], now_us_));
    return {now_us_, 0, 0};
  }
  [[nodiscard]] realtime::Microseconds period_us() const override { return 1000; }
  [[nodiscard]] bool gives_torque() const { return drives_->mode(0) == hal::DriveMode::kTorque; }

  std::function<void(int tick)> before_tick = [](int) {};
  int ticks = 0;
  double q = 0;
  double dq = 0;
  double lowest = 1e9;
  double push_nm = 0;  // beside the drive's torque

 private:
  // Its brake opens when it is first told to give torque.
  void move() {
    started_ = started_ || gives_torque();
    if (!started_) return;
    dq += 1e-3 * (drives_->torque_nm(0, dq) + push_nm - 2 * 9.81 * std::cos(q)) / 2;
    q += 1e-3 * dq;
    lowest = std::min(lowest, q);
  }

  Net& net_;
  Net::Port port_;
  std::unique_ptr<sim::Drives> drives_;
  hal::Microseconds now_us_ = 0;
  bool started_ = false;
};

struct Bench {
  explicit Bench(RobotDescription of, MotionAt wanted = {})
      : robot(std::move(of)), motion(std::move(wanted)) {}

  realtime::LoopReport run(const realtime::LoopConfig& loop) {
    const auto program = make_joint_program({.robot = robot,
                                             .settings = settings,
                                             .loop = loop,
                                             .wish = {.priority = 0, .lock_memory = false},
                                             .motion = motion,
                                             .bus = bus,
                                             .timer = pendulum,
                                             .recorder = recorder,
                                             .panel = panel});
    program->run();
    return program->report().loop;
  }

  RobotDescription robot;
  MotionAt motion;
  ControllerSettings settings;
  hal::InProcessNet<2> net;
  Pendulum pendulum{net, robot.drive_settings()};
  BusPortOf<hal::InProcessNet<2>::Port> bus{net.port(0)};
  realtime::Recorder recorder;
  realtime::LoopPanel panel;
};

// GIVEN joints that cannot be at 0, or whose limit is none that a frame can say, WHEN the program
// starts THEN it does not rehearse for ever: it comes to its first tick, and arms.
TEST(JointProgram, StartsWhereZeroIsOutsideOfTheLimits) {
  for (const char* limits :
       {"[0.1, 2.5]", "[-2.5, -0.1]", "[0.0, 2.0]", "[1.0, 40.0]", "[-40.0, 40.0]"}) {
    Bench bench(robot(limits, ""));
    bench.pendulum.q = std::string(limits) == "[-2.5, -0.1]" ? -1.2 : 1.2;
    const auto report = bench.run({.arm_when_passive = true, .duration_us = 200'000});
    EXPECT_EQ(report.refusal, Fault::kNone) << limits;
    EXPECT_EQ(report.fault, Fault::kNone) << limits << ' ' << name_of(report.fault);
    EXPECT_EQ(report.state, ControllerState::kArmed) << limits;
  }
}

// GIVEN a file whose drive is an ODrive WHEN the program runs THEN it arms over that protocol, and
// holds the arm, in either firmware.
TEST(JointProgram, SpeaksToTheDrivesOfTheFile) {
  for (const char* firmware : {"0.5", "0.6"}) {
    RobotDescription of = robot("[-3.0, 3.0]", "torque_rate = [500.0]\n");
    const std::string text = robot_text(of) +
                             "[drives]\nprotocol = \"can_simple\"\nnode = [7]\n"
                             "joint_per_turn = [-0.5]\nfirmware = \"" +
                             firmware + "\"\n";
    Bench bench(parse_robot(text, "odrive.toml"));
    const auto report = bench.run({.arm_when_passive = true, .duration_us = 2'000'000});
    EXPECT_EQ(report.fault, Fault::kNone) << firmware << ' ' << name_of(report.fault);
    EXPECT_EQ(report.state, ControllerState::kArmed) << firmware;
    EXPECT_LT(bench.pendulum.lowest, -0.003) << "it did sink";
    EXPECT_NEAR(bench.pendulum.q, 0, 5e-3) << firmware;
  }
}

TEST(JointProgram, SaysThatNoFrameCanTellWhereAJointIs) {
  Bench bench(robot("[40.0, 50.0]", ""));
  EXPECT_THROW(bench.run({.duration_us = 200'000}), InputError);
  EXPECT_EQ(bench.pendulum.ticks, 0);
}

// GIVEN an arm that sinks until its weight is taken over WHEN it is to be held THEN it comes back
// to where it was armed.
TEST(JointProgram, HoldsTheArmWhereItWasArmed) {
  Bench bench(robot("[-3.0, 3.0]", "torque_rate = [500.0]\n"));
  const auto report = bench.run({.arm_when_passive = true, .duration_us = 3'000'000});
  EXPECT_EQ(report.state, ControllerState::kArmed);
  EXPECT_EQ(report.fault, Fault::kNone) << name_of(report.fault);
  EXPECT_LT(bench.pendulum.lowest, -0.003) << "it did sink";
  // The farewell lets it fall for some ticks.
  EXPECT_NEAR(bench.pendulum.q, 0, 1e-3);
}

// GIVEN a motion that begins on the move WHEN the arm is at rest THEN it is refused as one: its
// first row counts, not that before it there is none.
TEST(JointProgram, AMotionThatBeginsOnTheMoveIsOne) {
  const test::TemporaryFolder folder;
  const std::string file = (folder / "motion.csv").string();
  std::string rows = "t,q1,dq1,ddq1\n";
  for (int i = 0; i < 100; ++i) {
    const double t = 0.01 * i;
    rows += std::to_string(t) + ',' + std::to_string(0.5 * t) + ",0.5,0\n";
  }
  test::put(file, rows);
  const MotionAt motion =
      motion_of(std::make_shared<paper::RecordedMotion>(paper::RecordedMotion::read(file, 1)));
  Bench resting(robot("[-3.0, 3.0]", ""), motion);
  resting.pendulum.before_tick = [&](int tick) { resting.panel.end.store(tick > 200); };
  const auto refused = resting.run({.arm_when_passive = true});
  EXPECT_EQ(refused.refusal, Fault::kReferenceMoving);
  EXPECT_FALSE(resting.pendulum.gives_torque());
  Bench allowed(robot("[-3.0, 3.0]", "speed = [0.6]\n"), motion);
  const auto report = allowed.run({.arm_when_passive = true, .duration_us = 100'000});
  EXPECT_EQ(report.refusal, Fault::kNone);
}

// GIVEN a file in torque space WHEN somebody pushes the joint THEN report and recording name it.
TEST(JointProgram, InTorqueSpaceSaysAndRecordsWhichJointWasFirst) {
  RobotDescription of = robot("[-3.0, 3.0]", "");
  of.estimator.space = EstimatorSpace::kTorque;
  of.bound->kind = BoundSettings::Kind::kPerJoint;
  of.bound->joints = {{.at = {}, .value = {5.0}}};
  const test::TemporaryFolder folder;
  for (const double push_nm : {0.0, 20.0}) {
    const std::string file = (folder / (push_nm > 0 ? "pushed.csv" : "healthy.csv")).string();
    Bench bench(of);
    bench.settings.accommodate = true;
    ASSERT_EQ(bench.recorder.open({.csv = file, .columns = realtime::loop_columns(1, true)}), 0);
    bench.pendulum.before_tick = [&](int tick) {
      if (tick > 3000) bench.pendulum.push_nm = push_nm;
    };
    const auto report = bench.run({.arm_when_passive = true, .duration_us = 4'000'000});
    bench.recorder.close();
    EXPECT_EQ(report.fault, Fault::kNone) << name_of(report.fault);
    EXPECT_EQ(report.detected, push_nm > 0);
    EXPECT_EQ(report.first_joint, push_nm > 0 ? 0 : -1);
    auto columns = read_csv(file, [](const std::string&) { return Need::kRequired; }).columns;
    EXPECT_EQ(columns.at("first_joint").maxCoeff(), push_nm > 0 ? 1 : 0);
    EXPECT_NEAR(columns.at("threshold1").maxCoeff(), 5, 1e-3);
    const double residual = columns.at("error1").cwiseAbs().maxCoeff();
    EXPECT_NEAR(residual, push_nm, push_nm > 0 ? 3 : 1);
    const Eigen::VectorXd compensation = columns.at("compensation1").cwiseAbs();
    EXPECT_EQ(compensation.head(2000).maxCoeff(), 0) << "nothing was wrong yet";
    EXPECT_EQ(compensation.maxCoeff() > 0, push_nm > 0);
  }
}

// GIVEN two levels WHEN the second is reached THEN report and recording say when, whose and what
// was done.
TEST(JointProgram, SaysAndRecordsWhenItActsAndThatItSlows) {
  RobotDescription of = robot("[-3.0, 3.0]", "");
  of.estimator.space = EstimatorSpace::kTorque;
  of.estimator.learning_rate = 0;
  of.bound->kind = BoundSettings::Kind::kPerJoint;
  of.bound->joints = {{.at = {}, .value = {5.0}, .act_ratio = 2}};
  const test::TemporaryFolder folder;
  const std::string file = (folder / "run.csv").string();
  for (const double push_nm : {8.0, 20.0}) {
    const bool acts = push_nm > 10;
    Bench bench(of);
    bench.settings.at_detection = controller::AtDetection::kSlow;
    bench.settings.slow_down = {0.5, 0.2};
    ASSERT_EQ(bench.recorder.open(
                  {.csv = file, .columns = realtime::loop_columns(1, true), .replace = true}),
              0);
    bench.pendulum.before_tick = [&](int tick) {
      if (tick > 3000) bench.pendulum.push_nm = push_nm;
    };
    const auto report = bench.run({.arm_when_passive = true, .duration_us = 4'000'000});
    bench.recorder.close();
    EXPECT_TRUE(report.detected);
    EXPECT_EQ(report.acts, acts);
    EXPECT_EQ(report.slowed, acts);
    EXPECT_EQ(report.act_joint, acts ? 0 : -1);
    auto columns = read_csv(file, [](const std::string&) { return Need::kRequired; }).columns;
    EXPECT_EQ(columns.at("acts").maxCoeff(), acts ? 1 : 0);
    EXPECT_EQ(columns.at("slows").maxCoeff(), acts ? 1 : 0);
    if (!acts) {
      EXPECT_EQ(columns.at("behind").maxCoeff(), 0);
      continue;
    }
    EXPECT_GT(report.act_time_s, report.detection_time_s);
    EXPECT_EQ(report.slow_time_s, report.act_time_s);
    EXPECT_EQ(report.slow_down.to, 0.5);
    // Of the last row: rows in between may be lost where nobody waits for the disk.
    const double behind_s = columns.at("behind").maxCoeff();
    const double run_s = columns.at("motion_t").maxCoeff() + behind_s;
    EXPECT_GT(behind_s, 0.2);
    EXPECT_NEAR(behind_s, 0.5 * (run_s - report.slow_time_s - 0.1), 0.002);
  }
}

// A number of joints that is not compiled in would be known by its first robot.
TEST(JointProgram, IsThereForEveryNumberOfJoints) {
  for (int joints = 1; joints <= kMaxJoints; ++joints) {
    Bench bench(test::serial_robot(joints));
    bench.panel.end.store(true);
    const auto report = bench.run({});
    EXPECT_GT(report.ticks, 0U) << joints;
    EXPECT_EQ(report.state, ControllerState::kInit) << "nobody speaks for all of them";
  }
}

// In fewer than ten periods a ramp is a jump.
TEST(JointProgram, ARampThatIsNoneIsRefusedInWords) {
  Bench bench(robot("[-3.0, 3.0]", "ramp_s = 0.005\n"));
  try {
    static_cast<void>(bench.run({.duration_us = 1000}));
    FAIL() << "taken";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("arming.ramp_s: found 0.005 s"), std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace offnominal::desk
