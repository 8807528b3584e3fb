#include "log/hold_map.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "common/error.hpp"
#include "desk/support/temporary_file.hpp"
#include "log/read_log.hpp"
#include "robot/channels.hpp"

namespace {

using Eigen::VectorXd;
using offnominal::desk::approach_direction;
using offnominal::desk::ChannelMap;
using offnominal::desk::InputError;
using offnominal::desk::Log;
using offnominal::desk::parse_channels;
using offnominal::desk::read_log;
using offnominal::test::message_of;
using offnominal::test::TemporaryFile;
using ::testing::AllOf;
using ::testing::HasSubstr;

VectorXd values(std::initializer_list<double> list) {
  return Eigen::Map<const VectorXd>(list.begin(), static_cast<Eigen::Index>(list.size()));
}

TEST(ApproachDirection, TurnsAfterTheFurthestReading) {
  EXPECT_EQ(approach_direction(values({0, 1, 2, 3, 2, 1, 0}), 0.5),
            values({1, 1, 1, 1, -1, -1, -1}));
  EXPECT_EQ(approach_direction(values({0, -1, -2, -1, 0, -1, -2}), 0.5),
            values({-1, -1, -1, 1, 1, -1, -1}));
}

TEST(ApproachDirection, JitterIsNoReversal) {
  EXPECT_EQ(approach_direction(values({0, 1, 0.8, 1.1, 2, 1.9, 3}), 0.5), VectorXd::Ones(7));
}

TEST(ApproachDirection, IsZeroOfAJointThatNeverMoves) {
  EXPECT_EQ(approach_direction(VectorXd::Ones(5), 0.5), VectorXd::Zero(5));
}

constexpr const char* kAtRest =
    "at_rest = true\nposition = 'angle'\ntorque = {source = 'i', scale = 0.5, unit = 'A'}";

ChannelMap at_rest(const std::string& more = {}) {
  return parse_channels(toml::parse(kAtRest + ("\n" + more)), "map.toml", 1);
}

std::string readings(int count, int odd = -1) {
  std::string text = "angle,i\n";
  for (int i = 0; i < count; ++i) {
    text += std::to_string(0.01 * (i % 100)) + (i == odd ? ",nan\n" : ",2\n");
  }
  return text;
}

std::string refusal(const std::string& csv) {
  const TemporaryFile file("map.csv", csv);
  return message_of<InputError>([&] { read_log(file.path(), 1, at_rest()); });
}

TEST(HoldMapFile, HasNoTime) {
  const TemporaryFile file("map.csv", readings(300));
  const Log log = read_log(file.path(), 1, at_rest());
  EXPECT_TRUE(log.at_rest);
  ASSERT_EQ(log.sample_count(), 300);
  EXPECT_EQ(log.tau(17, 0), 1);
  EXPECT_EQ(log.dq.cwiseAbs().maxCoeff(), 0);
  EXPECT_EQ(log.t_s[299], 299);
  EXPECT_EQ(log.approach(50, 0), 1);
}

TEST(HoldMapFile, DoesWithoutAReadingThatIsNone) {
  const TemporaryFile file("map.csv", readings(300, 7));
  const Log log = read_log(file.path(), 1, at_rest());
  EXPECT_EQ(log.sample_count(), 299);
  EXPECT_THAT(log.remarks, testing::Contains(HasSubstr("line 9")));
}

TEST(HoldMapFile, WrongOnesAreRefused) {
  EXPECT_THAT(refusal(readings(199)), AllOf(HasSubstr("199 readings"), HasSubstr("200")));
  EXPECT_THAT(refusal("angle,tau\n" + readings(300).substr(8)),
              HasSubstr("a column \"i\" for the torque of joint 1"));
}

TEST(HoldMapFile, NothingThatNeedsTimeStandsBesideIt) {
  for (const char* more : {"time = 't'", "velocity = 'v'", "extra = {temp1 = 'T'}"}) {
    EXPECT_THAT(message_of<InputError>([&] { at_rest(more); }), HasSubstr("at_rest = true"));
  }
  EXPECT_THAT(message_of<InputError>([] {
                parse_channels(toml::parse("at_rest = 1\nposition = 'q'\ntorque = 'i'"), "r", 1);
              }),
              HasSubstr("true or false"));
}

}  // namespace
