// How soon the on-board monitor sees faults of a seven-joint arm, in accelerations with one
// threshold of all joints and in torques joint by joint, each calibrated on the same fault-free
// runs.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "calibrate/calibrate.hpp"
#include "calibrate/calibrate_joints.hpp"
#include "detection_case.hpp"
#include "replay/replay.hpp"

namespace {

using namespace offnominal::desk;
namespace bench = offnominal::bench;

struct Options {
  int runs = 12;        // per fault
  int calibration = 6;  // fault-free runs, the last of them held out
  double duration_s = 60;
  double alarms_per_hour = 0.1;
};

struct Watched {
  std::string words;
  RobotDescription robot;
};

Watched in_accelerations(RobotDescription robot, double alpha, const Options& options,
                         const std::vector<Log>& logs) {
  robot.estimator.alpha = alpha;
  const Calibration result = calibrate(robot, {options.alarms_per_hour, {}, ""}, logs, {});
  for (const std::string& objection : result.objections) fmt::print("objection: {}\n", objection);
  return {fmt::format("accelerations, alpha {:g}", alpha), result.robot};
}

Watched in_torques(RobotDescription robot, double alpha, const Options& options,
                   const std::vector<Log>& logs) {
  robot.estimator.alpha = alpha;
  robot.estimator.space = EstimatorSpace::kTorque;
  const JointsCalibration result =
      calibrate_joints(robot, {options.alarms_per_hour, {}, ""}, logs, {});
  for (const std::string& objection : result.objections) fmt::print("objection: {}\n", objection);
  fmt::print("torques, alpha {:g}: smallest lasting fault seen in 95 of 100, N m:", alpha);
  for (const JointCalibration& joint : result.joints) fmt::print(" {:.2g}", joint.fault.usual);
  fmt::print("\n");
  return {fmt::format("torques, alpha {:g}", alpha), result.robot};
}

struct Score {
  std::vector<double> delays_s;
  int seen = 0;
  int joint_right = 0;
  int early = 0;  // an alarm before the fault
};

void judge(const Watched& watched, const Log& log, const bench::DetectionFault& fault,
           Score& score) {
  const Replay shown = replay(watched.robot, log);
  if (!shown.detection_time_s) return;
  const double delay_s = *shown.detection_time_s - bench::kFaultS;
  if (delay_s < 0) {
    ++score.early;
    return;
  }
  ++score.seen;
  score.delays_s.push_back(delay_s);
  if (fault.joint && shown.first_joint == fault.joint) ++score.joint_right;
}

std::string words_of(Score score, const bench::DetectionFault& fault, int runs) {
  std::string words = fmt::format("{} of {}", score.seen, runs);
  if (score.seen > 0) {
    std::sort(score.delays_s.begin(), score.delays_s.end());
    words += fmt::format(", median {:.3f} s", score.delays_s[score.delays_s.size() / 2]);
  }
  if (fault.joint && score.joint_right > 0) words += fmt::format(", joint {}", score.joint_right);
  if (score.early > 0) words += fmt::format(", early {}", score.early);
  return words;
}

void run(const Options& options) {
  const std::string folder = std::filesystem::temp_directory_path() / "offnominal_detection";
  std::filesystem::create_directories(folder);
  std::vector<Log> logs;
  for (int i = 0; i < options.calibration; ++i) {
    logs.push_back(bench::arm_recording(1000 + static_cast<std::uint64_t>(i), options.duration_s,
                                        nullptr, folder));
  }
  const RobotDescription robot = bench::owners_robot(1);
  const std::vector<Watched> all{in_accelerations(robot, 10, options, logs),
                                 in_torques(robot, 10, options, logs),
                                 in_torques(robot, 30, options, logs)};
  fmt::print("| fault |");
  for (const Watched& watched : all) fmt::print(" {} |", watched.words);
  fmt::print("\n|---|---|---|---|\n");
  for (const bench::DetectionFault& fault : bench::detection_faults()) {
    std::vector<Score> scores(all.size());
    for (int i = 0; i < options.runs; ++i) {
      const Log log = bench::arm_recording(static_cast<std::uint64_t>(i) + 1, bench::kFaultRunS,
                                           &fault, folder);
      for (std::size_t k = 0; k < all.size(); ++k) judge(all[k], log, fault, scores[k]);
    }
    fmt::print("| {} |", fault.words);
    for (const Score& score : scores) fmt::print(" {} |", words_of(score, fault, options.runs));
    fmt::print("\n");
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Time to detect faults of a seven-joint arm in MuJoCo, in both spaces");
  Options options;
  app.add_option("--runs", options.runs, "Runs per fault")->capture_default_str();
  app.add_option("--calibration", options.calibration, "Fault-free runs")->capture_default_str();
  app.add_option("--duration", options.duration_s, "Of a fault-free run, s")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  run(options);
  return 0;
}
