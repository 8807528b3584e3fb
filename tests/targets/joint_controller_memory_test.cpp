// A slide that stands on its drive against gravity, behind a drive that is late, or with friction
// that remembers: arming must not look like a fault.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "joint_on_desk.hpp"
#include "scripted_joints.hpp"

namespace offnominal::controller {
namespace {

using test::OneDrive;
using test::SilentBus;

constexpr double kMass = 2;
constexpr double kWidth = 0.001;

class Slide {
 public:
  using Watched = JointController<1, 4, double, WithMemory>;

  Slide(std::size_t late_ticks, double friction, double gravity)
      : late_ticks_(late_ticks), friction_(friction), gravity_(gravity) {
    MonitorConfig<1, double> config;
    config.chain.gravity_m_s2 = {0, 0, -gravity};
    config.chain.joints[0].type = JointType::kPrismatic;
    config.chain.joints[0].mass_kg = kMass;
    config.chain.joints[0].max_torque = 1000;
    config.torque_signal = TorqueSignal::kHeld;
    config.estimator.hidden_units = 4;
    config.estimator.learning_rate = 0;
    config.bound.scale = 1;
    config.bound.offset = 0.1;
    config.bound.velocity_error = 0.003;
    period_s_ = config.estimator.period_s;
    const double delay_s = static_cast<double>(late_ticks) * period_s_;
    EXPECT_TRUE(config.chain.effects.add({EffectKind::kTimeDelay, 0, {delay_s}}));
    EXPECT_TRUE(config.chain.effects.add({EffectKind::kHysteresis, 0, {friction, kWidth}}));
    ComputedTorqueGains<1, double> gains;
    gains.kp.fill(100);
    gains.kd.fill(20);
    ControllerConfig<1, double> whole = controller_config(config, gains);
    whole.watch_when_passive = true;
    EXPECT_EQ(Watched::create(whole, controller_), Status::kOk);
  }

  void tick() {
    bus_.time_us += static_cast<hal::Microseconds>(period_s_ * 1e6 + 0.5);
    drive_.joint.encoder = drive_.joint.drive = hal::SourceState::kValid;
    drive_.joint.encoder_time_us = bus_.time_us;
    drive_.joint.reading = {static_cast<float>(q_), static_cast<float>(dq_), true};
    drive_.joint.status.mode = hal::DriveMode::kTorque;
    drive_.joint.status.applied_torque = static_cast<float>(told_.back());
    controller_.step(bus_.time_us, 0, at_origin, bus_, drive_, *data_);
    told_.push_back(drive_.command.mode == hal::DriveMode::kTorque
                        ? static_cast<double>(drive_.command.torque)
                        : 0.0);
    move();
  }
  bool arm() {
    dq_ = 0;
    tick();
    armed_ = controller_.arm(at_origin, *data_) == Fault::kNone;
    return armed_;
  }
  // What pulls at the slide beside its drive, N.
  void pull(double force) { pull_ = force; }
  // Until it is armed a hand pushes the slide along at this speed, or holds it.
  void push(double speed) { dq_ = speed; }

  [[nodiscard]] const Watched::Data& data() const { return *data_; }
  [[nodiscard]] double told() const { return told_.back(); }

 private:
  static Reference<1, double> at_origin(double /*time_s*/) { return {}; }
  void move() {
    const double acts = told_[told_.size() - 1 - late_ticks_];
    constexpr int kSteps = 50;
    const double h = period_s_ / kSteps;
    for (int i = 0; i < kSteps; ++i) {
      q_ += h * dq_;
      if (armed_) dq_ += h * ((acts + pull_ - friction_ * z_) / kMass - gravity_);
      z_ += h * (dq_ - z_ * std::fabs(dq_)) / kWidth;
    }
  }

  std::size_t late_ticks_;
  double friction_;
  double gravity_;
  double pull_ = 0;
  double period_s_ = 0;
  bool armed_ = false;
  double q_ = 0, dq_ = 0, z_ = 0;
  std::vector<double> told_ = std::vector<double>(100, 0.0);
  SilentBus bus_;
  OneDrive drive_;
  Watched controller_;
  std::unique_ptr<Watched::Data> data_ = std::make_unique<Watched::Data>();
};

TEST(ControllerWithMemory, ArmingALateDriveIsNoFault) {
  Slide slide(6, 0, 9.81);
  for (int i = 0; i < 20; ++i) slide.tick();
  ASSERT_TRUE(slide.arm());
  double worst = 0;
  for (int i = 0; i < 300; ++i) {
    slide.tick();
    const auto& output = slide.data().output;
    if (output.threshold > 0) worst = std::max(worst, output.error_norm / output.threshold);
  }
  EXPECT_EQ(slide.data().fault, Fault::kNone);
  EXPECT_FALSE(slide.data().output.detector.latched);
  EXPECT_LT(worst, 0.5);
}

TEST(ControllerWithMemory, WhatAnotherRunRememberedIsNotInTheFirstTorque) {
  Slide slide(0, 20, 0);
  slide.push(0.05);
  for (int i = 0; i < 100; ++i) slide.tick();
  ASSERT_GT(slide.data().monitor.memory.remembered[0], 15) << "watched while it was passive";
  ASSERT_TRUE(slide.arm());
  slide.tick();
  EXPECT_EQ(slide.data().monitor.memory.remembered[0], 0);
  EXPECT_NEAR(slide.data().sample.tau[0], slide.told(), 1e-6);
}

// GIVEN a slide with friction that remembers, pulled away from where it is to be WHEN it is held
// there THEN what the model remembers is in the torque, with its sign.
TEST(ControllerWithMemory, WhatTheModelRemembersIsInTheTorque) {
  Slide slide(0, 20, 0);
  for (int i = 0; i < 5; ++i) slide.tick();
  ASSERT_TRUE(slide.arm());
  for (int i = 0; i < 1200; ++i) slide.tick();
  slide.pull(30);
  for (int i = 0; i < 100; ++i) slide.tick();
  const auto& data = slide.data();
  ASSERT_EQ(data.fault, Fault::kNone);
  const double remembered = data.monitor.memory.remembered[0];
  ASSERT_GT(remembered, 5);
  const double computed = kMass * (-20 * data.sample.dq[0] - 100 * data.sample.q[0]);
  EXPECT_NEAR(slide.told(), computed + remembered, 1e-4);
}

// The first sample that is watched has the torque that is commanded in it, and behind a drive that
// is late the one that the drive still gives.
TEST(ControllerWithMemory, TheFirstSampleHasTheTorqueThatActs) {
  const double weight = 9.81 * kMass;
  for (const std::size_t late_ticks : {std::size_t{0}, std::size_t{6}}) {
    Slide slide(late_ticks, 20, 9.81);
    for (int i = 0; i < 5; ++i) slide.tick();
    ASSERT_TRUE(slide.arm());
    slide.tick();
    EXPECT_NEAR(slide.told(), weight, 1e-4);
    EXPECT_NEAR(slide.data().sample.tau[0], late_ticks == 0 ? weight : 0, 1e-4);
  }
}

TEST(ControllerWithMemory, SoDoesEveryJointOfIt) {
  using Watched = JointController<2, 4, double, WithMemory>;
  auto config = test::ScriptedJoints::default_config();
  config.monitor.chain.gravity_m_s2 = {-2, -3, 0};
  for (auto& joint : config.monitor.chain.joints) joint.max_torque = 100;
  config.arming.torque_rate.fill(1e5);
  Watched controller;
  ASSERT_EQ(Watched::create(config, controller), Status::kOk);
  const auto data = std::make_unique<Watched::Data>();
  test::ScriptedBus bus;
  test::ScriptedDrives<2> drives;
  const auto at_origin = [](double) { return Reference<2, double>{}; };
  const auto tick = [&] {
    bus.time_us += 1000;
    for (hal::JointFeedback& joint : drives.joints) {
      joint.encoder = joint.drive = hal::SourceState::kValid;
      joint.reading.has_velocity = true;
      joint.encoder_time_us = bus.time_us;
    }
    controller.step(bus.time_us, 0, at_origin, bus, drives, *data);
  };
  tick();
  ASSERT_EQ(controller.arm(at_origin, *data), Fault::kNone);
  tick();
  EXPECT_NEAR(data->sample.tau[0], 2 * test::ScriptedJoints::kMass[0], 1e-9);
  EXPECT_NEAR(data->sample.tau[1], 3 * test::ScriptedJoints::kMass[1], 1e-9);
}

}  // namespace
}  // namespace offnominal::controller
