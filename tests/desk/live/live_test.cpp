#include "live/live.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>
#include <utility>

#include "common/error.hpp"
#include "common/refused.hpp"
#include "desk/sil/serial_robot.hpp"
#include "desk/support/temporary_folder.hpp"
#include "exchange/export_robot.hpp"
#include "live/controller_words.hpp"
#include "live/live_json.hpp"
#include "log/read_log.hpp"
#include "replay/replay.hpp"
#include "sil/both_ends.hpp"

namespace offnominal::desk::live {
namespace {

using test::TemporaryFolder;
using testing::HasSubstr;

constexpr double kBoundNm = 0.5;

// A run that is simulated as fast as it goes, on a bus that is listened to.
class RunAsBus final : public Feed {
 public:
  RunAsBus(const RobotDescription& robot, std::vector<sim::FaultEvent> faults, double duration_s)
      : robot_(robot), ticks_(static_cast<int>(duration_s / robot.estimator.period_s)) {
    scenario_.plant = robot;
    scenario_.faults = std::move(faults);
    ends_ = std::make_unique<sil::BothEnds>(
        robot_, scenario_, *wire_, [this](const hal::Frame& frame, hal::Microseconds time_us) {
          if (on_frame_ != nullptr) (*on_frame_)({frame, time_us});
        });
    ends_->start();
  }
  void take(const OnFrame& on_frame) override {
    on_frame_ = &on_frame;
    for (int i = 0; i < 20 && ticks_ > 0; ++i, --ticks_) ends_->tick();
    on_frame_ = nullptr;
    if (ticks_ == 0) std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  [[nodiscard]] hal::Microseconds now_us() const override { return ends_->now_us(); }
  [[nodiscard]] std::string ended() const override { return ticks_ > 0 ? "" : "The run is over."; }

 private:
  RobotDescription robot_;
  sil::Scenario scenario_;
  std::unique_ptr<sil::Wire> wire_ = sil::make_in_process_wire();
  std::unique_ptr<sil::BothEnds> ends_;
  const OnFrame* on_frame_ = nullptr;
  int ticks_;
};

LiveInput input_of(const RobotDescription& robot, const std::filesystem::path& folder) {
  LiveInput input;
  input.robot = robot;
  input.robot_file = "arm.toml";
  input.scenario.plant = robot;
  input.folder = folder;
  return input;
}

LiveInput bus_input_of(const RobotDescription& robot, const std::filesystem::path& folder) {
  LiveInput input = input_of(robot, folder);
  input.bus = "made up";
  return input;
}

// No time is asserted: what does not come about in a minute does not come about.
Moment wait_for(const Live& live, const std::function<bool(const Moment&)>& is_there) {
  Moment moment;
  for (int i = 0; i < 6000; ++i) {
    moment = live.moment(0);
    if (is_there(moment)) return moment;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  ADD_FAILURE() << "did not come about: " << moment.words << moment.ended;
  return moment;
}

bool is_frozen(const Moment& moment) { return moment.detection && moment.detection->frozen; }
bool is_over(const Moment& moment) { return !moment.ended.empty(); }

sim::FaultEvent push_on(int joint, double begin_s) {
  return {.kind = sim::FaultEventKind::kDisturbanceTorque,
          .begin_s = begin_s,
          .joint = joint,
          .size = 4 * kBoundNm};
}

TEST(Live, SaysOfABusWhatReplaySaysOfItsRecording) {
  const TemporaryFolder folder;
  const RobotDescription robot = test::by_joint_robot(3, kBoundNm);
  Live live(bus_input_of(robot, folder.path()),
            std::make_unique<RunAsBus>(robot, std::vector{push_on(1, 7.0)}, 10.0));
  live.start_recording();
  const Moment end = wait_for(live, is_over);
  ASSERT_TRUE(end.detection.has_value());
  EXPECT_EQ(end.detection->joint, 1);
  ASSERT_TRUE(end.detection->answer.has_value());

  const Log log = read_log(live.stop_recording(), 3, std::nullopt);
  const Replay replayed = replay(robot, log);
  ASSERT_TRUE(replayed.detection_time_s.has_value());
  EXPECT_NEAR(*replayed.detection_time_s, end.detection->t_s, 1e-9);
  ASSERT_EQ(replayed.faults.size(), 1U);
  EXPECT_EQ(replayed.faults[0].kind, end.detection->answer->kind);
  EXPECT_NEAR(replayed.faults[0].size, end.detection->answer->size, 1e-6);
  EXPECT_NEAR(std::abs(replayed.error(replayed.error.rows() - 1, 1)), end.residual[1], 1e-6);
  EXPECT_NEAR(replayed.thresholds(replayed.thresholds.rows() - 1, 1), end.threshold[1], 1e-6);
}

TEST(Live, KeepsWhatIsAroundADetectionAndWritesItOverNothing) {
  const TemporaryFolder folder;
  const RobotDescription robot = test::by_joint_robot(2, kBoundNm);
  Live live(bus_input_of(robot, folder.path()),
            std::make_unique<RunAsBus>(robot, std::vector{push_on(1, 8.0)}, 12.0));
  const Moment end = wait_for(live, is_over);
  ASSERT_TRUE(is_frozen(end));
  const double detected_s = end.detection->t_s;
  const Live::Written written = live.write_detection();
  EXPECT_EQ(std::filesystem::path(written.since), folder / "arm_detection.csv");
  EXPECT_EQ(std::filesystem::path(written.before), folder / "arm_before_detection.csv");
  EXPECT_EQ(live.write_detection().since, (folder / "arm_detection_2.csv").string());
  const Log log = read_log(written.since, 2, std::nullopt);
  const Log before = read_log(written.before, 2, std::nullopt);
  // From the first sample that was judged on, and as far as the run went.
  EXPECT_GT(detected_s - before.t_s[0], kBeforeS);
  EXPECT_NEAR(before.t_s[before.t_s.size() - 1], detected_s - 0.001, 1e-6);
  EXPECT_NEAR(log.t_s[0], detected_s, 1e-6);
  EXPECT_NEAR(log.t_s[log.t_s.size() - 1], end.t_s, 0.002);
  EXPECT_TRUE(log.gaps.empty());
  const auto charts = live.frozen(400);
  ASSERT_EQ(charts.size(), 2U);
  EXPECT_EQ(charts[0].series.size(), 2U);
  const std::vector<double>& t_s = charts[0].series[0].x;
  EXPECT_LE(t_s.size(), 800U);
  EXPECT_NEAR(t_s.front(), detected_s - kBeforeS, 0.002);
  EXPECT_NEAR(t_s.back(), detected_s + kAfterS, 0.002);
  EXPECT_EQ(frozen_json(live, 400).size(), 2U);
}

TEST(Live, ListensToABusAndCanDoNothingToIt) {
  const TemporaryFolder folder;
  const RobotDescription robot = test::by_joint_robot(2, kBoundNm);
  Live live(bus_input_of(robot, folder.path()),
            std::make_unique<RunAsBus>(robot, std::vector<sim::FaultEvent>{}, 1.0));
  EXPECT_FALSE(live.is_simulated());
  EXPECT_THROW(live.add_fault("friction_jump", 1, 1), Refused);
  EXPECT_THROW(live.end_faults(), Refused);
  EXPECT_THROW(live.set_accommodation(true), Refused);
  EXPECT_THROW(static_cast<void>(live.write_detection()), Refused);
  EXPECT_THROW(static_cast<void>(live.frozen(400)), Refused);
  EXPECT_THROW(static_cast<void>(live.stop_recording()), Refused);
  const Moment end = wait_for(live, is_over);
  ASSERT_TRUE(end.controller.has_value());
  EXPECT_EQ(end.controller->state, hal::ControllerState::kArmed);
  EXPECT_FALSE(end.detection.has_value());
  EXPECT_EQ(end.missing, 0U);
  EXPECT_TRUE(setup_json(live).at("faults").empty());
}

TEST(Live, ShowsWithoutABoundTheResidualAlone) {
  const TemporaryFolder folder;
  RobotDescription robot = test::by_joint_robot(2, kBoundNm);
  const RobotDescription bounded = robot;
  robot.bound.reset();
  Live live(bus_input_of(robot, folder.path()),
            std::make_unique<RunAsBus>(bounded, std::vector{push_on(1, 1.0)}, 3.0));
  const Moment end = wait_for(live, is_over);
  EXPECT_FALSE(live.has_bound());
  EXPECT_GT(end.residual[1], kBoundNm);
  EXPECT_TRUE(std::isnan(end.threshold[1]));
  EXPECT_FALSE(end.detection.has_value());
  EXPECT_TRUE(moment_json(end, live).at("threshold").at(1).is_null());
}

// Twice as slow as the robot file says: the tick is the readings'.
TEST(Live, TakesThePeriodOfTheReadings) {
  const TemporaryFolder folder;
  RobotDescription slow = test::by_joint_robot(2, kBoundNm);
  slow.estimator.period_s = 0.002;
  Live live(bus_input_of(test::by_joint_robot(2, kBoundNm), folder.path()),
            std::make_unique<RunAsBus>(slow, std::vector{push_on(1, 8.0)}, 12.0));
  const Moment end = wait_for(live, is_over);
  EXPECT_EQ(end.missing, 0U);
  ASSERT_TRUE(end.detection.has_value());
  EXPECT_EQ(end.detection->joint, 1);
}

TEST(LiveBench, DetectsNamesAndKeepsAFaultThatIsInjected) {
  const TemporaryFolder folder;
  const RobotDescription robot = test::by_joint_robot(2, kBoundNm);
  Live live(input_of(robot, folder.path()));
  ASSERT_TRUE(live.is_simulated());
  wait_for(live, [](const Moment& moment) { return moment.is_judging && moment.t_s > 2; });
  EXPECT_FALSE(live.moment(0).detection.has_value());
  live.add_fault("disturbance_torque", 2, 4 * kBoundNm);
  const Moment there = wait_for(live, is_frozen);
  EXPECT_EQ(there.detection->joint, 1);
  ASSERT_EQ(there.faults.size(), 1U);
  ASSERT_TRUE(there.detection->answer.has_value());
  EXPECT_EQ(there.detection->answer->joint, 1);
  live.set_accommodation(true);
  EXPECT_TRUE(live.moment(0).accommodates);
  live.begin_again();
  const Moment again =
      wait_for(live, [](const Moment& moment) { return !moment.detection && moment.is_judging; });
  EXPECT_TRUE(again.faults.empty());
  EXPECT_GT(again.t_s, there.t_s);
}

// GIVEN a joint with a level to act WHEN it is beyond it THEN moment, legend and charts tell of
// both.
TEST(LiveBench, GivenTwoLevelsThenItShowsBothAndSaysWhenTheSecondIsReached) {
  const TemporaryFolder folder;
  RobotDescription robot = test::by_joint_robot(2, kBoundNm);
  robot.bound->joints[1].act_ratio = 3;
  Live live(input_of(robot, folder.path()));
  EXPECT_TRUE(live.has_two_levels());
  EXPECT_EQ(setup_json(live).at("has_two_levels"), true);
  wait_for(live, [](const Moment& moment) { return moment.is_judging && moment.t_s > 2; });
  live.add_fault("disturbance_torque", 2, 2 * kBoundNm);
  const Moment noticed = wait_for(live, is_frozen);
  EXPECT_FALSE(noticed.detection->act_t_s.has_value());
  EXPECT_TRUE(std::isnan(noticed.act[0])) << "it has one level";
  EXPECT_EQ(noticed.act[1], 3 * noticed.threshold[1]);
  live.add_fault("disturbance_torque", 2, 8 * kBoundNm);
  const Moment acts = wait_for(live, [](const Moment& moment) {
    return moment.detection && moment.detection->act_t_s.has_value();
  });
  EXPECT_EQ(acts.detection->act_joint, 1);
  EXPECT_GT(*acts.detection->act_t_s, acts.detection->t_s);
  const auto json = moment_json(acts, live);
  EXPECT_EQ(json.at("detection").at("act_joint"), 2);
  EXPECT_EQ(json.at("act").size(), 2U);
  EXPECT_TRUE(json.at("act").at(0).is_null());
  EXPECT_EQ(json.at("steps").at("act").at(1).size(), json.at("steps").at("threshold").at(1).size());
  const auto charts = live.frozen(500);
  EXPECT_EQ(charts.at(0).series.size(), 2U);
  ASSERT_EQ(charts.at(1).series.size(), 3U);
  EXPECT_EQ(charts.at(1).series.at(2).name, "level to act");

  const Live of_one(input_of(test::by_joint_robot(2, kBoundNm), folder.path()));
  EXPECT_EQ(setup_json(of_one).at("has_two_levels"), false);
  EXPECT_TRUE(moment_json(of_one.moment(0), of_one).at("act").empty());
}

// GIVEN an arm of MuJoCo WHEN friction is put on a joint THEN the joint is told; begun again, it is
// quiet. Dry friction, which holds it at rest there and in no model, is left out of its file.
TEST(LiveBench, PutsFaultsOnAnArmOfMujocoAndTakesThemOff) {
  const TemporaryFolder folder;
  RobotDescription robot = test::by_joint_robot(2, kBoundNm);
  std::erase_if(robot.effects,
                [](const auto& one) { return one.kind == EffectKind::kCoulombFriction; });
  test::put(folder / "plant.xml", exchange::export_mjcf(robot, "").text);
  LiveInput input = input_of(robot, folder.path());
  input.scenario.mujoco = (folder / "plant.xml").string();
  Live live(std::move(input));
  wait_for(live, [](const Moment& moment) { return moment.is_judging && moment.t_s > 2; });
  EXPECT_FALSE(live.moment(0).detection.has_value());
  live.add_fault("friction_jump", 2, 4 * kBoundNm);
  const Moment there = wait_for(live, is_frozen);
  EXPECT_EQ(there.detection->joint, 1);
  live.end_faults();
  wait_for(live, [](const Moment& moment) { return moment.faults.empty() && !moment.beyond[1]; });
  live.begin_again();
  const Moment again = wait_for(
      live, [&](const Moment& moment) { return moment.is_judging && moment.t_s > there.t_s + 5; });
  EXPECT_FALSE(again.detection.has_value());
  // Its file is gone: that is said, and the view goes on.
  std::filesystem::rename(folder / "plant.xml", folder / "away.xml");
  live.begin_again();
  EXPECT_THAT(wait_for(live, is_over).ended, HasSubstr("plant.xml"));
  std::filesystem::rename(folder / "away.xml", folder / "plant.xml");
  live.begin_again();
  wait_for(live, [](const Moment& moment) { return moment.ended.empty() && moment.is_judging; });
}

TEST(LiveBench, SaysWhyARunHasEndedAndBeginsItAgain) {
  const RobotDescription robot = test::by_joint_robot(2, kBoundNm);
  Live live(input_of(robot, {}));
  wait_for(live, [](const Moment& moment) { return moment.is_judging; });
  live.add_fault("encoder_dropout", 1, 0);
  const Moment end = wait_for(live, is_over);
  EXPECT_THAT(end.ended, HasSubstr("safe state: DriveReported, a drive says that it"));
  EXPECT_THAT(end.ended, HasSubstr("number 164 of docs/troubleshooting.md"));
  const auto said = moment_json(end, live).at("controller");
  EXPECT_EQ(said.at("fault"), "DriveReported");
  EXPECT_THAT(said.at("fault_words").get<std::string>(), HasSubstr("number 164"));
  EXPECT_EQ(end.controller->state, hal::ControllerState::kFault);
  live.begin_again();
  const Moment again = wait_for(
      live, [](const Moment& moment) { return moment.ended.empty() && moment.is_judging; });
  EXPECT_EQ(again.controller->state, hal::ControllerState::kArmed);
  EXPECT_GT(again.t_s, end.t_s);
}

TEST(LiveWords, SayOfEveryFaultOfAControllerWhatItMeans) {
  for (int number = 1; number < 256; ++number) {
    const auto fault = static_cast<controller::Fault>(number);
    const std::string words = words_of(fault);
    EXPECT_THAT(words, HasSubstr("number " + std::to_string(number) + " of"));
    const std::string name = controller::name_of(fault);
    const bool is_of_controller = number >= 160 && number < 188 && name != "Unknown";
    if (is_of_controller) {
      EXPECT_THAT(words, HasSubstr(" (number")) << name;
    }
  }
}

// GIVEN a scenario with a fault of its own and a controller that slows at it THEN the page is told
// of both.
TEST(LiveBench, TellsOfTheScenariosFaultsAndOfASlowedMotion) {
  const RobotDescription robot = test::by_joint_robot(4, kBoundNm);
  LiveInput input = input_of(robot, {});
  input.scenario.at_detection = controller::AtDetection::kSlow;
  input.scenario.faults = {{.kind = sim::FaultEventKind::kFrictionJump,
                            .begin_s = 1.0,
                            .joint = 1,
                            .size = 4 * kBoundNm}};
  Live live(std::move(input));
  const auto planned = setup_json(live).at("planned");
  ASSERT_EQ(planned.size(), 1U);
  EXPECT_EQ(planned[0].at("kind"), "friction_jump");
  EXPECT_EQ(planned[0].at("joint"), 2);
  EXPECT_EQ(planned[0].at("begin_s"), 1.0);
  // The page's own monitor sees it as the controller's does, a little later.
  const Moment slowed = wait_for(live, [](const Moment& now) {
    return now.controller && now.controller->slows && now.detection.has_value();
  });
  EXPECT_TRUE(moment_json(slowed, live).at("controller").at("slows").get<bool>());
}

TEST(LiveBench, RefusesInWordsWhatNoFaultIs) {
  const RobotDescription robot = test::by_joint_robot(2, kBoundNm);
  Live live(input_of(robot, {}));
  EXPECT_THROW(live.add_fault("no_such", 1, 1), Refused);
  EXPECT_THROW(live.add_fault("nonlinear", 0, 0), Refused);
  EXPECT_THROW(live.add_fault("friction_jump", 3, 1), Refused);
  EXPECT_THROW(live.add_fault("friction_jump", 1, -1), Refused);
  EXPECT_THROW(live.add_fault("friction_jump", 1, std::nan("")), Refused);
  EXPECT_TRUE(live.moment(0).faults.empty());
}

TEST(LiveBus, SaysWhatABusThatIsNotThereAsksFor) {
  LiveInput input = input_of(test::by_joint_robot(2, kBoundNm), {});
  input.bus = "can_none";
  try {
    const Live live(std::move(input));
    FAIL() << "there is such a bus";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("--bus can_none"));
    EXPECT_THAT(error.what(), HasSubstr("to mend"));
  }
}

}  // namespace
}  // namespace offnominal::desk::live
