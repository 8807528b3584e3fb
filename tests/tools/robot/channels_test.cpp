#include "robot/channels.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "common/error.hpp"
#include "tools/support/temporary_file.hpp"

namespace {

using offnominal::test::message_of;
using offnominal::test::TemporaryFile;
using offnominal::tools::ChannelMap;
using offnominal::tools::InputError;
using offnominal::tools::parse_channels;
using offnominal::tools::read_channels_file;
using ::testing::AllOf;
using ::testing::HasSubstr;

ChannelMap parse(const std::string& text, int joints = 1) {
  return parse_channels(toml::parse(text), "robot.toml", joints);
}
std::string refusal(const std::string& text, int joints = 1) {
  return message_of<InputError>([&] { parse(text, joints); });
}

TEST(Channels, ShortAndLongFormSayTheSame) {
  const ChannelMap map = parse(R"(
    position = "qm"
    torque = [{source = "vir", scale = 2, scale_source = "gtau", unit = "V"}]
    extra = {temp1 = {source = "T", offset = -273.15, unit = "K"}}
  )");
  EXPECT_EQ(map.time.source, "t");
  EXPECT_EQ(map.position.at(0).source, "qm");
  EXPECT_EQ(map.position.at(0).scale, 1);
  EXPECT_EQ(map.torque.at(0).scale, 2);
  EXPECT_EQ(map.torque.at(0).scale_source, "gtau");
  EXPECT_EQ(map.torque.at(0).unit, "V");
  ASSERT_EQ(map.velocity.size(), 1U);
  EXPECT_FALSE(map.velocity[0].has_value());
  EXPECT_EQ(map.extra.at("temp1").offset, -273.15);
}

TEST(Channels, OneVelocityOfTwoMayBeDerived) {
  const ChannelMap map =
      parse("time = 'ts'\nposition = ['a', 'b']\nvelocity = ['', 'vb']\ntorque = ['c', 'd']", 2);
  EXPECT_EQ(map.time.source, "ts");
  EXPECT_FALSE(map.velocity[0].has_value());
  EXPECT_EQ(map.velocity[1]->source, "vb");
}

TEST(Channels, MistakesNameFileLineAndKey) {
  EXPECT_THAT(refusal("position = 'q'\ntorque = 'tau'\nspeed = 'v'"),
              AllOf(HasSubstr("robot.toml: line 3, channels"), HasSubstr("\"speed\"")));
  EXPECT_THAT(refusal("torque = 'tau'"), HasSubstr("channels.position"));
  EXPECT_THAT(refusal("position = ['a', 'b']\ntorque = 'tau'"),
              AllOf(HasSubstr("2 entries"), HasSubstr("1 channel")));
  EXPECT_THAT(refusal("position = 'a'\ntorque = ['c', 'd']", 2),
              AllOf(HasSubstr("line 1"), HasSubstr("a list of 2 channels")));
  EXPECT_THAT(refusal("position = 3\ntorque = 'tau'"), HasSubstr("a number"));
  EXPECT_THAT(refusal("position = {scale = 3}\ntorque = 'tau'"), HasSubstr("no source"));
  EXPECT_THAT(refusal("position = {source = 'a', scale = 'b'}\ntorque = 'tau'"),
              AllOf(HasSubstr("channels.position.scale"), HasSubstr("a finite number")));
  EXPECT_THAT(refusal("position = {source = 'a', scale = 0}\ntorque = 'tau'"),
              HasSubstr("scale 0"));
  EXPECT_THAT(refusal("position = {source = 'a', scale = nan}\ntorque = 'tau'"),
              HasSubstr("not finite"));
  EXPECT_THAT(refusal("position = {source = 'a', gain = 2}\ntorque = 'tau'"),
              AllOf(HasSubstr("\"gain\""), HasSubstr("scale_source")));
}

TEST(Channels, UnitThatIsNotSiNeedsAScale) {
  EXPECT_THAT(refusal("position = {source = 'a', unit = 'deg'}\ntorque = 'tau'"),
              AllOf(HasSubstr("unit \"deg\" without a scale"), HasSubstr("rad, m;")));
  EXPECT_EQ(parse("position = {source = 'a', unit = 'deg', scale = 0.01745}\ntorque = 'tau'")
                .position[0]
                .unit,
            "deg");
}

TEST(Channels, FileMayHoldTheTableOrBeIt) {
  const TemporaryFile inside("inside.toml", "[channels]\nposition = 'a'\ntorque = 'b'\n");
  EXPECT_EQ(read_channels_file(inside.path(), 1).position[0].source, "a");
  const TemporaryFile bare("bare.toml", "position = 'a'\ntorque = 'b'\n");
  EXPECT_EQ(read_channels_file(bare.path(), 1).torque[0].source, "b");
  const TemporaryFile broken("broken.toml", "position = 'a'\ntorque = \n");
  EXPECT_THAT(message_of<InputError>([&] { read_channels_file(broken.path(), 1); }),
              HasSubstr("line 2"));
  EXPECT_THAT(message_of<InputError>([&] { read_channels_file("none.toml", 1); }),
              HasSubstr("no such file"));
}

}  // namespace
