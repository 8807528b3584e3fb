#include "robot/channels.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "common/error.hpp"
#include "desk/support/temporary_file.hpp"
#include "robot/units.hpp"

namespace {

using offnominal::desk::ChannelMap;
using offnominal::desk::InputError;
using offnominal::desk::parse_channels;
using offnominal::desk::read_channels_file;
using offnominal::test::message_of;
using offnominal::test::TemporaryFile;
using ::testing::AllOf;
using ::testing::HasSubstr;

ChannelMap parse(const std::string& text, int joints = 1) {
  return parse_channels(toml::parse(text), "robot.toml", joints);
}
std::string refusal(const std::string& text, int joints = 1) {
  return message_of<InputError>([&] { parse(text, joints); });
}

TEST(Channels, SayHowToMendAPayloadThatWeighsLessThanNothing) {
  EXPECT_THAT(refusal("position = \"q\"\ntorque = \"tau\"\npayload = [{recording = \"a.csv\", "
                      "mass_kg = -1, place_m = [0, 0, 0]}]\n"),
              AllOf(HasSubstr("line 3"), HasSubstr("found -1"), HasSubstr("to mend: write what")));
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
  EXPECT_THAT(
      refusal("position = ['a']\ntorque = ['c', 'd']", 2),
      HasSubstr("1 entries; allowed: a list of 2 channels, one per joint; to mend: write one "
                "for each joint, from the base outwards"));
  EXPECT_THAT(refusal("position = ['a', 'b']\ntorque = 'tau'"),
              AllOf(HasSubstr("2 entries"), HasSubstr("1 channel"),
                    HasSubstr("to mend: leave out those that are of none of the robot's joints")));
  EXPECT_THAT(refusal("position = 'a'\ntorque = ['c', 'd']", 2),
              AllOf(HasSubstr("line 1"), HasSubstr("a list of 2 channels")));
  EXPECT_THAT(refusal("position = 3.5\ntorque = 'tau'"), HasSubstr("a number"));
  EXPECT_THAT(refusal("position = 0\ntorque = 'tau'"), HasSubstr("a number below 1"));
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

TEST(Channels, AUnitOfTheQuantitysOwnNeedsNoScaleAndAnyOtherDoes) {
  const ChannelMap map = parse(
      "time = {source = 't', unit = 'ms'}\nposition = {source = 'a', unit = 'deg', scale = -1}\n"
      "torque = {source = 'i', unit = 'mA', scale = 0.08}");
  EXPECT_EQ(map.position[0].unit, "deg");
  EXPECT_EQ(map.position[0].scale, -1);
  EXPECT_THAT(refusal("position = {source = 'a', unit = 'counts'}\ntorque = 'tau'"),
              AllOf(HasSubstr("unit \"counts\" without a scale"), HasSubstr("rad, mrad, deg")));
  EXPECT_THAT(refusal("position = 'q'\ntorque = {source = 'i', unit = 'mA'}"),
              AllOf(HasSubstr("unit \"mA\" without a scale"), HasSubstr("what one A is")));
}

TEST(Channels, UnitsOfTorqueMayBeWrittenAsProducts) {
  for (const char* unit : {"mNm", "mN m", "mN*m", "mN.m", "mN-m", "mN\u00b7m", "Nmm", "N mm"}) {
    EXPECT_DOUBLE_EQ(offnominal::desk::unit_factor(unit), 1e-3) << unit;
  }
  for (const char* unit : {"Ncm", "N cm", "N\u22c5cm"}) {
    EXPECT_DOUBLE_EQ(offnominal::desk::unit_factor(unit), 1e-2) << unit;
  }
  for (const char* unit : {"kgfcm", "kgf cm", "kgf.cm", "kgf*cm"}) {
    EXPECT_DOUBLE_EQ(offnominal::desk::unit_factor(unit), 0.0980665) << unit;
  }
  for (const char* unit : {"Nm", "N m", "N*m", "N.m", "N-m", "N\u00b7m"}) {
    ASSERT_NE(offnominal::desk::find_unit(unit), nullptr) << unit;
  }
  for (const char* unit : {"m s", "m.m", "rad.s", "N/m", "mn m"}) {
    EXPECT_EQ(offnominal::desk::find_unit(unit), nullptr) << unit;
  }
  const ChannelMap map = parse("position = 'q'\ntorque = {source = 'tau', unit = 'mN m'}");
  EXPECT_EQ(map.torque[0].unit, "mN m");
}

// Files of an older kind say the factor of a unit, and that of "deg" must not count twice.
TEST(Channels, AScaleThatIsTheUnitsOwnFactorIsRefused) {
  for (const char* scale : {"0.01745", "-0.0174532925"}) {
    EXPECT_THAT(refusal(std::string("position = {source = 'a', unit = 'deg', scale = ") + scale +
                        "}\ntorque = 'tau'"),
                AllOf(HasSubstr("beside unit \"deg\""), HasSubstr("leave the scale out")));
  }
}

TEST(Channels, ColumnsHaveNumbersToo) {
  const ChannelMap map = parse("time = 1\nposition = [2]\ntorque = {source = 4, scale = 2}");
  EXPECT_EQ(map.time.source, "1");
  EXPECT_EQ(map.position[0].source, "2");
  EXPECT_EQ(map.torque[0].source, "4");
}

TEST(Channels, APeriodTakesThePlaceOfTheTime) {
  EXPECT_EQ(parse("period_s = 0.004\nposition = 'a'\ntorque = 'b'").period_s, 0.004);
  EXPECT_THAT(refusal("period_s = 0.004\ntime = 't'\nposition = 'a'\ntorque = 'b'"),
              AllOf(HasSubstr("line 2, channels.time"), HasSubstr("beside period_s")));
  EXPECT_THAT(refusal("period_s = 0\nposition = 'a'\ntorque = 'b'"),
              AllOf(HasSubstr("channels.period_s"), HasSubstr("more than 0")));
}

TEST(Channels, EveryFileOfARecordingMayHaveATimeOfItsOwn) {
  const ChannelMap map =
      parse("time = ['t', {source = 'stamp', unit = 'ms'}]\nposition = 'a'\ntorque = '2:b'");
  EXPECT_EQ(map.time.source, "t");
  ASSERT_EQ(map.more_times.size(), 1U);
  EXPECT_EQ(map.more_times[0].unit, "ms");
  EXPECT_THAT(refusal("time = []\nposition = 'a'\ntorque = 'b'"), HasSubstr("an empty list"));
}

TEST(Channels, AChannelMayBeASumOfColumns) {
  const ChannelMap map =
      parse("position = {sum = ['a', {source = 'b', scale = -0.5}], unit = 'deg'}\ntorque = 'tau'");
  ASSERT_EQ(map.position[0].sum.size(), 2U);
  EXPECT_EQ(map.position[0].sum[0].source, "a");
  EXPECT_EQ(map.position[0].sum[1].scale, -0.5);
  EXPECT_THAT(refusal("position = {sum = ['a']}\ntorque = 'tau'"),
              AllOf(HasSubstr("channels.position.sum"), HasSubstr("fewer than two terms")));
  EXPECT_THAT(refusal("position = {source = 'c', sum = ['a', 'b']}\ntorque = 'tau'"),
              HasSubstr("a source beside a sum"));
  EXPECT_THAT(refusal("position = {sum = ['a', {source = 'b', offset = 1}]}\ntorque = 'tau'"),
              AllOf(HasSubstr("sum[2]"), HasSubstr("\"offset\"")));
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
