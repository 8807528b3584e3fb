// How soon the on-board monitor sees faults of a seven-joint arm, in accelerations with one
// threshold of all joints and in torques joint by joint, each calibrated on the same fault-free
// runs.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
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
  bool isolation = false;
  std::uint64_t first_run = 1;  // of those with faults
  std::uint64_t owner = 1;
  std::string only;  // faults with these words in their name
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

// How isolation answers one fault, over its runs.
struct Answers {
  std::array<int, offnominal::kFaultKinds> kinds{};  // how often each was said
  int seen = 0;
  int joint_right = 0;    // where the kind is right
  int decided_alone = 0;  // without its time limit
  int within_two_deviations = 0;
  std::vector<double> size_errors;  // shares, where the kind is right
  std::vector<double> times_s;      // after the detection
};

// A recording without velocities gets them by differences over samples on either side.
constexpr double kAhead = 0.03;

void take_answer(const Watched& watched, const Log& log, const bench::DetectionFault& fault,
                 bool is_told, Answers& answers) {
  const Replay shown = replay(watched.robot, log);
  if (!shown.detection_time_s || *shown.detection_time_s < bench::kFaultS - kAhead) return;
  ++answers.seen;
  if (shown.faults.empty()) return;
  const IsolatedFault& said = shown.faults.front();
  ++answers.kinds.at(static_cast<std::size_t>(said.kind));
  answers.times_s.push_back(said.time_s - said.detection_time_s);
  if (is_told) fmt::print("  {}: {}\n", log.file, words_of(said, shown));
  if (said.kind != fault.kind) return;
  if (fault.joint && said.joint == *fault.joint) ++answers.joint_right;
  if (!fault.size) return;
  answers.size_errors.push_back(std::abs(said.size / *fault.size - 1));
  if (std::abs(said.size - *fault.size) <= 2 * said.deviation) ++answers.within_two_deviations;
}

double middle_of(std::vector<double> values, double at) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(at * static_cast<double>(values.size() - 1))];
}

void print_answers(const std::vector<bench::DetectionFault>& faults,
                   const std::vector<Answers>& all) {
  fmt::print("| fault | seen | kind | joint | size off, median, 9 of 10 | within 2 s.d. | s |");
  for (std::size_t kind = 0; kind < offnominal::kFaultKinds; ++kind) {
    fmt::print(" {} |", name_of(static_cast<offnominal::FaultKind>(kind)));
  }
  fmt::print("\n|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (std::size_t i = 0; i < faults.size(); ++i) {
    const Answers& answers = all[i];
    const int right = answers.kinds.at(static_cast<std::size_t>(faults[i].kind));
    fmt::print("| {} | {} | {} | {} | {:.0f} %, {:.0f} % | {} | {:.2f} |", faults[i].words,
               answers.seen, right, faults[i].joint ? std::to_string(answers.joint_right) : "-",
               100 * middle_of(answers.size_errors, 0.5), 100 * middle_of(answers.size_errors, 0.9),
               answers.within_two_deviations, middle_of(answers.times_s, 0.5));
    for (const int count : answers.kinds) fmt::print(" {} |", count);
    fmt::print("\n");
  }
}

void run_isolation(const Options& options, const std::vector<Log>& logs,
                   const std::string& folder) {
  const RobotDescription robot = bench::owners_robot(options.owner);
  const std::vector<Watched> all{in_torques(robot, 10, options, logs),
                                 in_torques(robot, 30, options, logs)};
  std::vector<bench::DetectionFault> faults = bench::isolation_faults();
  std::erase_if(faults, [&](const bench::DetectionFault& fault) {
    return fault.words.find(options.only) == std::string::npos;
  });
  std::vector<std::vector<Answers>> answers(all.size(), std::vector<Answers>(faults.size()));
  for (std::size_t i = 0; i < faults.size(); ++i) {
    if (!options.only.empty()) fmt::print("{}\n", faults[i].words);
    for (int run = 0; run < options.runs; ++run) {
      const Log log = bench::arm_recording(options.first_run + static_cast<std::uint64_t>(run),
                                           bench::kFaultRunS, &faults[i], folder);
      for (std::size_t k = 0; k < all.size(); ++k) {
        take_answer(all[k], log, faults[i], !options.only.empty(), answers[k][i]);
      }
    }
  }
  for (std::size_t k = 0; k < all.size(); ++k) {
    fmt::print("\n{}, {} runs per fault\n\n", all[k].words, options.runs);
    print_answers(faults, answers[k]);
  }
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
  if (options.isolation) {
    run_isolation(options, logs, folder);
    return;
  }
  const RobotDescription robot = bench::owners_robot(options.owner);
  const std::vector<Watched> all{in_accelerations(robot, 10, options, logs),
                                 in_torques(robot, 10, options, logs),
                                 in_torques(robot, 30, options, logs)};
  fmt::print("| fault |");
  for (const Watched& watched : all) fmt::print(" {} |", watched.words);
  fmt::print("\n|---|---|---|---|\n");
  for (const bench::DetectionFault& fault : bench::detection_faults()) {
    std::vector<Score> scores(all.size());
    for (int i = 0; i < options.runs; ++i) {
      const Log log = bench::arm_recording(options.first_run + static_cast<std::uint64_t>(i),
                                           bench::kFaultRunS, &fault, folder);
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
  app.add_flag("--isolation", options.isolation,
               "In place of times: which fault isolation says it is, in torque space");
  app.add_option("--first-run", options.first_run, "Seed of the first run with a fault")
      ->capture_default_str();
  app.add_option("--owner", options.owner, "Seed of what the owner knows of the arm")
      ->capture_default_str();
  app.add_option("--only", options.only,
                 "Of --isolation: faults whose name holds this, one by one");
  CLI11_PARSE(app, argc, argv);
  run(options);
  return 0;
}
