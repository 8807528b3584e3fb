#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "command/answer.hpp"
#include "command/fault_free.hpp"
#include "command/input_options.hpp"
#include "command/progress.hpp"
#include "command/recordings.hpp"
#include "command/refuse_option.hpp"
#include "command/verbs.hpp"
#include "command/write_robot.hpp"
#include "common/output_file.hpp"
#include "log/log_format.hpp"
#include "log/read_log.hpp"
#include "robot/robot_file.hpp"
#include "tune/tune.hpp"

namespace offnominal::desk {
namespace {

struct TuneOptions {
  FitFiles files;
  std::string output;
  TuneRequest request;
  std::vector<KeepFault> keep;
  AnswerOptions answer;
};

void check_numbers(const TuneRequest& request) {
  if (!(request.within_s >= 0.005 && request.within_s <= 10)) {
    refuse_option("tune", "--within", fmt::format("{:g}", request.within_s), "0.005 to 10 s");
  }
  if (!(request.alarms_per_hour >= 1e-6 && request.alarms_per_hour <= 60)) {
    refuse_option("tune", "--alarms-per-hour", fmt::format("{:g}", request.alarms_per_hour),
                  "1e-6 to 60");
  }
}

void run(const TuneOptions& options, ExitCode& exit_code) {
  check_numbers(options.request);
  Progress progress;
  FitData data = read_fit_data("tune", "LOG", options.files, read_log, progress);
  require_carried(data.robot, options.files.robot);
  const FaultFree healthy = keep_fault_free(data, options.keep, progress);
  observe_velocities(options.files, data);
  progress.begin("filters and networks");
  const Tuned tuned =
      tune(data.robot, options.request, data.logs, data.holdout, [&progress] { progress.step(); });
  progress.end();
  std::vector<std::string> written;
  if (tuned.objections.empty()) {
    write_robot(tuned.robot, options.files.robot, options.output, options.answer);
    written.push_back(options.output);
  } else {
    exit_code = ExitCode::kCheckFailed;
  }
  print_answer(
      options.answer, [&] { return with_faults(to_json(tuned, options.request), healthy.faults); },
      [&] { return text_of(tuned, options.request); }, written);
}

constexpr const char* kHowItTunes =
    "The recordings must be free of faults, and of the motions that the robot makes. The monitor "
    "is "
    "set up joint by joint (estimator.space = \"torque\"). Each setting is tried on the "
    "recordings: "
    "poles of the filter by the smallest torque that is seen in time above the threshold that "
    "calibrate finds for them, learning rate and network by how well torques that appear in the "
    "recordings are followed. What was tried stands behind each setting in the robot file. Its old "
    "bound is taken out: calibrate comes next.\n"
    "Exit code 1, and nothing written, where one part of the recordings is so unlike the others "
    "that it may hold a fault.";

}  // namespace

void set_up_tune(CLI::App& verb, ExitCode& exit_code) {
  const auto options = std::make_shared<TuneOptions>();
  verb.add_option("LOG", options->files.logs, "Fault-free recordings, " + log_format_names())
      ->required();
  verb.add_option("--robot", options->files.robot, "Robot file to start from")->required();
  verb.add_option("--holdout", options->files.holdout,
                  "Fault-free recordings on which the trials' thresholds are counted");
  verb.add_option("-o,--output", options->output, "Robot file to write")
      ->type_name(kNewRobotFile)
      ->required();
  add_force_option(verb, options->answer,
                   "Replace files that are there, for -o be it the robot file that is read");
  verb.add_option("--within", options->request.within_s, "How soon a fault has to be seen, s")
      ->capture_default_str();
  verb.add_option("--alarms-per-hour", options->request.alarms_per_hour,
                  "False alarms per hour that the trials' thresholds are for")
      ->capture_default_str();
  add_observe_option(verb, options->files.observe_velocity);
  add_channels_option(verb, options->files.channels, "recordings'");
  add_keep_option(verb, options->keep);
  add_json_option(verb, options->answer);
  verb.footer(kHowItTunes);
  verb.callback([options, &exit_code] { run(*options, exit_code); });
}

}  // namespace offnominal::desk
