#include "log/candump_log.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <offnominal/hal/messages.hpp>
#include <offnominal/hal/protocols/protected/address.hpp>

#include "common/error.hpp"
#include "common/file.hpp"
#include "desk/support/temporary_folder.hpp"
#include "log/candump_text.hpp"
#include "log/csv_text.hpp"
#include "log/read_log.hpp"
#include "paper/recording.hpp"
#include "paper/two_link_robot.hpp"
#include "sil/sil.hpp"
#include "support/places.hpp"

namespace offnominal::desk {
namespace {

TEST(CandumpLine, IsReadAsItWasWritten) {
  hal::Frame classic;
  classic.id = 0x181;
  classic.length = 3;
  classic.data = {0x2A, 0x36, 0xFF};
  hal::Frame fd = classic;
  fd.fd = true;
  fd.extended = true;
  fd.id = 0x1ABCDEF0;
  fd.length = 12;
  hal::Frame request;
  request.id = 5;
  request.remote = true;
  request.length = 8;
  for (const hal::Frame& frame : {classic, fd, request}) {
    const std::string line = candump_line(frame, 12'000'345, "vcan0");
    const auto read = parse_candump_line(line.substr(0, line.size() - 1));
    ASSERT_TRUE(read.has_value()) << line;
    EXPECT_EQ(read->time_s, 12.000345);
    EXPECT_EQ(read->interface, "vcan0");
    EXPECT_EQ(read->frame.id, frame.id);
    EXPECT_EQ(read->frame.extended, frame.extended);
    EXPECT_EQ(read->frame.fd, frame.fd);
    EXPECT_EQ(read->frame.remote, frame.remote);
    EXPECT_EQ(read->frame.length, frame.length);
    EXPECT_EQ(read->frame.data, frame.data);
  }
  EXPECT_EQ(candump_line(classic, 12'000'345, "vcan0"), "(12.000345) vcan0 181#2A36FF\n");
}

TEST(CandumpLine, OfAnotherFormIsNone) {
  for (const char* line :
       {"", "t,q1", "(1.0) vcan0", "(1.0 vcan0 181#00", "(x) vcan0 181#00", "(1.0) vcan0 181#0",
        "(1.0) vcan0 18#00", "(1.0) vcan0 181#000102030405060708", "(1.0) vcan0 FFF#00",
        "(1.0) vcan0 181##", "(1.0) vcan0 181#RX", "(1.0) vcan0 181#zz", "(nan) vcan0 181#00"}) {
    EXPECT_FALSE(parse_candump_line(line).has_value()) << line;
  }
}

class SilLog : public testing::Test {
 protected:
  void record(hal::FrameFormat format) {
    scenario.duration_s = 1.0;
    scenario.record = true;
    scenario.format = format;
    const auto wire = sil::make_in_process_wire();
    const auto result = run_in_lock_step(robot, scenario, *wire, sil::kInProcess,
                                         [&](const hal::Frame& frame, hal::Microseconds time_us) {
                                           text += candump_line(frame, time_us, "vcan0");
                                         });
    as_csv = paper::seen_recording_of(robot, result.run.series);
  }
  Log read() const {
    const test::TemporaryFolder folder;
    write_file_atomically(folder / "run.log", text);
    return read_log(folder / "run.log", robot);
  }

  RobotDescription robot = paper::two_link_robot();
  sil::Scenario scenario;
  std::string text;
  Log as_csv;
};

// The log of the frames holds the run, to what a frame resolves.
TEST_F(SilLog, IsTheRecordingOfTheRun) {
  for (const auto format : {hal::FrameFormat::kClassic, hal::FrameFormat::kFd}) {
    text.clear();
    record(format);
    const Log log = read();
    ASSERT_GT(log.sample_count(), as_csv.sample_count() - 1);
    EXPECT_NEAR(log.period_s, 0.001, 1e-9);
    const Eigen::Index rows = as_csv.sample_count() - 1;
    const auto tail = [&](const Eigen::MatrixXd& all) { return all.bottomRows(rows).eval(); };
    EXPECT_LT((tail(log.q) - tail(as_csv.q)).cwiseAbs().maxCoeff(), 1e-5);
    EXPECT_LT((tail(log.dq) - tail(as_csv.dq)).cwiseAbs().maxCoeff(), 1e-3);
    EXPECT_LT((tail(log.tau) - tail(as_csv.tau)).cwiseAbs().maxCoeff(), 1e-4);
  }
}

// GIVEN drives that send positions alone THEN a log of their frames has no velocity, and dq is the
// derivative of q as in any recording without one.
TEST_F(SilLog, DerivesVelocitiesThatNobodySent) {
  for (const auto format : {hal::FrameFormat::kClassic, hal::FrameFormat::kFd}) {
    text.clear();
    scenario.sends_velocity = false;
    record(format);
    const Log log = read();
    EXPECT_EQ(log.dq_derived, std::vector<bool>({true, true}));
    const Eigen::Index rows = as_csv.sample_count();
    ASSERT_GE(log.sample_count(), rows);
    // Away from the ends, where a filter has to begin.
    for (Eigen::Index row = rows / 4; row < 3 * rows / 4; ++row) {
      for (int joint = 0; joint < 2; ++joint) {
        const double truth = as_csv.extra.at("dq_true" + std::to_string(joint + 1))[row];
        ASSERT_NEAR(log.dq(log.sample_count() - rows + row, joint), truth, 0.02) << row;
      }
    }
  }
}

// The same where the map names the DBC file that offnominal publishes, or a copy of it that has
// another device's messages too.
TEST_F(SilLog, ReadsItsOwnFramesThroughANamedDbcAsWithout) {
  const test::TemporaryFolder folder;
  const std::string own = test::content_of(test::source_dir() / "hal" / "offnominal.dbc");
  write_file_atomically(folder / "own.dbc", own);
  write_file_atomically(folder / "more.dbc",
                        own + "\nBO_ 9 Axis0: 8 D\n SG_ Vel : 32|32@1- (1,0) [0|0] \"\" M\n");
  scenario.sends_velocity = false;
  record(hal::FrameFormat::kClassic);
  const std::size_t at = text.find("vcan0 181#", text.size() / 2) + 10;
  text[at] = text[at] == '0' ? '1' : '0';
  write_file_atomically(folder / "run.log", text);
  const Log expected = read();
  for (const std::string name : {"own.dbc", "more.dbc"}) {
    const std::string dbc = "dbc = \"" + name + "\"\n";
    test::put(folder / "common.toml", dbc +
                                          "time = \"t\"\nposition = [\"q1\", \"q2\"]\n"
                                          "torque = [\"tau1\", \"tau2\"]\n");
    const Log log = read_log(folder / "run.log", robot, {folder / "common.toml", {}});
    // With the damaged record left out.
    EXPECT_EQ(log.q, expected.q);
    EXPECT_EQ(log.tau, expected.tau);
    test::put(folder / "velocity.toml",
              dbc +
                  "time = \"t\"\n"
                  "position = [\"encoder_1.position\", \"encoder_2.position\"]\n"
                  "velocity = [\"encoder_1.velocity\", \"encoder_2.velocity\"]\n"
                  "torque = [\"tau1\", \"tau2\"]\n");
    try {
      const Log marked = read_log(folder / "run.log", robot, {folder / "velocity.toml", {}});
      FAIL() << "read a velocity of " << marked.dq(0, 0) << " that nobody sent";
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr("encoder_1.velocity"));
    }
  }
}

TEST_F(SilLog, LeavesOutRecordsThatAreNotIntact) {
  record(hal::FrameFormat::kClassic);
  const Log intact = read();
  const std::size_t at = text.find("vcan0 181#", text.size() / 2) + 10;
  text[at] = text[at] == '0' ? '1' : '0';
  const Log damaged = read();
  // The row is there, with the neighbour's reading of joint 2.
  EXPECT_EQ(damaged.sample_count(), intact.sample_count());
  EXPECT_LT((damaged.q - intact.q).cwiseAbs().maxCoeff(), 1e-2);
  EXPECT_GT((damaged.q - intact.q).cwiseAbs().maxCoeff(), 0.0);
}

// GIVEN a log whose writer was killed THEN it is read to its last whole line.
TEST_F(SilLog, IsReadToItsLastWholeLine) {
  record(hal::FrameFormat::kClassic);
  text.resize(text.size() - 5);
  EXPECT_GT(read().sample_count(), 900);
}

TEST_F(SilLog, SaysWhichLineIsNone) {
  record(hal::FrameFormat::kClassic);
  const std::size_t second = text.find('\n') + 1;
  text.insert(second, "nonsense\n");
  try {
    read();
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("line 2"));
  }
}

TEST_F(SilLog, APauseIsRefused) {
  record(hal::FrameFormat::kClassic);
  // Joint 2 says nothing for 0.1 s.
  std::string kept;
  std::size_t line = 0;
  for (std::size_t begin = 0; begin < text.size(); ++line) {
    const std::size_t end = text.find('\n', begin) + 1;
    const std::string content = text.substr(begin, end - begin);
    begin = end;
    if (line > 3000 && line < 3600 && content.find(" 181#") != std::string::npos) continue;
    kept += content;
  }
  text = kept;
  EXPECT_THROW(read(), InputError);
}

// What read_log() says against it; "" for nothing.
std::string refusal_of(const std::string& text) {
  const test::TemporaryFolder folder;
  write_file_atomically(folder / "run.log", text);
  try {
    read_log(folder / "run.log", paper::two_link_robot());
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

// The same log, so many seconds later and on this interface.
std::string moved(std::string_view text, double by_s, const std::string& interface) {
  std::string result;
  while (!text.empty()) {
    const std::size_t end = text.find('\n') + 1;
    const std::string line(text.substr(0, end));
    text.remove_prefix(end);
    const auto frame = parse_candump_line(std::string_view(line).substr(0, line.size() - 1));
    result +=
        candump_line(frame.value().frame, std::llround(1e6 * (frame->time_s + by_s)), interface);
  }
  return result;
}

// GIVEN a clock that was set back, or two recordings one behind the other WHEN the log is read THEN
// nothing of it is left out without a word.
TEST_F(SilLog, ATimeThatGoesBackIsRefused) {
  record(hal::FrameFormat::kClassic);
  EXPECT_EQ(refusal_of(text), "");
  EXPECT_EQ(refusal_of(text + moved(text, 2, "vcan0")), "");  // a gap: log.gaps
  for (const double back_s : {0.0, 0.9}) {
    EXPECT_THAT(refusal_of(text + moved(text, back_s, "vcan0")),
                testing::AllOf(testing::HasSubstr("before that of"), testing::HasSubstr("line ")));
  }
  EXPECT_EQ(refusal_of(text + moved(text, 0.9945, "vcan0")), "") << "stamps of two processors";
}

TEST_F(SilLog, OneSignalOfTwoBusesIsRefused) {
  record(hal::FrameFormat::kClassic);
  EXPECT_THAT(refusal_of(text + moved(text, 2, "can1")),
              testing::AllOf(testing::HasSubstr("vcan0"), testing::HasSubstr("can1")));
}

TEST(CandumpLog, OfAnotherProtocolIsReadThroughItsDbcFile) {
  const test::TemporaryFolder folder;
  write_file_atomically(folder / "drive.dbc",
                        "BO_ 9 Axis0: 8 D\n"
                        " SG_ Vel : 32|32@1- (1,0) [0|0] \"rev/s\" M\n"
                        " SG_ Pos : 0|32@1- (1,0) [0|0] \"rev\" M\n"
                        "BO_ 14 Torque0: 4 M\n"
                        " SG_ Torque : 0|16@1- (0.01,0) [0|0] \"Nm\" D\n");
  write_file_atomically(folder / "channels.toml",
                        "dbc = \"drive.dbc\"\n"
                        "position = [{source = \"Axis0.Pos\", scale = 0.5}]\n"
                        "torque = [\"Torque0.Torque\"]\n");
  std::string text;
  for (int i = 0; i < 20; ++i) {
    hal::Frame frame;
    frame.id = 9;
    frame.length = 8;
    frame.data[0] = static_cast<std::uint8_t>(i);
    text += candump_line(frame, 1'700'000'000'000'000 + 10'000 * i, "can0");
    frame = {};
    frame.id = 14;
    frame.length = 4;
    frame.data[0] = static_cast<std::uint8_t>(2 * i);
    text += candump_line(frame, 1'700'000'000'000'300 + 10'000 * i, "can0");
  }
  write_file_atomically(folder / "drive.log", text);
  RobotDescription robot;
  robot.joints.resize(1);
  const Log log = read_log(folder / "drive.log", robot, {folder / "channels.toml", {}});
  ASSERT_EQ(log.sample_count(), 20);
  EXPECT_NEAR(log.period_s, 0.01, 1e-6);
  EXPECT_EQ(log.q(19, 0), 9.5);
  EXPECT_NEAR(log.tau(19, 0), 0.38, 1e-12);
}

}  // namespace
}  // namespace offnominal::desk
