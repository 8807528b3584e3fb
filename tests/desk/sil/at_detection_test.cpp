// What a run shows of a controller that slows or stops at its second level.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/error.hpp"
#include "desk/sil/run_of_robot.hpp"
#include "desk/sil/serial_robot.hpp"
#include "desk/support/temporary_folder.hpp"
#include "paper/two_link_robot.hpp"
#include "report/page.hpp"
#include "sil/scenario_file.hpp"
#include "sil/sil_report.hpp"

namespace offnominal::desk::sil {
namespace {

using controller::AtDetection;
using sim::FaultEvent;
using sim::FaultEventKind;
using test::by_joint_robot;
using testing::HasSubstr;
using testing::Not;

constexpr double kNoticedNm = 0.5;

FaultEvent friction_on(int joint, double size_nm) {
  return {.kind = FaultEventKind::kFrictionJump, .begin_s = 1.0, .joint = joint, .size = size_nm};
}

Scenario slowing(const RobotDescription& robot, std::vector<FaultEvent> faults) {
  Scenario scenario = scenario_of(robot, std::move(faults));
  scenario.duration_s = 4.0;
  scenario.record = true;
  scenario.at_detection = AtDetection::kSlow;
  scenario.slow_down = {0.2, 0.5};
  return scenario;
}

// Largest speed of any joint from a time on, rad/s.
double fastest(const SilResult& result, double from_s) {
  const paper::TimeSeries& series = result.run.series;
  double most = 0;
  for (std::size_t i = 0; i < series.time_s.size(); ++i) {
    if (series.time_s[i] < from_s) continue;
    for (const std::vector<double>& of_joint : series.dq) {
      most = std::max(most, std::abs(of_joint[i]));
    }
  }
  return most;
}

// GIVEN friction WHEN the controller is told to slow THEN the arm goes on at a fraction of its
// pace, is judged by the motion that it then follows, and the run says since when.
TEST(AtDetection, GivenSlowThenTheArmGoesOnMoreSlowlyAndTheRunSaysSo) {
  const RobotDescription robot = by_joint_robot(4, kNoticedNm);
  Scenario scenario = slowing(robot, {friction_on(1, 3 * kNoticedNm)});
  const SilResult slowed = run(robot, scenario);
  scenario.at_detection = AtDetection::kReport;
  const SilResult reported = run(robot, scenario);
  ASSERT_TRUE(slowed.slowed.has_value());
  EXPECT_FALSE(reported.slowed.has_value());
  EXPECT_EQ(slowed.slowed->time_s, slowed.run.detection_time_s) << "of one level they are one";
  EXPECT_EQ(slowed.run.detection_time_s, reported.run.detection_time_s);
  EXPECT_EQ(slowed.slowed->as.to, 0.2);
  EXPECT_TRUE(slowed.slowed->reached);
  EXPECT_EQ(slowed.state, hal::ControllerState::kArmed) << controller::name_of(slowed.fault);
  const double settled_s = slowed.slowed->time_s + 0.6;
  EXPECT_LT(fastest(slowed, settled_s), 0.25 * fastest(reported, settled_s));
  EXPECT_GT(fastest(slowed, settled_s), 0.05 * fastest(reported, settled_s)) << "it goes on";
  // Off the motion that it was given it would be by tenths of a radian.
  EXPECT_LT(slowed.run.tracking_rms_rad, 2 * reported.run.tracking_rms_rad);
  EXPECT_THAT(text_of(slowed),
              testing::ContainsRegex("motion slowed +1.* s, to 20 % of its pace within 0.5 s"));
  EXPECT_THAT(sentence_of(slowed), HasSubstr("slowed the motion to 20 % of its pace within 0.5 s"));
  EXPECT_THAT(sentence_of(slowed), Not(HasSubstr("ended before")));
  const auto json = to_json(slowed);
  EXPECT_EQ(json.at("slowed").at("time_s"), slowed.slowed->time_s);
  EXPECT_EQ(json.at("slowed").at("to"), 0.2);
  EXPECT_EQ(json.at("slowed").at("reached"), true);
  EXPECT_EQ(json.at("at_detection"), "slow");
  EXPECT_EQ(to_json(reported).at("slowed"), nullptr);
}

// GIVEN a run that ends while the motion is still slowed down THEN it does not say that the pace
// was reached.
TEST(AtDetection, GivenARunThatEndsOnTheWayThenItSaysSo) {
  const RobotDescription robot = by_joint_robot(4, kNoticedNm);
  Scenario scenario = slowing(robot, {friction_on(1, 3 * kNoticedNm)});
  scenario.slow_down = {0, 30};
  const SilResult slowed = run(robot, scenario);
  ASSERT_TRUE(slowed.slowed.has_value());
  EXPECT_FALSE(slowed.slowed->reached);
  EXPECT_THAT(sentence_of(slowed), HasSubstr("slowed the motion to a stand within 30 s. The run "
                                             "ended before that."));
}

// The paper's arm is judged by the time of its plant.
TEST(AtDetection, GivenThePapersArmThenItToo) {
  const RobotDescription robot = paper::two_link_robot();
  Scenario scenario;
  scenario.duration_s = 6.0;
  scenario.record = true;
  scenario.faults = {{.kind = FaultEventKind::kPayload, .begin_s = 2.0, .size = 1.0}};
  const SilResult reported = run(robot, scenario);
  scenario.at_detection = AtDetection::kSlow;
  const SilResult slowed = run(robot, scenario);
  ASSERT_TRUE(slowed.slowed.has_value());
  EXPECT_LT(slowed.run.tracking_rms_rad, 1.5 * reported.run.tracking_rms_rad);
  EXPECT_LT(fastest(slowed, 4.5), 0.4 * fastest(reported, 4.5));
}

// GIVEN nothing that acts THEN the run is the same to the last bit, whatever is chosen.
TEST(AtDetection, GivenAHealthyArmThenNothingDependsOnIt) {
  const RobotDescription robot = by_joint_robot(3, kNoticedNm);
  Scenario scenario = slowing(robot, {});
  const SilResult slow = run(robot, scenario);
  scenario.at_detection = AtDetection::kReport;
  const SilResult report = run(robot, scenario);
  EXPECT_EQ(slow.run.series.tau, report.run.series.tau);
  EXPECT_EQ(slow.run.series.q, report.run.series.q);
  EXPECT_THAT(text_of(slow), testing::ContainsRegex("motion slowed +never"));
  EXPECT_THAT(text_of(report), Not(HasSubstr("motion slowed")));
  EXPECT_EQ(slow.run.tracking_rms_rad, report.run.tracking_rms_rad);
}

// GIVEN two levels THEN the run says of each joint when it was beyond the second one.
TEST(AtDetection, GivenTwoLevelsThenTheRunSaysWhichJointWasBeyondTheSecondAndWhen) {
  RobotDescription robot = by_joint_robot(4, kNoticedNm);
  robot.bound->joints[1].act_ratio = 2;
  Scenario scenario = slowing(robot, {friction_on(1, 4 * kNoticedNm)});
  const SilResult acting = run(robot, scenario);
  ASSERT_TRUE(acting.run.detection_time_s && acting.run.act_time_s && acting.slowed);
  EXPECT_GT(*acting.run.act_time_s, *acting.run.detection_time_s);
  EXPECT_EQ(acting.slowed->time_s, acting.run.act_time_s);
  EXPECT_EQ(acting.run.joints[1].act_time_s, acting.run.act_time_s);
  EXPECT_FALSE(acting.run.joints[0].act_time_s.has_value());
  EXPECT_THAT(text_of(acting), testing::ContainsRegex("joints beyond it +joint 2 .joint2. at 1"));
  EXPECT_THAT(sentence_of(acting), HasSubstr("Beyond the level to act at 1."));
  const auto json = to_json(acting);
  EXPECT_EQ(json.at("act_time_s"), *acting.run.act_time_s);
  EXPECT_EQ(json.at("joints")[1].at("act_time_s"), *acting.run.act_time_s);
  EXPECT_EQ(json.at("joints")[0].at("act_time_s"), nullptr);

  scenario.faults = {friction_on(1, 1.5 * kNoticedNm)};
  const SilResult noticed = run(robot, scenario);
  ASSERT_TRUE(noticed.run.detection_time_s.has_value());
  EXPECT_FALSE(noticed.run.act_time_s || noticed.slowed);
  EXPECT_THAT(sentence_of(noticed), HasSubstr("Never beyond the level to act."));
  EXPECT_EQ(to_json(noticed).at("act_time_s"), nullptr);

  const RobotDescription of_one_level = by_joint_robot(4, kNoticedNm);
  const SilResult plain = run(of_one_level, scenario_of(of_one_level, {friction_on(1, 2)}));
  EXPECT_FALSE(to_json(plain).contains("act_time_s")) << "it is the detection's";
  EXPECT_THAT(text_of(plain), Not(HasSubstr("level to act")));
}

std::vector<std::string> names_of_series(const SilResult& result, const std::string& title) {
  std::vector<std::string> names;
  const auto page = report::to_json(page_of(result, "offnominal sil"));
  for (const auto& section : page.at("sections")) {
    for (const auto& block : section.at("blocks")) {
      if (block.at("type") != "chart") continue;
      if (block.at("title").get<std::string>().find(title) == std::string::npos) continue;
      for (const auto& series : block.at("series")) names.push_back(series.at("name"));
    }
  }
  return names;
}

// GIVEN a second filter and a second level THEN the page shows both, of the joints that have them.
TEST(AtDetection, ThePageShowsTheSecondFilterAndTheLevelToAct) {
  using testing::ElementsAre;
  using testing::IsEmpty;
  RobotDescription robot = by_joint_robot(2, kNoticedNm);
  const std::vector<FaultEvent> faults = {friction_on(1, 4 * kNoticedNm)};
  const SilResult plain = run(robot, slowing(robot, faults));
  EXPECT_THAT(names_of_series(plain, "Residual and threshold of joint 2"),
              ElementsAre("threshold", "fault, filtered", "residual"));
  EXPECT_THAT(names_of_series(plain, "behind the fast filter"), IsEmpty());
  robot.estimator.fast_alpha = 100;
  robot.bound->fast = robot.bound->joints;
  for (JointBoundSettings& joint : robot.bound->fast) joint.value = {2 * kNoticedNm};
  robot.bound->joints[1].act_ratio = 2;
  robot.bound->fast[0].act_ratio = 3;
  const SilResult both = run(robot, slowing(robot, faults));
  EXPECT_THAT(names_of_series(both, "Residual and threshold of joint 1"),
              ElementsAre("threshold", "fault, filtered", "residual"));
  EXPECT_THAT(names_of_series(both, "Residual and threshold of joint 2"),
              ElementsAre("threshold", "fault, filtered", "residual", "level to act"));
  EXPECT_THAT(names_of_series(both, "behind the fast filter, joint 1"),
              ElementsAre("threshold", "residual", "level to act"));
  EXPECT_THAT(names_of_series(both, "behind the fast filter, joint 2"),
              ElementsAre("threshold", "residual"));
  const std::vector<double>& fast = both.run.series.joint_fast_residual.at(1);
  EXPECT_GT(*std::max_element(fast.begin(), fast.end()), 2 * kNoticedNm);
}

Scenario act_scenario(const std::string& text) {
  const test::TemporaryFolder folder;
  test::put(folder / "s.toml", text);
  return read_scenario(folder / "s.toml", std::nullopt);
}
std::string act_refusal(const std::string& text) {
  try {
    act_scenario(text);
  } catch (const InputError& error) {
    return error.what();
  }
  return "nothing was refused";
}

TEST(AtDetection, StandsInAScenarioAsItIsWritten) {
  Scenario scenario =
      act_scenario("format = 1\nat_detection = \"slow\"\nslow_to = 0.1\nslow_within_s = 2.0\n");
  for (int pass = 0; pass < 2; ++pass) {
    EXPECT_EQ(scenario.at_detection, AtDetection::kSlow);
    EXPECT_EQ(scenario.slow_down.to, 0.1);
    EXPECT_EQ(scenario.slow_down.within_s, 2.0);
    scenario = act_scenario(scenario_text(scenario));
  }
  EXPECT_EQ(act_scenario("format = 1\n").at_detection, AtDetection::kReport);
  EXPECT_EQ(act_scenario("format = 1\nat_detection = \"stop\"\n").at_detection, AtDetection::kStop);
  EXPECT_THAT(act_refusal("format = 1\nat_detection = \"halt\"\n"), HasSubstr("line 2"));
  EXPECT_THAT(act_refusal("format = 1\nat_detection = \"slow\"\nslow_to = 1.0\n"),
              HasSubstr("slow_to: found 1"));
  EXPECT_THAT(act_refusal("format = 1\nat_detection = \"stop\"\nslow_to = 0.5\n"),
              HasSubstr("slow_to: found it beside at_detection = \"stop\""));
  EXPECT_THAT(act_refusal("format = 1\nslow_within_s = 0.5\n"),
              HasSubstr("slow_within_s: found it without at_detection"));
  for (const char* none : {"0.001", "1e300"}) {
    EXPECT_THAT(act_refusal(std::string("format = 1\nat_detection = \"slow\"\nslow_within_s = ") +
                            none + "\n"),
                HasSubstr("0.01"));
  }
  EXPECT_THAT(act_refusal("format = 1\nstop_at_detection = true\n"), HasSubstr("at_detection"));
}

TEST(AtDetection, IsOverruledByOptions) {
  ActSettings settings;
  settings.at_detection = AtDetection::kSlow;
  settings.slow_down = {0.1, 2.0};
  put_act_options("program", {}, settings);
  EXPECT_EQ(settings.at_detection, AtDetection::kSlow);
  ActOptions options;
  options.slow_to = 0.5;
  put_act_options("program", options, settings);
  EXPECT_EQ(settings.slow_down.to, 0.5);
  EXPECT_EQ(settings.slow_down.within_s, 2.0);
  EXPECT_THAT(act_arguments(settings), testing::ElementsAre("--at-detection", "slow", "--slow-to",
                                                            "0.5", "--slow-within", "2"));
  options.at_detection = "stop";
  EXPECT_THROW(put_act_options("program", options, settings), InputError);
  options.slow_to.reset();
  put_act_options("program", options, settings);
  EXPECT_EQ(settings.at_detection, AtDetection::kStop);
  EXPECT_THAT(act_arguments(settings), testing::ElementsAre("--at-detection", "stop"));
}

}  // namespace
}  // namespace offnominal::desk::sil
