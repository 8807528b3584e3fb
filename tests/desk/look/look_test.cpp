#include "look/look.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <tuple>

#include "common/error.hpp"
#include "desk/support/temporary_folder.hpp"
#include "log/read_log.hpp"
#include "look/look_report.hpp"
#include "report/page.hpp"
#include "robot/channels.hpp"
#include "robot/units.hpp"
#include "support/recordings.hpp"

namespace {

using offnominal::desk::Log;
using offnominal::desk::Look;
using offnominal::desk::look_at;
using offnominal::desk::parse_channels;
using offnominal::desk::read_log;
using offnominal::test::put;
using offnominal::test::recordings_dir;
using offnominal::test::TemporaryFolder;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr int kSamples = 1000;
constexpr double kPeriodS = 0.01;
constexpr double kDegrees = 180 / std::numbers::pi;

struct Factors {
  double time = 1;
  double q = 1;
  double dq = 1;
};

// q = sin(2 t) of two joints, the second with half the amplitude.
std::string recording(const std::string& header, const Factors& factors) {
  std::string text = header + "\n";
  for (int i = 0; i < kSamples; ++i) {
    const double t = kPeriodS * i;
    const auto number = [](double value) { return "," + std::to_string(value); };
    text += std::to_string(factors.time * t);
    for (const double scale : {1.0, 0.5}) {
      text += number(factors.q * scale * std::sin(2 * t)) +
              number(factors.dq * scale * 2 * std::cos(2 * t)) + number(3 * scale * std::cos(t));
    }
    text += "\n";
  }
  return text;
}

const std::string kNames = "Time,pos_1,vel_1,torque_1,pos_2,vel_2,torque_2";

class LookTest : public testing::Test {
 protected:
  Look look(const std::string& content) {
    put(folder_ / "a.csv", content);
    return look_at(folder_ / "a.csv", nullptr, std::nullopt);
  }
  // As whoever pastes what is proposed.
  Log read_as(const Look& look) {
    const toml::table whole = toml::parse(channels_text(look));
    return read_log(folder_ / "a.csv", 2,
                    parse_channels(*whole.get("channels")->as_table(), "pasted.toml", 2));
  }
  void expect_motion(const Log& log) {
    ASSERT_EQ(log.sample_count(), kSamples);
    EXPECT_NEAR(log.period_s, kPeriodS, 1e-6);
    for (int i = 0; i < kSamples; i += 37) {
      const double t = kPeriodS * i;
      EXPECT_NEAR(log.q(i, 0), std::sin(2 * t), 1e-5);
      EXPECT_NEAR(log.dq(i, 1), std::cos(2 * t), 1e-5);
      EXPECT_NEAR(log.tau(i, 0), 3 * std::cos(t), 1e-5);
    }
  }

  TemporaryFolder folder_;
};

TEST_F(LookTest, TheChannelsThatItProposesReadTheRecording) {
  const Look seen = look(recording(kNames, {}));
  EXPECT_THAT(seen.missing, IsEmpty());
  EXPECT_THAT(seen.notes, Contains(HasSubstr("vel_1 is 1 times the derivative of pos_1: their")));
  ASSERT_TRUE(seen.sampling);
  EXPECT_NEAR(seen.sampling->median_period_s, kPeriodS, 1e-9);
  expect_motion(read_as(seen));
}

// The times of joined files are read, and no column of the recording any more.
TEST_F(LookTest, JoinedFilesHaveTimesWithNumbers) {
  put(folder_ / "a.csv", recording(kNames, {}));
  put(folder_ / "b.csv", recording("clock,pos_3,vel_3,torque_3,pos_4,vel_4,torque_4", {}));
  const Look seen =
      look_at((folder_ / "a.csv").string() + "+" + (folder_ / "b.csv").string(), nullptr, {});
  EXPECT_THAT(seen.unread, IsEmpty());
  EXPECT_EQ(seen.columns.size(), 12U);
}

TEST_F(LookTest, UnitsThatTheDataShowAreProposedAndSaid) {
  const Look degrees = look(recording(kNames, {1, kDegrees, 30 / std::numbers::pi}));
  EXPECT_THAT(degrees.notes, Contains(HasSubstr("as rpm beside deg")));
  expect_motion(read_as(degrees));
  const Look rates = look(recording(kNames, {1, 1, kDegrees}));
  EXPECT_THAT(rates.notes, Contains(HasSubstr("as deg/s beside rad")));
  expect_motion(read_as(rates));
  const Look milliseconds = look(recording(kNames, {1e3, 1, 1}));
  EXPECT_THAT(milliseconds.notes, Contains(HasSubstr("as a time in ms")));
  expect_motion(read_as(milliseconds));
}

std::string with_units(std::string header, const std::string& time_unit) {
  return header.replace(header.find("Time"), 4, "Time [" + time_unit + "]");
}

TEST_F(LookTest, TimesInMinutesHoursAndDaysAreProposedAndSaid) {
  for (const auto& [unit, seconds] :
       {std::pair{"min", 60.0}, std::pair{"h", 3600.0}, std::pair{"d", 86400.0}}) {
    std::string text = kNames + "\n";
    std::string of_name = with_units(kNames, unit) + "\n";
    for (int i = 0; i < kSamples; ++i) {
      const double t = kPeriodS * i;
      const std::string row =
          fmt::format("{:.12f},{:.9f},{:.9f},{:.9f},{:.9f},{:.9f},{:.9f}\n", t / seconds + 46353.5,
                      std::sin(2 * t), 2 * std::cos(2 * t), 3 * std::cos(t), 0.5 * std::sin(2 * t),
                      std::cos(2 * t), 1.5 * std::cos(t));
      text += row;
      of_name += row;
    }
    const Look seen = look(text);
    EXPECT_THAT(seen.notes,
                Contains(fmt::format("every velocity is 1/{:g} of the derivative of its position: "
                                     "as a time in {}",
                                     seconds, unit)));
    EXPECT_EQ(seen.channels.time.unit, unit);
    EXPECT_EQ(seen.channels.position[0].unit, "");
    EXPECT_NEAR(read_as(seen).period_s, kPeriodS, 1e-5);
    const Look named = look(of_name);
    EXPECT_EQ(named.channels.time.unit, unit);
    EXPECT_THAT(named.notes, Contains(HasSubstr("their units agree")));
    EXPECT_NEAR(read_as(named).period_s, kPeriodS, 1e-5);
  }
}

TEST_F(LookTest, UnitsInNamesAndUnderThemAreTaken) {
  expect_motion(
      read_as(look(recording("t [ms],pos_deg_1,vel_rpm_1,torque_1,pos_deg_2,vel_rpm_2,torque_2",
                             {1e3, kDegrees, 30 / std::numbers::pi}))));
  expect_motion(read_as(look(
      recording(kNames + "\nms,deg,rpm,Nm,deg,rpm,Nm", {1e3, kDegrees, 30 / std::numbers::pi}))));
}

TEST_F(LookTest, ADateAndAClockInTwoColumnsAreTheTime) {
  for (const auto& [header, day, time] : {std::tuple{"date,time", "2026-11-24", "time"},
                                          std::tuple{"Datum,Uhrzeit", "24.11.2026", "Uhrzeit"}}) {
    std::string text = std::string(header) + ",q1,dq1,tau1\n";
    for (int i = 0; i < 200; ++i) {
      text += fmt::format("{},12:00:0{}.{:02},{},{},1\n", day, i / 100, i % 100, 0.01 * i, 1.0);
    }
    const Look seen = look(text);
    ASSERT_TRUE(seen.is_complete()) << header;
    EXPECT_EQ(seen.channels.time.source, time);
    ASSERT_TRUE(seen.t_s);
    EXPECT_NEAR((*seen.t_s)[199] - (*seen.t_s)[0], 1.99, 1e-9);
  }
}

TEST_F(LookTest, TorquesInOtherSpellingsOfTheirUnitsAreTaken) {
  const auto header = [](const std::string& unit) {
    std::string names = "t,pos_1,vel_1,torque_1*,pos_2,vel_2,torque_2*";
    for (auto at = names.find('*'); at != std::string::npos; at = names.find('*')) {
      names.replace(at, 1, unit);
    }
    return names;
  };
  for (const char* unit : {"mN m", "mN\u00b7m", "Nmm", "N mm", "N cm", "kgf.cm"}) {
    for (const std::string& in_name :
         {" [" + std::string(unit) + "]", "(" + std::string(unit) + ")"}) {
      const Look seen = look(recording(header(in_name), {}));
      ASSERT_TRUE(seen.is_complete()) << in_name;
      EXPECT_EQ(seen.channels.torque.at(1).unit, unit);
      EXPECT_NEAR(read_as(seen).tau(0, 0), 3 * offnominal::desk::unit_factor(unit), 1e-6);
    }
  }
}

TEST_F(LookTest, JointsMayHaveUnitsOfTheirOwn) {
  struct Heads {
    const char *first, *second;  // torques
    const char *unit, *second_unit;
  };
  for (const Heads& heads :
       {Heads{"tau1 [mN m]", "tau2 [N mm]", "mN m", "N mm"},
        Heads{"tau1 [N m]", "tau2 [mN m]", "", "mN m"}, Heads{"tau1_Nm", "tau2_mNm", "", "mNm"},
        Heads{"shoulder torque [N m]", "elbow torque [mN m]", "", "mN m"}}) {
    SCOPED_TRACE(heads.first);
    const bool numbered = std::string(heads.first).starts_with("tau1");
    const Look seen = look(recording(
        fmt::format(
            fmt::runtime(numbered ? "t,q1,dq1,{},q2,dq2,{}"
                                  : "t,shoulder pos,shoulder vel,{},elbow pos,elbow vel,{}"),
            heads.first, heads.second),
        {}));
    ASSERT_TRUE(seen.is_complete());
    EXPECT_EQ(seen.channels.torque.at(0).unit, heads.unit);
    EXPECT_EQ(seen.channels.torque.at(1).unit, heads.second_unit);
    const double factor = offnominal::desk::unit_factor(heads.second_unit);
    EXPECT_NEAR(read_as(seen).tau(0, 1), 1.5 * factor, 1e-6);
  }
}

// The same joints in two units are no joints of one family.
TEST_F(LookTest, AQuantityInTwoUnitsStaysTwoFamilies) {
  const Look seen = look(
      "t,q1 [rad],q2 [rad],q1 [deg],q2 [deg],tau1,tau2\n"
      "0,0,0,0,0,1,1\n0.1,0.01,0.02,0.573,1.146,1,1\n"
      "0.2,0.02,0.04,1.146,2.292,1,1\n");
  ASSERT_EQ(seen.channels.position.size(), 2);
  EXPECT_EQ(seen.channels.position[0].unit, seen.channels.position[1].unit);
  EXPECT_THAT(seen.notes, Contains(HasSubstr("these would do as well")));
}

TEST_F(LookTest, AUnitThatIsNotKnownIsSaid) {
  const std::string words = ": \"furlong\" is no unit that is known: taken as N m";
  const Look named = look(recording("t,q1,dq1,tau1 [furlong],q2,dq2,tau2 [furlong]", {}));
  EXPECT_THAT(named.notes, Contains(HasSubstr("tau1 [furlong], tau2 [furlong]" + words)));
  EXPECT_THAT(read_as(named).remarks, Contains(HasSubstr("column tau2 [furlong]" + words)));
  const Look under = look(recording(kNames + "\ns,rad,rad/s,furlong,rad,rad/s,furlong", {}));
  EXPECT_THAT(under.notes, Contains(HasSubstr("torque_1, torque_2" + words)));
  EXPECT_THAT(read_as(under).remarks, Contains(HasSubstr("column torque_1" + words)));
}

TEST_F(LookTest, WhatCannotBeToldIsAskedFor) {
  const Look nameless = look(recording("a,b,c,d,e,f,g", {}));
  EXPECT_THAT(nameless.missing, Contains(HasSubstr("a column of time")));
  EXPECT_THAT(nameless.missing, Contains(HasSubstr("positions")));
  EXPECT_THAT(channels_text(nameless), HasSubstr("# still to be said: torques or currents"));
  // TOML all the same, and refused.
  EXPECT_THROW(read_as(nameless), offnominal::desk::InputError);
  const Look currents = look(recording("t,q1,dq1,iq1,q2,dq2,iq2", {}));
  EXPECT_THAT(currents.missing, Contains(HasSubstr("the torque constants of the motors")));
}

// Read, a column of nothing would cost every row.
TEST_F(LookTest, AColumnWithoutANumberIsTakenForNothing) {
  std::string text = "t,q1,dq1,tau1\n";
  for (int i = 0; i < kSamples; ++i) {
    const double t = kPeriodS * i;
    text += std::to_string(t) + "," + std::to_string(std::sin(t)) + ",," +
            std::to_string(std::cos(t)) + "\n";
  }
  put(folder_ / "r.csv", text);
  const Look look = look_at(folder_ / "r.csv", nullptr, std::nullopt);
  EXPECT_TRUE(look.is_complete());
  EXPECT_FALSE(look.channels.velocity.at(0).has_value());
  const std::string shown = text_of(look);
  EXPECT_THAT(shown, HasSubstr("dq1: 1000 of 1000 values are not finite\n"));
  EXPECT_THAT(shown, testing::ContainsRegex("dq1 +none +none"));
  const auto json = to_json(look);
  EXPECT_EQ(json["columns"][2]["taken_for"], "");
  EXPECT_TRUE(std::isnan(json["columns"][2]["low"].get<double>()));
}

TEST_F(LookTest, ATimeThatIsNoneIsNoEpochAndSaysHowFarWasRead) {
  std::string none = "t,q1,tau1\n";
  std::string back = none;
  for (int i = 0; i < kSamples; ++i) {
    none += "nan,1,2\n";
    back += std::to_string(-i) + ",1,2\n";
  }
  put(folder_ / "none.csv", none);
  put(folder_ / "back.csv", back);
  const std::string of_none = text_of(look_at(folder_ / "none.csv", nullptr, std::nullopt));
  EXPECT_THAT(of_none, testing::Not(HasSubstr("since 1970")));
  EXPECT_THAT(text_of(look_at(folder_ / "back.csv", nullptr, std::nullopt)),
              HasSubstr("note: read as far as line 13: in 11 lines the time is not later than "
                        "before\n"));
}

// Loop times, temperatures, elements of a pose: what is called like a time is none beside it.
TEST_F(LookTest, OnlyTheColumnThatIsTheTimeHasToAscend) {
  const std::string names = "exec_time,time,pos_1,vel_1,torque_1,T1,T_a,O_T_EE[0],time_left,note_t";
  std::string text = names + "\n";
  for (int i = 0; i < kSamples; ++i) {
    const double t = kPeriodS * i;
    text += std::to_string(i % 7) + "," + std::to_string(t) + "," +
            std::to_string(std::sin(2 * t)) + "," + std::to_string(2 * std::cos(2 * t)) + "," +
            std::to_string(3 * std::cos(t)) + ",35," + std::to_string(i % 3) + ",1," +
            std::to_string(10 - t) + ",idle\n";
  }
  const Look seen = look(text);
  EXPECT_TRUE(seen.is_complete());
  EXPECT_THAT(seen.remarks, IsEmpty());
  EXPECT_EQ(seen.channels.time.source, "time");
  ASSERT_TRUE(seen.t_s);
  EXPECT_EQ(seen.t_s->size(), kSamples);
  const auto json = to_json(seen);
  const auto& columns = json["columns"];
  EXPECT_EQ(std::count_if(columns.begin(), columns.end(),
                          [](const auto& column) { return column["taken_for"] == "time"; }),
            1);
}

TEST_F(LookTest, OneRowIsTooFewAndHasATimeAllTheSame) {
  const Look seen = look("t,q1,tau1\n0,1,2\n");
  EXPECT_THAT(seen.missing, testing::ElementsAre("more samples: the file has one row of numbers"));
}

TEST_F(LookTest, ADurationIsATime) {
  const Look seen = look(recording("duration,q0,dq0,tau0,q1,dq1,tau1", {}));
  EXPECT_TRUE(seen.is_complete());
  EXPECT_EQ(seen.channels.time.source, "duration");
}

TEST_F(LookTest, WhatIsCalledATimeAndIsNoneIsSaid) {
  const Look seen = look("stamp,q1,tau1\n10:00:00.5,1,2\n10:00:00.6,2,3\n");
  EXPECT_THAT(seen.remarks, Contains(HasSubstr("column stamp: \"10:00:00.5\" is no time in s")));
  EXPECT_THAT(seen.missing, Contains(HasSubstr("a column of time")));
}

TEST_F(LookTest, ThePageHasEveryChannelAndTheAnswerInJsonEveryColumn) {
  const Look seen = look(recording(kNames, {}));
  const auto page = to_json(page_of(seen, "offnominal look a.csv"));
  EXPECT_EQ(page.at("sections").at(1).at("blocks").size(), 7U);
  const auto json = to_json(seen);
  EXPECT_EQ(json.at("columns").size(), 7U);
  EXPECT_EQ(json.at("columns").at(1).at("taken_for"), "position");
  EXPECT_EQ(json.at("time").at("samples"), kSamples);
  EXPECT_THAT(text_of(seen), HasSubstr("[channels]\ntime = {source = \"Time\"}"));
}

TEST_F(LookTest, AnIndustrialArmsStructuresAreFound) {
  const auto file = recordings_dir() / "kuka_kr300" / "A.mat";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no recording at " << file;
  const Look seen = look_at(file, nullptr, std::nullopt);
  ASSERT_EQ(seen.channels.position.size(), 6U);
  // Of the two encoders the one that moves on every axis, and the velocities that go with it.
  EXPECT_EQ(seen.channels.position[2].source, "rec.act_pos_mot_deg(3,:)");
  EXPECT_EQ(seen.channels.velocity[2]->source, "rec.act_vel_mot_deg_per_s(3,:)");
  EXPECT_EQ(seen.channels.position[2].unit, "deg");
  EXPECT_EQ(seen.channels.torque[5].source, "rec.act_torque_abs_nm(6,:)");
  EXPECT_EQ(seen.channels.time.source, "rec.time_cont");
}

}  // namespace
