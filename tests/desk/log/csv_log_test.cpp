#include "log/csv_log.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>

#include "common/error.hpp"
#include "desk/support/temporary_file.hpp"
#include "log/read_log.hpp"

namespace {

using offnominal::desk::Channel;
using offnominal::desk::ChannelMap;
using offnominal::desk::InputError;
using offnominal::desk::Log;
using offnominal::desk::read_log;
using offnominal::test::message_of;
using offnominal::test::TemporaryFile;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;

// `lines` samples of q = t^2 at 100 Hz; `change` may alter the text of one line (from 2).
template <typename Change>
std::string one_joint_csv(int lines, Change&& change, const std::string& end = "\n") {
  std::string text = "t,q1,dq1,tau1" + end;
  for (int i = 0; i < lines; ++i) {
    const double t = 0.01 * i;
    std::string line = std::to_string(t) + "," + std::to_string(t * t) + "," +
                       std::to_string(2 * t) + "," + std::to_string(5 - i);
    change(i + 2, line);
    text += line + end;
  }
  return text;
}
const auto kAsIs = [](int, std::string&) {};

Log read(const std::string& content, int joints = 1,
         const std::optional<ChannelMap>& channels = std::nullopt) {
  const TemporaryFile file("log.csv", content);
  return read_log(file.path(), joints, channels);
}
std::string refusal(const std::string& content, int joints = 1) {
  return message_of<InputError>([&] { read(content, joints); });
}

TEST(CsvLog, WithoutATorqueItSaysThatThereIsNone) {
  EXPECT_THAT(refusal("t,q1,dq1\n0,0,0\n1,0,0\n"),
              AllOf(HasSubstr("columns: found t, q1, dq1, and no torque; allowed: tau1..tau1, or "
                              "torques or currents by other names; to mend: map the names"),
                    HasSubstr("record them too")));
}

TEST(CsvLog, CommonHeaderIsReadInAnyOrderWithExtras) {
  std::string text = "tau1,temp1,t,q1,note\n";
  for (int i = 0; i < 12; ++i) {
    text += std::to_string(i) + ",20.5," + std::to_string(0.1 * i) + ",0.25,start\n";
  }
  const Log log = read(text);
  EXPECT_EQ(log.sample_count(), 12);
  EXPECT_NEAR(log.period_s, 0.1, 1e-12);
  EXPECT_EQ(log.tau(11, 0), 11);
  EXPECT_EQ(log.q(3, 0), 0.25);
  ASSERT_TRUE(log.extra.contains("temp1"));
  EXPECT_EQ(log.extra.at("temp1")[5], 20.5);
  EXPECT_FALSE(log.extra.contains("note"));
  ASSERT_EQ(log.dq_derived.size(), 1U);
  EXPECT_TRUE(log.dq_derived[0]);
  EXPECT_THAT(log.remarks, testing::Contains(HasSubstr("position of joint 1 never changes")));
}

TEST(CsvLog, AVelocityThatNeverChangesIsRemarkedAsAPositionIs) {
  std::string text = "t,q1,q2,dq1,tau1,tau2\n";
  for (int i = 0; i < 10; ++i) {
    const std::string number = std::to_string(i);
    text += number + "," + number + ",1,0," + number + "," + number + "\n";
  }
  EXPECT_THAT(read(text, 2).remarks,
              testing::ElementsAre("the position of joint 2 never changes: it is 1 throughout",
                                   "the velocity of joint 1 never changes: it is 0 throughout"));
}

TEST(CsvLog, TwoJointsKeepTheirOrder) {
  std::string text = "t,q2,q1,dq1,tau1,tau2\n";
  for (int i = 0; i < 10; ++i) text += std::to_string(i) + ",2,1,7,10,20\n";
  const Log log = read(text, 2);
  EXPECT_EQ(log.q(0, 0), 1);
  EXPECT_EQ(log.q(0, 1), 2);
  EXPECT_EQ(log.tau(9, 1), 20);
  EXPECT_EQ(log.dq(4, 0), 7);
  EXPECT_FALSE(log.dq_derived[0]);
  EXPECT_TRUE(log.dq_derived[1]);
}

TEST(CsvLog, QuotesSpacesSeparatorsAndLineEndsAreUnderstood) {
  const Log plain = read(one_joint_csv(20, kAsIs));
  const Log dos = read("\xEF\xBB\xBF" + one_joint_csv(20, kAsIs, "\r\n"));
  EXPECT_EQ(plain.tau, dos.tau);
  std::string semicolons = one_joint_csv(20, [](int, std::string& line) {
    line = "\"" + line.substr(0, line.find(',')) + "\" " + line.substr(line.find(','));
  });
  std::replace(semicolons.begin(), semicolons.end(), ',', ';');
  EXPECT_EQ(read(semicolons).q, plain.q);
  EXPECT_EQ(read(one_joint_csv(20, kAsIs) + "\n\n").q, plain.q) << "blank lines at the end";
}

TEST(CsvLog, MissingVelocityIsTheDerivativeOfThePosition) {
  std::string text = "t,q1,tau1\n";
  for (int i = 0; i < 1000; ++i) {
    const double t = 0.001 * i;
    text += std::to_string(t) + "," + std::to_string(std::sin(6 * t)) + ",0\n";
  }
  const Log log = read(text);
  for (const Eigen::Index i : {100, 500, 900}) {
    EXPECT_NEAR(log.dq(i, 0), 6 * std::cos(6 * log.t_s[i]), 2e-3);
  }
}

TEST(CsvLog, ChannelsScaleAndShift) {
  std::string text = "time_ms;pos_deg;current;gain\n";
  for (int i = 0; i < 10; ++i) text += std::to_string(10 * i) + ";180;2;0.5\n";
  ChannelMap map;
  map.time = {"time_ms", 1, 0, "", "ms"};
  map.position = {{"pos_deg", 1, 1, "", "deg"}};
  map.velocity = {std::nullopt};
  map.torque = {{"current", 3000, 0.25, "gain", "mA"}};
  const Log log = read(text, 1, map);
  EXPECT_NEAR(log.period_s, 0.01, 1e-15);
  EXPECT_NEAR(log.q(0, 0), 3.141592653589793 + 1, 1e-14);
  EXPECT_NEAR(log.tau(0, 0), 3 * 0.5 * 2 + 0.25, 1e-15);
}

TEST(CsvLog, TextInANumberNamesLineAndColumn) {
  EXPECT_THAT(refusal(one_joint_csv(20,
                                    [](int number, std::string& line) {
                                      if (number == 7) line = "0.05,oops,1,2";
                                    })),
              AllOf(HasSubstr("log.csv: line 7, column q1"), HasSubstr("\"oops\"")));
}

// One bad row costs that row, and the others keep their numbers.
TEST(CsvLog, ARowWithoutANumberIsLeftOutAndSaidSo) {
  for (const char* bad : {"0.3,1,,2", "0.3,nan,1,2", "0.3,1,2,inf", "0.3,NA,1,2", "0.3,1,2,"}) {
    const Log log = read(one_joint_csv(60, [bad](int number, std::string& line) {
      if (number == 32) line = bad;
    }));
    EXPECT_EQ(log.sample_count(), 60) << bad;
    EXPECT_TRUE(log.q.allFinite() && log.dq.allFinite() && log.tau.allFinite()) << bad;
    EXPECT_NEAR(log.q(30, 0), 0.09, 1e-3) << bad;
    EXPECT_THAT(log.remarks, Contains(AllOf(HasSubstr("1 row without a number is left out"),
                                            HasSubstr("line 32"))))
        << bad;
    EXPECT_EQ(log.recorded_rows({40, 40}).first, 40) << bad;
  }
}

TEST(CsvLog, ManyRowsWithoutANumberAreAGap) {
  const Log log = read(one_joint_csv(200, [](int number, std::string& line) {
    if (number >= 52 && number < 72) line = std::to_string(0.01 * (number - 2)) + ",nan,nan,nan";
  }));
  EXPECT_EQ(log.sample_count(), 200);
  ASSERT_EQ(log.gaps.size(), 1U);
  EXPECT_EQ(log.gaps[0].first, 50);
  EXPECT_EQ(log.gaps[0].last, 69);
  EXPECT_EQ(log.recorded_rows(log.gaps[0]).first, 50);
  EXPECT_EQ(log.recorded_rows(log.gaps[0]).last, 69);
  EXPECT_EQ(log.recorded_rows({100, 100}).first, 100);
}

TEST(CsvLog, MostRowsWithoutANumberAreRefused) {
  EXPECT_THAT(refusal(one_joint_csv(40,
                                    [](int number, std::string& line) {
                                      if (number > 15) line = line.substr(0, 9) + "nan,1,2";
                                    })),
              AllOf(HasSubstr("line 16, position of joint 1"), HasSubstr("NaN")));
}

TEST(CsvLog, ABlankLineBetweenSamplesIsLeftOut) {
  const Log log = read(one_joint_csv(20, [](int number, std::string& line) {
    if (number == 4) line = "\n" + line;
  }));
  EXPECT_EQ(log.sample_count(), 20);
  EXPECT_THAT(log.remarks, Contains(AllOf(HasSubstr("1 blank line"), HasSubstr("line 4"))));
}

// GIVEN a file that its writer could not finish THEN it is read up to its last whole line, wherever
// in the next one it ends.
TEST(CsvLog, ALastLineThatIsCutOffIsLeftOutAndSaidSo) {
  const std::string whole = one_joint_csv(20, kAsIs);
  const std::string next = "0.2,0.04,0.4,7";
  for (std::size_t length = 0; length < next.size(); ++length) {
    const Log log = read(whole + next.substr(0, length));
    EXPECT_EQ(log.sample_count(), 20) << length;
    EXPECT_EQ(log.remarks.size(), length == 0 ? 0U : 1U) << length;
  }
  EXPECT_EQ(read(whole + next).sample_count(), 21) << "nothing is missing but its end";
  EXPECT_THAT(refusal(whole + "0.2,0.04\n"), HasSubstr("2 values"));
}

TEST(CsvLog, ALastNumberThatIsOnlyBegunIsLeftOutToo) {
  const std::string whole = one_joint_csv(20, kAsIs);
  for (const char* begun : {"-", "1.2e", "1.2e-"}) {
    const Log log = read(whole + "0.2,0.04,0.4," + begun);
    EXPECT_EQ(log.sample_count(), 20) << begun;
    EXPECT_EQ(log.remarks.size(), 1U) << begun;
  }
  EXPECT_THAT(refusal(whole + "0.2,0.04,0.4,x"), HasSubstr("line 22"));
}

TEST(CsvLog, RaggedLinesAreRefused) {
  EXPECT_THAT(refusal(one_joint_csv(20,
                                    [](int number, std::string& line) {
                                      if (number == 4) line += ",1";
                                    })),
              AllOf(HasSubstr("line 4"), HasSubstr("5 values"), HasSubstr("allowed: 4")));
  EXPECT_THAT(refusal(one_joint_csv(20,
                                    [](int number, std::string& line) {
                                      if (number == 4) line = "0.02";
                                    })),
              AllOf(HasSubstr("line 4"), HasSubstr("1 value;")));
  EXPECT_THAT(refusal(one_joint_csv(20,
                                    [](int number, std::string& line) {
                                      if (number == 4) line = "0.02,1,2,3,";
                                    })),
              AllOf(HasSubstr("line 4"), HasSubstr("5 values")));
  EXPECT_THAT(refusal(one_joint_csv(20,
                                    [](int number, std::string& line) {
                                      if (number == 4) line = "\"0.02,1,2,3";
                                    })),
              AllOf(HasSubstr("line 4"), HasSubstr("quote")));
}

TEST(CsvLog, HeaderMistakesAreRefused) {
  EXPECT_THAT(refusal(""), HasSubstr("an empty file"));
  EXPECT_THAT(refusal("t,q1,tau1\n"), HasSubstr("without samples"));
  EXPECT_THAT(refusal("0.0,1.0,2.0\n0.1,1,2\n"), HasSubstr("header line"));
  EXPECT_THAT(refusal("t,q1,,tau1\n0,1,2,3\n"), HasSubstr("column 3: found no name"));
  EXPECT_THAT(refusal("t,q1,q1,tau1\n0,1,2,3\n"),
              HasSubstr("column \"q1\" twice; allowed: names that differ; to mend: rename column 2 "
                        "or column 3 in the header, or leave one of them out"));
}

TEST(CsvLog, MissingColumnsAreListedWithThoseThatAreThere) {
  EXPECT_THAT(refusal("time,pos,effort\n0,1,2\n"),
              AllOf(HasSubstr("time, pos, effort"), HasSubstr("--channels")));
  std::string text = "q1,tau1\n";
  for (int i = 0; i < 10; ++i) text += "1,2\n";
  EXPECT_THAT(refusal(text), AllOf(HasSubstr("q1, tau1"), HasSubstr("\"t\" for the time")));
}

TEST(CsvLog, NumberOfJointsMustBeTheRobots) {
  EXPECT_THAT(refusal(one_joint_csv(20, kAsIs), 2),
              AllOf(HasSubstr("q1 only"), HasSubstr("2 joints")));
  std::string text = "t,q1,q2,tau1,tau2\n";
  for (int i = 0; i < 10; ++i) text += std::to_string(i) + ",1,1,1,1\n";
  EXPECT_THAT(refusal(text, 1), AllOf(HasSubstr("q1 to q2"), HasSubstr("1 joint"),
                                      HasSubstr("or say with [channels] which columns are")));
  text = "t,q1,q2,q3,tau1,tau3\n";
  for (int i = 0; i < 10; ++i) text += std::to_string(i) + ",1,1,1,1,1\n";
  EXPECT_THAT(refusal(text, 3), AllOf(HasSubstr("tau1, tau3"), HasSubstr("add what is missing")));
}

// Ten samples of columns whose values are their place in the header.
std::string counted_csv(const std::string& header) {
  std::string text = header + "\n";
  const auto columns = std::count(header.begin(), header.end(), ',');
  for (int i = 0; i < 10; ++i) {
    text += std::to_string(i);
    for (std::ptrdiff_t column = 1; column <= columns; ++column) {
      text += "," + std::to_string(column);
    }
    text += "\n";
  }
  return text;
}

TEST(CsvLog, JointsThatCountFromZeroAreReadWithARemark) {
  const Log log = read(counted_csv("t,q0,q1,dq0,dq1,tau0,tau1"), 2);
  EXPECT_EQ(log.q(0, 0), 1);
  EXPECT_EQ(log.q(0, 1), 2);
  EXPECT_EQ(log.dq(0, 0), 3);
  EXPECT_EQ(log.dq(0, 1), 4);
  EXPECT_EQ(log.tau(0, 0), 5);
  EXPECT_EQ(log.tau(0, 1), 6);
  EXPECT_TRUE(log.extra.empty());
  EXPECT_THAT(log.remarks, Contains("the joints are numbered from 0: q0 is joint 1"));
  EXPECT_EQ(read(counted_csv("T,Q0,TAU0")).tau(0, 0), 2);
}

// Taken by their names they would fit the robot, each of the joint before its own.
TEST(CsvLog, JointsThatCountFromZeroAreNeverOffByOne) {
  EXPECT_THAT(refusal(counted_csv("t,q0,q1,q2,tau0,tau1,tau2"), 2),
              AllOf(HasSubstr("q0 to q2, tau0 to tau2, 3 of q, numbered from 0"),
                    HasSubstr("the robot's 2 joints")));
  EXPECT_THAT(refusal(counted_csv("t,q0,q1,tau0,tau1"), 3), HasSubstr("2 of q, numbered from 0"));
  for (const char* header : {"t,q0,q1,tau1,tau2", "t,q1,q2,dq0,dq1,tau1,tau2",
                             "t,q0,q1,dq1,dq2,tau0,tau1", "t,q0,q1,q2,tau1,tau2"}) {
    EXPECT_THAT(refusal(counted_csv(header), 2), HasSubstr("some count from 0, some do not"))
        << header;
  }
}

TEST(CsvLog, ValuesThatNothingMeasuresAreRefused) {
  for (const char* value : {"1e300", "-3.4e38"}) {
    EXPECT_THAT(refusal(one_joint_csv(20,
                                      [&](int number, std::string& line) {
                                        if (number == 12) line = std::string("0.1,1,2,") + value;
                                      })),
                HasSubstr("up to 1e+15"))
        << value;
  }
}

// As ROS stamps samples: the unit is what is missing, and nothing has to be cut or filled.
TEST(CsvLog, NanosecondsOfTheEpochAreNamed) {
  std::string text = "t,q1,dq1,tau1\n";
  for (int i = 0; i < 20; ++i)
    text += std::to_string(1763942400000000000 + 1000000 * i) + ",1,0,1\n";
  EXPECT_THAT(refusal(text), AllOf(HasSubstr("nanoseconds since 1970"),
                                   HasSubstr("time = {source = \"t\", unit = \"ns\"}")));
}

TEST(CsvLog, ASingleTimeThatDoesNotAscendIsLeftOutAndMoreAreRefused) {
  const auto stamped = [](int last) {
    return one_joint_csv(20, [last](int number, std::string& line) {
      if (number >= 12 && number <= last) line = "0.09,1,2,3";
    });
  };
  const Log log = read(stamped(12));
  EXPECT_EQ(log.sample_count(), 20);
  EXPECT_NEAR(log.q(10, 0), 0.01, 1e-4);
  EXPECT_THAT(log.remarks,
              Contains(AllOf(HasSubstr("line 12, time"), HasSubstr("0.09 s after 0.09 s"))));
  EXPECT_THAT(refusal(stamped(15)),
              AllOf(HasSubstr("line 12, time"), HasSubstr("0.09 s after 0.09 s")));
}

// Read up to a tenth of rows out of time, half of the recording would be gone.
TEST(CsvLog, AClockThatBeginsAnewIsRefused) {
  for (const int rows : {179, 180, 181}) {
    std::string text = "t,q1,tau1\n";
    for (int i = 0; i < 2 * rows; ++i) {
      text += std::to_string(0.01 * (i % rows)) + ",1," + std::to_string(i) + "\n";
    }
    EXPECT_THAT(refusal(text), HasSubstr("cut the recording where its clock begins anew")) << rows;
  }
}

// Without dq the velocity is derived, and of such positions it would be infinite.
TEST(CsvLog, PositionsTooCloseInTimeToDifferentiateAreRefused) {
  std::string text = "t,q1,tau1\n";
  for (int i = 0; i < 20; ++i) {
    text += std::to_string(i) + "e-300" + (i % 2 == 0 ? ",1e15" : ",-1e15") + ",0\n";
  }
  EXPECT_THAT(refusal(text), HasSubstr("no velocity can be computed"));
}

TEST(CsvLog, TooShortOrNoRecordingIsRefused) {
  EXPECT_THAT(refusal(one_joint_csv(3, kAsIs)), HasSubstr("3 samples"));
  EXPECT_THAT(message_of<InputError>([] { read_log("no/such/log.csv", 1, std::nullopt); }),
              HasSubstr("no such file"));
  EXPECT_THAT(message_of<InputError>([] { read_log(testing::TempDir(), 1, std::nullopt); }),
              HasSubstr("a folder"));
}

}  // namespace
