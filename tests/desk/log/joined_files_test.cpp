// One recording in several files: positions here, currents there.

#include "log/joined_files.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>
#include <string>

#include "common/error.hpp"
#include "common/input_name.hpp"
#include "desk/support/temporary_file.hpp"
#include "desk/support/temporary_folder.hpp"
#include "log/read_log.hpp"
#include "robot/channels.hpp"

namespace {

using offnominal::desk::ChannelMap;
using offnominal::desk::InputError;
using offnominal::desk::Log;
using offnominal::desk::parse_channels;
using offnominal::desk::read_log;
using offnominal::test::message_of;
using offnominal::test::put;
using offnominal::test::TemporaryFolder;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;

// Rows of time and a line through (0, `at`) of that slope.
std::string ramp(const std::string& header, double from_s, double to_s, double period_s, double at,
                 double slope) {
  std::string text = header + "\n";
  for (int i = 0; from_s + i * period_s <= to_s + 1e-9; ++i) {
    const double t = from_s + i * period_s;
    text += std::to_string(t) + "," + std::to_string(at + slope * t) + "\n";
  }
  return text;
}

class JoinedFiles : public testing::Test {
 protected:
  Log read(const std::string& channels = {}) {
    std::optional<ChannelMap> map;
    if (!channels.empty()) map = parse_channels(toml::parse(channels), "robot.toml", 1);
    return read_log(path("a.csv") + "+" + path("b.csv"), 1, map);
  }
  std::string refusal(const std::string& channels = {}) {
    try {
      read(channels);
    } catch (const InputError& error) {
      return error.what();
    }
    ADD_FAILURE() << "nothing was thrown";
    return {};
  }
  std::string path(const std::string& name) { return (folder_ / name).string(); }

  TemporaryFolder folder_;
};

TEST_F(JoinedFiles, LieOnTheSamplesOfTheFirst) {
  put(folder_ / "a.csv", ramp("t,q1", 0, 1, 0.01, 1, 2));
  put(folder_ / "b.csv", ramp("t,tau1", 0.205, 0.8, 0.007, 5, -3));
  const Log log = read();
  ASSERT_EQ(log.sample_count(), 60);
  EXPECT_NEAR(log.t_s[0], 0.21, 1e-12);
  EXPECT_NEAR(log.t_s[59], 0.8, 1e-12);
  for (int i = 0; i < log.sample_count(); ++i) {
    EXPECT_NEAR(log.q(i, 0), 1 + 2 * log.t_s[i], 1e-6);
    EXPECT_NEAR(log.tau(i, 0), 5 - 3 * log.t_s[i], 2e-6);
  }
  EXPECT_THAT(log.remarks,
              Contains(AllOf(HasSubstr("2 files joined"), HasSubstr("60 of its 101"))));
}

TEST_F(JoinedFiles, MayHaveTimesAndNamesOfTheirOwn) {
  put(folder_ / "a.csv", ramp("t,value", 100, 101, 0.01, 1, 2));
  put(folder_ / "b.csv", ramp("stamp,value", 0, 1000, 10, 5, -0.003));
  const Log log = read(
      "time = ['t', {source = 'stamp', unit = 'ms', offset = 100}]\n"
      "position = '1:value'\ntorque = {source = '2:value', scale = 2}");
  ASSERT_EQ(log.sample_count(), 101);
  EXPECT_NEAR(log.q(50, 0), 1 + 2 * 100.5, 1e-6);
  EXPECT_NEAR(log.tau(50, 0), 2 * (5 - 0.003 * 500), 1e-5);
}

TEST_F(JoinedFiles, AreRefusedWhereTheirClocksDoNotOverlap) {
  put(folder_ / "a.csv", ramp("t,q1", 0, 1, 0.01, 1, 2));
  put(folder_ / "b.csv", ramp("t,tau1", 500, 501, 0.01, 5, 0));
  EXPECT_THAT(refusal(), AllOf(HasSubstr("0 to 1 s in " + path("a.csv")),
                               HasSubstr("500 to 501 s in " + path("b.csv")), HasSubstr("offset")));
  put(folder_ / "b.csv", ramp("t,tau1", 0.95, 2, 0.01, 5, 0));
  EXPECT_THAT(refusal(), HasSubstr("too few samples"));
}

TEST_F(JoinedFiles, NameTheTimesAsTheyAreReadWhereTheirClocksDoNotOverlap) {
  const std::string channels = "time = ['t', 'stamp']\nposition = '1:value'\ntorque = '2:value'";
  put(folder_ / "a.csv", ramp("t,value", 0, 1, 0.01, 1, 2));
  put(folder_ / "b.csv", ramp("stamp,value", 500, 501, 0.01, 5, 0));
  EXPECT_THAT(refusal(channels),
              HasSubstr("where the clocks differ, say by how much: [channels] with time = "
                        "[{source = \"t\"}, {source = \"stamp\", offset = ... }]"));
  // In ms, at 80 samples where the first has 100.
  put(folder_ / "b.csv", ramp("stamp,value", 12500, 13500, 12.5, 5, 0));
  EXPECT_THAT(refusal(channels),
              AllOf(HasSubstr("say its unit: the time of " + path("b.csv") +
                              " lasts 1000 times as long as that of " + path("a.csv") +
                              ", as one in ms does: [channels] with time = [{source = \"t\"}, "
                              "{source = \"stamp\", unit = \"ms\"}]"),
                    HasSubstr("offset = ...")));
  put(folder_ / "a.csv", ramp("t,value", 12500, 13500, 12.5, 1, 2));
  put(folder_ / "b.csv", ramp("stamp,value", 0, 1, 0.01, 5, 0));
  EXPECT_THAT(refusal(channels),
              HasSubstr("[{source = \"t\", unit = \"ms\"}, {source = \"stamp\"}]"));
  // As long, and no steps of ms: a slow sensor that went on.
  put(folder_ / "a.csv", ramp("t,value", 0, 1, 0.01, 1, 2));
  put(folder_ / "b.csv", ramp("stamp,value", 500, 1500, 1, 5, 0));
  EXPECT_THAT(refusal(channels), HasSubstr("where the clocks differ"));
}

TEST_F(JoinedFiles, HaveAGapWhereTheSecondHasOne) {
  put(folder_ / "a.csv", ramp("t,q1", 0, 1, 0.01, 1, 2));
  put(folder_ / "b.csv",
      ramp("t,tau1", 0, 0.4, 0.01, 5, 0) + ramp("", 0.6, 1, 0.01, 5, 0).substr(1));
  const Log log = read();
  EXPECT_EQ(log.sample_count(), 101);
  ASSERT_EQ(log.gaps.size(), 1U);
  EXPECT_EQ(log.gaps[0].first, 41);
  EXPECT_EQ(log.gaps[0].last, 59);
  EXPECT_EQ(log.recorded_rows(log.gaps[0]).first, 41);
  EXPECT_EQ(log.recorded_rows(log.gaps[0]).last, 59);
  EXPECT_THAT(log.remarks, Contains(AllOf(HasSubstr("b.csv has 1 gap"), HasSubstr("0.2 s"),
                                          HasSubstr("line 42"))));
}

TEST_F(JoinedFiles, DoWithoutARowThatHasNoNumber) {
  put(folder_ / "a.csv", ramp("t,q1", 0, 1, 0.01, 1, 2));
  put(folder_ / "b.csv",
      ramp("t,tau1", 0, 0.4, 0.01, 5, 0) + "0.41,nan\n" + ramp("", 0.42, 1, 0.01, 5, 0).substr(1));
  const Log log = read();
  EXPECT_EQ(log.sample_count(), 101);
  EXPECT_TRUE(log.gaps.empty());
  EXPECT_NEAR(log.tau(41, 0), 5, 1e-9);
}

TEST_F(JoinedFiles, AreRefusedWhereBothHaveAColumnThatIsWanted) {
  put(folder_ / "a.csv", ramp("t,q1", 0, 1, 0.01, 1, 2));
  put(folder_ / "b.csv", ramp("t,q1", 0, 1, 0.01, 1, 2));
  EXPECT_THAT(refusal("position = 'q1'\ntorque = '2:q1'"),
              AllOf(HasSubstr("1:t, 1:q1, 2:t, 2:q1"), HasSubstr("position of joint 1")));
}

TEST_F(JoinedFiles, SayThatAColumnIsTheTimeAlready) {
  put(folder_ / "a.csv", ramp("t,q1", 0, 1, 0.01, 1, 2));
  put(folder_ / "b.csv", ramp("t,tau1", 0, 1, 0.01, 1, 2));
  EXPECT_THAT(refusal("time = ['t', 't']\nposition = '1:t'\ntorque = 'tau1'"),
              AllOf(HasSubstr("column 1:t: found the same column for two quantities"),
                    HasSubstr("position of joint 1")));
}

TEST_F(JoinedFiles, UnfoldAnglesBeforeTheyDrawLines) {
  put(folder_ / "a.csv", ramp("t,tau1", 0, 4, 0.013, 1, 2));
  std::string text = "t,q1\n";
  for (int i = 0; i <= 400; ++i) {
    const double q = 0.05 * i;
    text += std::to_string(0.01 * i) + "," +
            std::to_string(std::remainder(q, 2 * std::numbers::pi)) + "\n";
  }
  put(folder_ / "b.csv", text);
  const Log log = read();
  for (int i = 0; i < log.sample_count(); ++i) {
    EXPECT_NEAR(log.q(i, 0), 5 * log.t_s[i], 1e-4) << i;
  }
  EXPECT_THAT(log.remarks, Contains(HasSubstr("unfolded before it was joined")));
}

TEST_F(JoinedFiles, OneThatIsMissingSaysThatAPlusJoins) {
  EXPECT_THAT(message_of<InputError>(
                  [&] { static_cast<void>(read_log(folder_ / "run+1.csv", 1, std::nullopt)); }),
              AllOf(HasSubstr("run: found no such file"),
                    HasSubstr("run+1.csv was read as files that + joins")));
}

TEST_F(JoinedFiles, AFileWhoseNameHasAPlusIsOne) {
  put(folder_ / "a+b.csv", "t,q1,tau1\n");
  EXPECT_EQ(offnominal::desk::recording_files(folder_ / "a+b.csv").size(), 1U);
  EXPECT_EQ(offnominal::desk::recording_files(path("a.csv") + "+" + path("b.csv")).size(), 2U);
  EXPECT_EQ(offnominal::desk::recording_files("+").size(), 1U);
  EXPECT_EQ(offnominal::desk::input_name(path("a.csv") + "+" + path("b.csv")), "a.csv+b.csv");
}

}  // namespace
