#include "robot/payload.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <toml++/toml.h>

#include "common/error.hpp"
#include "robot/channels.hpp"
#include "robot/robot_file.hpp"
#include "sample_robot.hpp"

namespace offnominal::desk {
namespace {

using testing::HasSubstr;

TEST(Payload, IsReadFromTheTextOfTheOption) {
  const auto payload = payload_of_text("runs/a=b@1.csv=0.8@0,-0.02,1e-1");
  ASSERT_TRUE(payload.has_value());
  EXPECT_EQ(payload->recording, "runs/a=b@1.csv");
  EXPECT_EQ(payload->payload.mass_kg, 0.8);
  EXPECT_EQ(payload->payload.place_m, (std::array<double, 3>{0, -0.02, 0.1}));
  EXPECT_EQ(text_of(*payload), "runs/a=b@1.csv=0.8@0,-0.02,0.1");
  EXPECT_EQ(words_of(payload->payload), "0.8 kg at [0, -0.02, 0.1] m of the last link");
}

TEST(Payload, IsNoneInAnyOtherText) {
  for (const char* text :
       {"", "a.csv", "a.csv=0.8", "=0.8@0,0,0", "a.csv=@0,0,0", "a.csv=0.8@0,0",
        "a.csv=0.8@0,0,0,0", "a.csv=0.8@0,,0", "a.csv=-1@0,0,0", "a.csv=1e9@0,0,0",
        "a.csv=1@0,0,1e9", "a.csv=nan@0,0,0", "a.csv=0.8kg@0,0,0", "a.csv=0.8@0,0,inf"}) {
    EXPECT_FALSE(payload_of_text(text).has_value()) << text;
  }
}

TEST(Payload, IsOfARecordingByItsWholeNameOrThatOfItsFile) {
  const std::vector<RecordingPayload> payloads{{"a.csv", {1, {0, 0, 0}}},
                                               {"runs/b.csv", {2, {0, 0, 0}}}};
  EXPECT_EQ(payload_of(payloads, "runs/a.csv")->mass_kg, 1);
  EXPECT_EQ(payload_of(payloads, "runs/b.csv")->mass_kg, 2);
  EXPECT_FALSE(payload_of(payloads, "b.csv").has_value()) << "it may be another";
  EXPECT_FALSE(payload_of(payloads, "ba.csv").has_value());
}

TEST(Payload, IsOfAJoinedRecordingByTheNameOfAnyOfItsFiles) {
  const std::vector<RecordingPayload> payloads{{"b.csv", {2, {0, 0, 0}}}};
  ASSERT_TRUE(payload_of(payloads, "runs/a.csv+runs/b.csv").has_value());
  EXPECT_EQ(payload_of(payloads, "runs/a.csv+runs/b.csv")->mass_kg, 2);
  EXPECT_FALSE(payload_of(payloads, "runs/a.csv+runs/c.csv").has_value());
}

TEST(Payload, GivenAFileWithoutRoomThenItIsRefusedInWords) {
  RobotDescription robot = parse_robot(test::kSampleRobot, "sample.toml");
  robot.effects.resize(kEffectsPerJoint * robot.joints.size());
  EXPECT_NO_THROW(static_cast<void>(carrying(robot, std::nullopt)));
  EXPECT_THROW(static_cast<void>(carrying(robot, Payload{0.8, {0, 0, 0}})), InputError);
}

TEST(Payload, GivenTwoOfOneRecordingThenTheyHaveToAgree) {
  std::vector<RecordingPayload> payloads{{"a.csv", {1, {0, 0, 0}}}, {"runs/a.csv", {1, {0, 0, 0}}}};
  EXPECT_EQ(payload_of(payloads, "runs/a.csv")->mass_kg, 1);
  payloads[1].payload.place_m[2] = 0.1;
  EXPECT_THROW(static_cast<void>(payload_of(payloads, "runs/a.csv")), InputError);
}

TEST(Payload, IsAPointMassOnTheLastLink) {
  const RobotDescription robot = parse_robot(test::kSampleRobot, "sample.toml");
  EXPECT_EQ(carrying(robot, std::nullopt).effects.size(), robot.effects.size());
  const RobotDescription loaded = carrying(robot, Payload{0.8, {0.1, 0.2, 0.3}});
  ASSERT_EQ(loaded.effects.size(), robot.effects.size() + 1);
  const RobotEffect& effect = loaded.effects.back();
  EXPECT_EQ(effect.kind, EffectKind::kTipPayload);
  EXPECT_EQ(effect.joint, robot.joints.size() - 1);
  EXPECT_FALSE(effect.fitted) << "known, and no fit may change it";
}

std::string refusal_of(const std::string& payload) {
  const toml::table table =
      toml::parse("position = [\"q1\"]\ntorque = [\"tau1\"]\npayload = " + payload + "\n");
  try {
    static_cast<void>(parse_channels(table, "robot.toml", 1));
  } catch (const InputError& error) {
    return error.what();
  }
  return "taken";
}

TEST(Payload, OfChannelsIsReadStrictly) {
  const toml::table table = toml::parse(
      "position = [\"q1\"]\ntorque = [\"tau1\"]\n"
      "payload = [{recording = \"a.csv\", mass_kg = 0, place_m = [0, 0, 0.1]}]\n");
  const ChannelMap map = parse_channels(table, "robot.toml", 1);
  ASSERT_EQ(map.payloads.size(), 1U);
  EXPECT_EQ(map.payloads[0].payload.place_m[2], 0.1);
  EXPECT_THAT(refusal_of("0.8"), HasSubstr("channels.payload: found a number; allowed: a list"));
  EXPECT_THAT(refusal_of("[0.8]"), HasSubstr("channels.payload[1]: found a number"));
  EXPECT_THAT(refusal_of("[{mass_kg = 1, place_m = [0, 0, 0]}]"), HasSubstr("no recording"));
  EXPECT_THAT(refusal_of("[{recording = \"a\", mass_kg = 1}]"), HasSubstr("no place_m"));
  EXPECT_THAT(refusal_of("[{recording = \"a\", mass_kg = -1, place_m = [0, 0, 0]}]"),
              HasSubstr("mass_kg: found -1"));
  EXPECT_THAT(refusal_of("[{recording = \"a\", mass_kg = 1, place_m = [0, 0]}]"),
              HasSubstr("found 2 numbers"));
  EXPECT_THAT(refusal_of("[{recording = \"a\", mass_kg = 1, place_m = [0, 0, 1e9]}]"),
              HasSubstr("too large"));
  EXPECT_THAT(refusal_of("[{recording = \"a\", kg = 1}]"), HasSubstr("unknown key \"kg\""));
}

}  // namespace
}  // namespace offnominal::desk
