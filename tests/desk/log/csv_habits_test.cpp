// Habits of those who write CSV files: each is read right, or the refusal says how to say it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "common/error.hpp"
#include "desk/support/temporary_file.hpp"
#include "log/read_log.hpp"
#include "robot/channels.hpp"
#include "support/places.hpp"

namespace {

using offnominal::desk::ChannelMap;
using offnominal::desk::InputError;
using offnominal::desk::Log;
using offnominal::desk::parse_channels;
using offnominal::test::message_of;
using offnominal::test::TemporaryFile;
using ::testing::HasSubstr;

constexpr int kSamples = 20;
constexpr double kPeriodS = 0.01;

// The motion that every file of these holds: q = t^2, dq = 2 t, tau = 5 - 100 t.
double q_of(double t) { return t * t; }
double dq_of(double t) { return 2 * t; }
double tau_of(double t) { return 5 - 100 * t; }

struct Cells {
  std::vector<double> factors{1, 1, 1, 1};  // of t, q, dq, tau
  std::string separator = ",";
  std::string before;  // every line
  std::string after;
  std::string end = "\n";
  bool index = false;
  char point = '.';
  std::function<std::string(int)> time;  // text of it instead of the number
};

std::string number(double value, char point) {
  std::string text = std::to_string(value);
  for (char& c : text) c = c == '.' ? point : c;
  return text;
}

std::string lines(const Cells& cells, int samples = kSamples) {
  std::string text;
  for (int i = 0; i < samples; ++i) {
    const double t = kPeriodS * i;
    text += cells.before;
    if (cells.index) text += std::to_string(i) + cells.separator;
    text += cells.time ? cells.time(i) : number(cells.factors[0] * t, cells.point);
    text += cells.separator + number(cells.factors[1] * q_of(t), cells.point);
    text += cells.separator + number(cells.factors[2] * dq_of(t), cells.point);
    text += cells.separator + number(cells.factors[3] * tau_of(t), cells.point);
    text += cells.after + cells.end;
  }
  return text;
}

std::string packed(const std::string& text) {
  std::string bytes(compressBound(text.size()) + 64, '\0');
  z_stream stream{};
  deflateInit2(&stream, Z_BEST_SPEED, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY);
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data()));
  stream.avail_in = static_cast<uInt>(text.size());
  stream.next_out = reinterpret_cast<Bytef*>(bytes.data());
  stream.avail_out = static_cast<uInt>(bytes.size());
  EXPECT_EQ(deflate(&stream, Z_FINISH), Z_STREAM_END);
  bytes.resize(stream.total_out);
  deflateEnd(&stream);
  return bytes;
}

// `text` is ASCII but for the micro sign, which \xB5 stands for.
std::string utf16(const std::string& text, bool big_endian) {
  std::string wide = big_endian ? "\xFE\xFF" : "\xFF\xFE";
  for (const char c : text) {
    if (big_endian) wide += '\0';
    wide += c;
    if (!big_endian) wide += '\0';
  }
  return wide;
}

const std::string kHeader = "t,q1,dq1,tau1\n";
const std::string kNumbered = "time = 1\nposition = [2]\nvelocity = [3]\ntorque = [4]";

Log read(const std::string& content, const std::string& channels = {},
         std::optional<double> period_s = std::nullopt) {
  const TemporaryFile file("habit.csv", content);
  std::optional<ChannelMap> map;
  if (!channels.empty()) map = parse_channels(toml::parse(channels), "robot.toml", 1);
  return offnominal::desk::read_log(file.path(), 1, map, period_s);
}

std::string refusal(const std::string& content, const std::string& channels = {}) {
  return message_of<InputError>([&] { read(content, channels); });
}

void expect_motion(const Log& log, double tolerance = 2e-6) {
  ASSERT_EQ(log.sample_count(), kSamples);
  EXPECT_NEAR(log.period_s, kPeriodS, 1e-9);
  ASSERT_FALSE(log.dq_derived[0]);
  for (int i = 0; i < kSamples; ++i) {
    const double t = kPeriodS * i;
    EXPECT_NEAR(log.t_s[i] - log.t_s[0], t, 1e-6);
    EXPECT_NEAR(log.q(i, 0), q_of(t), tolerance);
    EXPECT_NEAR(log.dq(i, 0), dq_of(t), tolerance);
    EXPECT_NEAR(log.tau(i, 0), tau_of(t), tolerance);
  }
}

struct Habit {
  const char* name;
  std::string content;
  std::string channels = {};
  std::string remark = {};  // that has to be made; empty: none
};

Cells with(const std::function<void(Cells&)>& change) {
  Cells cells;
  change(cells);
  return cells;
}
std::string separated(const std::string& separator) {
  return lines(with([&](Cells& cells) { cells.separator = separator; }));
}

std::vector<Habit> habits() {
  constexpr double kDegrees = 180 / std::numbers::pi;
  const std::string plain = lines({});
  const std::string trailing = lines(with([](Cells& cells) { cells.after = ","; }));
  const std::string in_degrees = lines(with([](Cells& cells) {
    cells.factors = {1, kDegrees, kDegrees, 1e3};
  }));
  const std::string indexed = lines(with([](Cells& cells) { cells.index = true; }));
  const std::string comma = lines(with([](Cells& cells) {
    cells.separator = ";";
    cells.point = ',';
  }));
  const std::string dates = lines(with([](Cells& cells) {
    cells.time = [](int i) { return "2026-11-24T23:59:59." + std::to_string(100 + 10 * i) + "Z"; };
  }));
  const std::string german_dates = lines(with([](Cells& cells) {
    cells.separator = ";";
    cells.point = ',';
    cells.time = [](int i) { return "24.11.2026 23:59:59," + std::to_string(100 + 10 * i); };
  }));
  // Over midnight: the clock alone would not ascend.
  const auto split = [](const char* mark, const char* first, const char* second, char point) {
    return [=](int i) {
      const bool is_first = i < kSamples / 2;
      const int ms = 1000 + 10 * (i - kSamples / 2);  // of 23:59:59, or 1 s more
      return (is_first ? first : second) + std::string(mark) +
             (is_first ? "23:59:59" : "00:00:00") + point +
             std::to_string(ms).substr(is_first ? 0 : 1);
    };
  };
  const std::string date_and_clock =
      lines(with([&](Cells& cells) { cells.time = split(",", "2026-11-24", "2026-11-25", '.'); }));
  const std::string german_date_and_clock = lines(with([&](Cells& cells) {
    cells.separator = ";";
    cells.point = ',';
    cells.time = split(";", "24.11.2026", "25.11.2026", ',');
  }));
  const std::string nanoseconds = lines(with([](Cells& cells) {
    cells.time = [](int i) { return std::to_string(1763942400123456789 + 10'000'000LL * i); };
  }));
  const std::string drive = lines(with([](Cells& cells) {
    cells.factors = {1e3, kDegrees, 30 / std::numbers::pi, 1e3};
  }));
  const std::string drive_units =
      "time = {source = 't', unit = 'ms'}\nposition = {source = 'q1', unit = 'deg'}\n"
      "velocity = {source = 'dq1', unit = 'rpm'}\n"
      "torque = {source = 'tau1', unit = 'mA', scale = 2}";
  std::string quoted = plain;
  for (std::size_t at = 0; (at = quoted.find(',', at)) != std::string::npos; at += 3) {
    quoted.replace(at, 1, "\",\"");
  }
  for (std::size_t at = 0; (at = quoted.find('\n', at)) != std::string::npos; at += 3) {
    quoted.replace(at, 1, at + 1 == quoted.size() ? "\"\n" : "\"\n\"");
  }
  quoted.insert(0, "\"");
  std::string commented = plain;
  commented.insert(commented.find('\n', commented.size() / 2) + 1, "# the gripper closes\n");
  const auto replaced = [&plain](const std::string& what, const std::string& by) {
    std::string text = plain;
    for (std::size_t at = text.find(what); at != std::string::npos;
         at = text.find(what, at + by.size())) {
      text.replace(at, what.size(), by);
    }
    return text;
  };
  const std::string typeset = replaced("-", "\u2212");
  const std::string fortran = replaced(",", "D+00,");
  std::string row_names;
  int row = 0;
  for (std::size_t at = 0; at < plain.size(); at = plain.find('\n', at) + 1) {
    row_names +=
        "\"" + std::to_string(++row) + "\"," + plain.substr(at, plain.find('\n', at) + 1 - at);
  }
  return {
      {"as documented", kHeader + plain},
      {"semicolons", "t;q1;dq1;tau1\n" + separated(";")},
      {"tabs", "t\tq1\tdq1\ttau1\n" + separated("\t")},
      {"blanks", "t q1 dq1 tau1\n" + separated(" ")},
      {"blanks in columns", "   t      q1     dq1   tau1\n" + lines(with([](Cells& cells) {
                              cells.separator = "    ";
                              cells.before = "  ";
                              cells.after = "  ";
                            }))},
      {"blanks behind commas", "t, q1, dq1, tau1\n" + separated(", ")},
      {"decimal commas", "t;q1;dq1;tau1\n" + comma},
      {"decimal commas between tabs", "t\tq1\tdq1\ttau1\n" + lines(with([](Cells& cells) {
                                        cells.separator = "\t";
                                        cells.point = ',';
                                      }))},
      {"a spreadsheet's separator line", "sep=;\nt;q1;dq1;tau1\n" + separated(";")},
      {"no header", plain, kNumbered},
      {"no header, decimal commas", comma, kNumbered},
      {"a header behind a #, as numpy writes it", "# t q1 dq1 tau1\n" + separated(" ")},
      {"a header behind a #, commas", "#t,q1,dq1,tau1\n" + plain},
      {"a header behind a %, as rostopic writes it", "%t,q1,dq1,tau1\n" + plain},
      {"comments before the header", "# drive 3\n# 24 November\n" + kHeader + plain},
      {"comments between samples", kHeader + commented},
      {"comments behind a %", "% drive 3\n" + kHeader + plain},
      {"a title above the header",
       "Axis 3, run 7\n" + kHeader + plain,
       {},
       "line 1 stands before the header"},
      {"settings above the header",
       "Measurement of axis 3\n\nrate: 100 Hz\n7\n\n" + kHeader + plain,
       {},
       "lines 1 to 5 stand before the header"},
      {"settings above a header with units",
       "Operator;Smith\r\nRate;100\r\nt;q1;dq1;tau1\r\ns;rad;rad/s;Nm\r\n" +
           lines(with([](Cells& cells) {
             cells.separator = ";";
             cells.end = "\r\n";
           })),
       {},
       "lines 1 to 2 stand before the header"},
      {"blank lines before the header", "\n\n" + kHeader + plain},
      {"a line of units", kHeader + "s,rad,rad/s,Nm\n" + plain},
      {"a line of other units",
       kHeader + "[ms],[deg],[rpm],[mNm]\n" + drive,
       {},
       "the position of joint 1 is read in deg, as the file says of q1"},
      {"an unnamed index, as pandas writes it", ",t,q1,dq1,tau1\n" + indexed},
      {"columns numbered from 0, as pandas does", ",0,1,2,3\n" + indexed,
       "time = 2\nposition = [3]\nvelocity = [4]\ntorque = [5]", "count from 1"},
      {"row names, as R writes them", "\"t\",\"q1\",\"dq1\",\"tau1\"\n" + row_names},
      {"trailing commas", "t,q1,dq1,tau1,\n" + trailing},
      {"trailing commas below a header without", kHeader + trailing},
      {"trailing commas without a header", trailing, kNumbered},
      {"capitals", "T,Q1,DQ1,TAU1\n" + plain, {}, "in capitals"},
      {"the time by its whole name", "time,q1,dq1,tau1\n" + plain, {}, "column time is the time t"},
      {"everything in quotes", "\"t\",\"q1\",\"dq1\",\"tau1\"\n" + quoted},
      {"separators in quoted names", "\"t, s\",\"q, rad\",\"dq\",\"tau\"\n" + plain,
       "time = 't, s'\nposition = 'q, rad'\nvelocity = 'dq'\ntorque = 'tau'"},
      {"line ends of Windows",
       "t,q1,dq1,tau1\r\n" + lines(with([](Cells& cells) { cells.end = "\r\n"; }))},
      {"a byte order mark", "\xEF\xBB\xBF" + kHeader + plain},
      {"UTF-16", utf16(kHeader + plain, false)},
      {"UTF-16, big-endian", utf16(kHeader + plain, true)},
      {"a header in Windows-1252", "t,q1 [\xB0],dq1 [\xB0/s],M\x80 [mN\xB7m]\n" + in_degrees,
       "time = 't'\nposition = {source = 'q1 [\u00b0]', unit = '\u00b0'}\n"
       "velocity = {source = 'dq1 [\u00b0/s]', unit = '\u00b0/s'}\n"
       "torque = {source = 'M\u20ac [mN\u00b7m]', unit = 'mNm'}",
       "line 1 is no UTF-8: read as Windows-1252"},
      {"a line of units in Windows-1252", kHeader + "s,\xB0,\xB0/s,mN\xB7m\n" + in_degrees,
       "time = 't'\nposition = 'q1'\nvelocity = 'dq1'\ntorque = 'tau1'",
       "line 2 is no UTF-8: read as Windows-1252"},
      {"bytes that Windows-1252 has no letter for",
       "t,q1,dq1,tau1,\x8D\n" + trailing,
       {},
       "line 1 is no UTF-8"},
      {"gzip", packed(kHeader + plain)},
      {"gzip in two members", packed(kHeader + plain.substr(0, 100)) + packed(plain.substr(100))},
      {"gzip of UTF-16", packed(utf16(kHeader + plain, false))},
      {"a typeset minus", kHeader + typeset},
      {"exponents of Fortran", kHeader + fortran},
      {"dates in ISO 8601", kHeader + dates, {}, "t = 0 s is 2026-11-24T23:59:59.100Z"},
      {"dates with dots",
       "t;q1;dq1;tau1\n" + german_dates,
       {},
       "t = 0 s is 24.11.2026 23:59:59,100"},
      {"a title with a date and a time of day in cells of their own",
       "Date,2026-11-24,Time,12:00:01\n" + kHeader + plain,
       {},
       "line 1 stands before the header: left out"},
      {"a date and a clock in two columns",
       "date,time,q1,dq1,tau1\n" + date_and_clock,
       {},
       "t = 0 s is 2026-11-24 23:59:59.900"},
      {"a date with dots and a clock in two columns, asked for by the date",
       "Datum;Uhrzeit;q1;dq1;tau1\n" + german_date_and_clock,
       "time = 'Datum'\nposition = 'q1'\nvelocity = 'dq1'\ntorque = 'tau1'",
       "t = 0 s is 24.11.2026 23:59:59,900"},
      {"a date and a clock without a header", date_and_clock,
       "time = '2'\nposition = '3'\nvelocity = '4'\ntorque = '5'",
       "t = 0 s is 2026-11-24 23:59:59.900"},
      {"nanoseconds since 1970", kHeader + nanoseconds,
       "time = {source = 't', unit = 'ns'}\nposition = 'q1'\nvelocity = 'dq1'\ntorque = 'tau1'",
       "of the file's own clock"},
      {"ms, degrees, rpm and mA", kHeader + lines(with([](Cells& cells) {
                                    cells.factors = {1e3, kDegrees, 30 / std::numbers::pi, 500};
                                  })),
       drive_units},
      {"no time", kHeader + plain,
       "period_s = 0.01\nposition = 'q1'\nvelocity = 'dq1'\ntorque = 'tau1'"},
      {"plus signs", "t,q1,dq1,tau1\n" + lines(with([](Cells& cells) { cells.before = "+"; }))},
  };
}

// As rostopic echo -p writes it: no line of samples is all numbers.
TEST(CsvHabits, AHeaderBehindAPercentSignMayHaveTextUnderIt) {
  for (const char* sign : {"%", "#"}) {
    std::string text = std::string(sign) + "t,seq,name0,q1,name1,tau1\n";
    for (int i = 0; i < kSamples; ++i) {
      const double t = kPeriodS * i;
      text += std::to_string(t) + ",1,shoulder," + std::to_string(q_of(t)) + ",elbow," +
              std::to_string(tau_of(t)) + "\n";
    }
    const Log log = read(text);
    EXPECT_EQ(log.sample_count(), kSamples);
    EXPECT_NEAR(log.tau(3, 0), tau_of(3 * kPeriodS), 1e-6);
  }
  EXPECT_THAT(refusal("# a drive\n1.5,t,q1,tau1\n0,0,1,2\n"), HasSubstr("the number 1.5"));
}

// As ros2 topic echo --csv writes a JointState: no header, and words in every line.
TEST(CsvHabits, WordsBesideNumbersInEveryLineAreNoHeader) {
  std::string text;
  for (int i = 0; i < kSamples; ++i) {
    const double t = kPeriodS * i;
    text += "1795600000," + std::to_string(10'000'000 * i) + ",,shoulder," +
            std::to_string(q_of(t)) + "," + std::to_string(dq_of(t)) + "," +
            std::to_string(tau_of(t)) + "\n";
  }
  const Log log = read(text,
                       "time = {sum = [1, {source = 2, unit = 'ns'}]}\nposition = 5\n"
                       "velocity = 6\ntorque = 7");
  ASSERT_EQ(log.sample_count(), kSamples);
  EXPECT_NEAR(log.tau(3, 0), tau_of(3 * kPeriodS), 1e-6);
  EXPECT_THAT(refusal(text), HasSubstr("numbers in 7 columns"));
  const std::string counting = "0.0,a,1,2\n0.1,a,1,2\n";
  EXPECT_THAT(refusal(counting), HasSubstr("numbers in 4 columns"));
  // Whole numbers that count are names, and what no line below is like is a header.
  EXPECT_THAT(refusal("joint,1,2\na,0.5,0.2\n"), HasSubstr("the number 1"));
  EXPECT_THAT(refusal("t,2.5,7\n0,0,1\n"), HasSubstr("the number 2.5"));
  EXPECT_THAT(refusal("a,2.5,7\n"), HasSubstr("the number 2.5"));
}

TEST(CsvHabits, ACellThatIsNoUtf8IsShownAsText) {
  EXPECT_THAT(refusal(kHeader + "0,0,0,0\n0.01,5\xB0,0,0\n"), HasSubstr("found \"5\u00b0\""));
}

TEST(CsvHabits, EachIsReadRight) {
  for (const Habit& habit : habits()) {
    SCOPED_TRACE(habit.name);
    Log log;
    ASSERT_NO_THROW(
        try { log = read(habit.content, habit.channels); } catch (const InputError& error) {
          ADD_FAILURE() << error.what();
          throw;
        });
    // Degrees and rpm are printed to 1e-6 of theirs.
    expect_motion(log);
    if (habit.remark.empty()) {
      EXPECT_THAT(log.remarks, testing::IsEmpty());
    } else {
      EXPECT_THAT(log.remarks, testing::Contains(HasSubstr(habit.remark)));
    }
  }
}

// Files as they come, which the fuzzers begin with too.
TEST(CsvHabits, SamplesOfTheCorpusAreRead) {
  const auto read_sample = [](const char* name) {
    return offnominal::desk::read_log(
        offnominal::test::source_dir() / "tests" / "fuzz" / "corpus" / "csv" / name, 2,
        std::nullopt);
  };
  const Log common = read_sample("title.csv");
  const Log dates = read_sample("dates.csv");
  for (const Log& log : {common, dates}) {
    ASSERT_EQ(log.sample_count(), 12);
    EXPECT_NEAR(log.period_s, 0.01, 1e-9);
    EXPECT_EQ(log.q(11, 1), 0.497);
    EXPECT_EQ(log.tau(1, 0), 1.49);
  }
  EXPECT_THAT(common.remarks, testing::Contains("lines 1 to 4 stand before the header: left out"));
  EXPECT_THAT(dates.remarks, testing::Contains(HasSubstr("t = 0 s is 24.11.2026 23:59:59,000")));
}

TEST(CsvHabits, APeriodFromTheCommandLineTakesThePlaceOfTheTime) {
  std::string text = "q1,dq1,tau1\n";
  for (int i = 0; i < kSamples; ++i) {
    const double t = kPeriodS * i;
    text +=
        number(q_of(t), '.') + "," + number(dq_of(t), '.') + "," + number(tau_of(t), '.') + "\n";
  }
  expect_motion(read(text, {}, kPeriodS));
}

TEST(CsvHabits, WhatHasToBeSaidIsAskedFor) {
  EXPECT_THAT(refusal(lines({})),
              testing::AllOf(HasSubstr("numbers in 4 columns"), HasSubstr("time = 1")));
  for (const auto& [per_second, unit] :
       {std::pair{1e3, "ms"}, std::pair{1e6, "us"}, std::pair{1e9, "ns"}}) {
    const std::string text =
        kHeader + lines(with([&, factor = per_second](Cells& cells) {
          cells.time = [factor](int i) {
            return std::to_string(static_cast<long long>(factor * (1763942400 + kPeriodS * i)));
          };
        }));
    EXPECT_THAT(refusal(text), HasSubstr("unit = \"" + std::string(unit) + "\"")) << unit;
  }
  EXPECT_THAT(refusal(kHeader + "s,rad,rad/s,A\n" + lines({})),
              testing::AllOf(HasSubstr("the unit A, as the file says"), HasSubstr("scale = ...")));
  const std::string date = lines(with([](Cells& cells) {
    cells.time = [](int i) { return "2026-11-24 10:00:00." + std::to_string(100 + i); };
  }));
  EXPECT_THAT(refusal(kHeader + date,
                      "time = {source = 't', unit = 'ms'}\nposition = 'q1'\n"
                      "torque = 'tau1'"),
              testing::AllOf(HasSubstr("dates"), HasSubstr("leave unit and scale out")));
}

// Beside a decimal comma a point stands between thousands, or for the decimals of another program.
TEST(CsvHabits, OfTwoDecimalMarksInOneFileNoneIsRead) {
  const std::string commas = "t;q1;dq1;tau1\n" + lines(with([](Cells& cells) {
                               cells.separator = ";";
                               cells.point = ',';
                             }));
  EXPECT_THAT(refusal(commas + "0,2;0,04;0,4;-1.371\n"),
              testing::AllOf(HasSubstr("line 22: found"), HasSubstr("-1.371 of column tau1"),
                             HasSubstr("one decimal mark")));
  EXPECT_THAT(refusal(commas + "0,2;0,04;0,4;-1.234.567\n"), HasSubstr("-1.234.567"));
  const std::string points =
      "t;q1;dq1;tau1\n" + lines(with([](Cells& cells) { cells.separator = ";"; }));
  EXPECT_THAT(refusal(points + "0.2;0.04;0.4;-1,371\n"), HasSubstr("-1,371 of column tau1"));
  // A zero, or two digits, stand before no thousands.
  const std::string both = "0.19;0,361;0,38;-14.0\n";
  EXPECT_EQ(read("t;q1;dq1;tau1\n" +
                 lines(with([](Cells& cells) {
                         cells.separator = ";";
                         cells.point = ',';
                       }),
                       kSamples - 1) +
                 both)
                .tau(kSamples - 1, 0),
            -14);
  // What is not read may be written as it likes.
  std::string unread = "t;q1;dq1;tau1;version\n";
  unread += lines(with([](Cells& cells) {
    cells.separator = ";";
    cells.point = ',';
    cells.after = ";1.234";
  }));
  expect_motion(read(unread));
}

TEST(CsvHabits, OfTimesThatMayBeReadInTwoWaysItSaysHowToWriteThem) {
  for (const char* day : {"11/24/2026 ", "", "24.11.26 "}) {
    const std::string text =
        kHeader + lines(with([&](Cells& cells) {
          cells.time = [day](int i) { return day + ("10:00:00." + std::to_string(100 + i)); };
        }));
    EXPECT_THAT(refusal(text),
                testing::AllOf(HasSubstr("line 2, column t: found \"" + std::string(day) + "10:00"),
                               HasSubstr("24.11.2026 02:14:30.123"), HasSubstr("--period")));
  }
  EXPECT_THAT(refusal(kHeader + "oops,0,0,0\n"),
              testing::EndsWith("a number with a decimal point"));
}

TEST(CsvHabits, LinesAreCountedAsTheFileHasThem) {
  std::string text = "# drive 3\n\n" + kHeader + "s,rad,rad/s,Nm\n" + lines({}, 3) +
                     "# the gripper closes\n0.03,oops,1,2\n";
  EXPECT_THAT(refusal(text), HasSubstr("line 9, column q1"));
  text = kHeader + lines({}, 12) + "# the gripper closes\n0.12,1,1,2\n0.12,1,1,2\n0.12,1,1,2\n";
  EXPECT_THAT(refusal(text), HasSubstr("line 16, time"));
}

// Nothing that has numbers of its own is passed over.
TEST(CsvHabits, ARecordingInFrontOfAnotherIsNoPreamble) {
  EXPECT_THAT(refusal("t,q1,dq1,tau1\n0,1,2\n" + kHeader + lines({})),
              HasSubstr("line 2: found 3"));
  EXPECT_THAT(refusal("axis 3\n0,1,2,3\n" + kHeader + lines({})), HasSubstr("the number 3"));
  EXPECT_THAT(refusal("axis 3\n0,1,2,idle\n" + kHeader + lines({})), HasSubstr("the number 3"));
  EXPECT_THAT(refusal("axis 3\nand no numbers\n"), HasSubstr("line 1"));
}

TEST(CsvHabits, LinesBelowAPreambleAreCountedAsTheFileHasThem) {
  EXPECT_THAT(refusal("Axis 3, run 7\nrate 100 Hz\n" + kHeader + lines({}, 3) + "0.03,oops,1,2\n"),
              HasSubstr("line 7, column q1"));
}

// A clock of whole seconds, or one that begins anew, under a name that would else be the time.
TEST(CsvHabits, GivenItsStepAClockThatDoesNotAscendIsNotRead) {
  for (const auto& stamp : {std::function<std::string(int)>(
                                [](int i) { return number(std::floor(kPeriodS * i), '.'); }),
                            std::function<std::string(int)>([](int i) {
                              return number(kPeriodS * (i % (kSamples / 2)), '.');
                            })}) {
    expect_motion(
        read(kHeader + lines(with([&](Cells& cells) { cells.time = stamp; })), {}, kPeriodS));
  }
}

TEST(CsvHabits, DamagedPackedFilesAreRefused) {
  const std::string whole = packed(kHeader + lines({}));
  EXPECT_THAT(refusal(whole.substr(0, whole.size() / 2)), HasSubstr("packed data that end early"));
  std::string wrong = whole;
  wrong[whole.size() / 2] = static_cast<char>(~wrong[whole.size() / 2]);
  EXPECT_THAT(refusal(wrong), HasSubstr("packed data that"));
  EXPECT_THAT(refusal(whole + "and more"), HasSubstr("damaged"));
}

TEST(CsvHabits, HalfLettersOfUtf16AreRefused) {
  const std::string wide = utf16(kHeader + lines({}), false);
  EXPECT_THAT(refusal(wide.substr(0, wide.size() - 1)), HasSubstr("half a letter"));
  std::string lone = wide;
  lone[3] = '\xDC';
  EXPECT_THAT(refusal(lone), HasSubstr("no UTF-16"));
}

// An index that nobody named is told from a missing name by its place.
TEST(CsvHabits, ANameThatIsMissingElsewhereIsRefused) {
  EXPECT_THAT(refusal("t,q1,,tau1\n0,1,2,3\n"), HasSubstr("column 3: found no name"));
  // Which of the four nobody named cannot be known.
  EXPECT_THAT(refusal("t,q1,tau1\n0,1,2,3\n"), HasSubstr("4 values"));
}

TEST(CsvHabits, AnAngleThatIsFoldedIntoATurnIsUnfoldedWithAWord) {
  constexpr double kTurn = 2 * std::numbers::pi;
  for (const double low : {0.0, -std::numbers::pi}) {
    std::string text = "t,q1,dq1,tau1\n";
    for (int i = 0; i < 400; ++i) {
      const double q = 0.05 * i;
      text += number(kPeriodS * i, '.') + "," +
              number(q - kTurn * std::floor((q - low) / kTurn), '.') + ",5,1\n";
    }
    const Log log = read(text);
    EXPECT_THAT(log.remarks, testing::Contains(HasSubstr("jumps by 2 pi 3 times")));
    for (int i = 0; i < 400; ++i) EXPECT_NEAR(log.q(i, 0), 0.05 * i, 2e-6) << i;
  }
}

}  // namespace
