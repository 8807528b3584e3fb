// Logs of a bus whose drives speak another protocol than offnominal's own.
#include "log/drive_frames.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "common/error.hpp"
#include "common/file.hpp"
#include "desk/sil/run_of_robot.hpp"
#include "desk/sil/serial_robot.hpp"
#include "desk/support/temporary_folder.hpp"
#include "log/candump_text.hpp"
#include "log/read_log.hpp"
#include "paper/recording.hpp"
#include "robot/robot_file.hpp"
#include "sil/sil.hpp"

namespace offnominal::desk {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr int kJoints = 3;

RobotDescription robot_that(bool tells_torque) {
  std::string text = test::odrive_robot_text(kJoints, 2, "0.6");
  const std::string interval = "torque_interval_s = 0.002";
  if (!tells_torque) text.replace(text.find(interval), interval.size(), "torque_interval_s = 0");
  return parse_robot(text, "robot.toml");
}

struct RecordedRun {
  std::string frames;  // as candump -l
  Log seen;            // by the controller
};

RecordedRun run_of(const RobotDescription& robot) {
  RecordedRun run;
  sil::Scenario scenario = sil::scenario_of(robot);
  scenario.duration_s = 1;
  scenario.record = true;
  const sil::SilResult result =
      sil::run(robot, scenario, [&](const hal::Frame& frame, hal::Microseconds time_us) {
        run.frames += candump_line(frame, time_us, "can0");
      });
  run.seen = paper::seen_recording_of(robot, result.run.series);
  return run;
}

Log read(const std::string& text, const RobotDescription& robot) {
  const test::TemporaryFolder folder;
  write_file_atomically(folder / "run.log", text);
  return read_log(folder / "run.log", robot);
}

std::string refusal(const std::string& text, const RobotDescription& robot) {
  try {
    static_cast<void>(read(text, robot));
  } catch (const InputError& error) {
    return error.what();
  }
  return "nothing was refused";
}

// GIVEN drives that tell their torque, or are told one and say nothing of it, THEN a log of their
// bus holds what the controller saw, row by row.
TEST(DriveFrames, AreReadByTheProtocolOfTheRobotFile) {
  for (const bool tells_torque : {true, false}) {
    const RobotDescription robot = robot_that(tells_torque);
    const RecordedRun run = run_of(robot);
    const Log log = read(run.frames, robot);
    ASSERT_EQ(log.q.cols(), kJoints);
    // The log begins earlier, while the brakes hold the joints.
    const Eigen::Index rows = run.seen.sample_count() - 1;
    ASSERT_GT(rows, 400);
    ASSERT_GT(log.sample_count(), rows);
    // The row in which the last one that was seen stands.
    const Eigen::Index end = log.sample_count();
    double least = 1e9;
    for (Eigen::Index shift = 0; shift <= std::min<Eigen::Index>(3, end - rows); ++shift) {
      const auto q = log.q.middleRows(end - shift - rows, rows);
      const auto dq = log.dq.middleRows(end - shift - rows, rows);
      const double off = std::max((q - run.seen.q.bottomRows(rows)).cwiseAbs().maxCoeff(),
                                  (dq - run.seen.dq.bottomRows(rows)).cwiseAbs().maxCoeff());
      if (off >= least) continue;
      least = off;
      const auto tau = log.tau.middleRows(end - shift - rows, rows);
      // What is told acts in the next tick; what is said of it belongs to this one.
      const double change =
          (run.seen.tau.bottomRows(rows - 1) - run.seen.tau.middleRows(1, rows - 1))
              .cwiseAbs()
              .maxCoeff();
      EXPECT_LT((tau - run.seen.tau.bottomRows(rows)).cwiseAbs().maxCoeff(), 2 * change + 1e-5);
      EXPECT_GT(tau.cwiseAbs().maxCoeff(), 1);
    }
    EXPECT_LT(least, 1e-6) << tells_torque;
  }
}

TEST(DriveFrames, SayWhichJointIsNeverRead) {
  const RobotDescription robot = robot_that(true);
  std::string frames;
  const RecordedRun run = run_of(robot);
  // Without the second axis, node 53.
  std::size_t from = 0;
  while (from < run.frames.size()) {
    const std::size_t end = run.frames.find('\n', from);
    const std::string line = run.frames.substr(from, end + 1 - from);
    if (line.find(" 6A") == std::string::npos && line.find(" 6B") == std::string::npos) {
      frames += line;
    }
    from = end + 1;
  }
  EXPECT_THAT(refusal(frames, robot),
              AllOf(HasSubstr("run.log: found no reading of joint 2 in frames of can_simple"),
                    HasSubstr("[drives]")));
}

TEST(DriveFrames, OfTwoInterfacesOrTwoRunsAreRefused) {
  const RobotDescription robot = robot_that(true);
  const RecordedRun run = run_of(robot);
  std::string other = run.frames;
  other.replace(other.find("can0", other.size() / 2), 4, "can1");
  EXPECT_THAT(refusal(other, robot), AllOf(HasSubstr("run.log: line "), HasSubstr("grep")));
  EXPECT_THAT(refusal(run.frames + run.frames, robot),
              AllOf(HasSubstr("run.log: line "), HasSubstr("times that ascend")));
}

}  // namespace
}  // namespace offnominal::desk
