#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "calibrate/calibrate.hpp"
#include "calibrate/calibrate_joints.hpp"
#include "calibrate/calibrate_report.hpp"
#include "calibrate/joints_report.hpp"
#include "command/answer.hpp"
#include "command/command_line.hpp"
#include "command/doctor.hpp"
#include "command/fault_free.hpp"
#include "command/input_options.hpp"
#include "command/progress.hpp"
#include "command/read_robot.hpp"
#include "command/recordings.hpp"
#include "command/refuse_option.hpp"
#include "command/verbs.hpp"
#include "command/write_robot.hpp"
#include "common/error.hpp"
#include "common/output_file.hpp"
#include "log/log_format.hpp"
#include "log/read_log.hpp"
#include "replay/monitor_filter.hpp"
#include "robot/robot_file.hpp"

namespace offnominal::desk {
namespace {

struct CalibrateOptions {
  FitFiles files;
  std::string output;
  double alarms_per_hour = 0.1;
  std::optional<double> act_alarms_per_hour;
  std::optional<double> velocity_error;
  std::vector<KeepFault> keep;
  AnswerOptions answer;
};

void check_numbers(const CalibrateOptions& options) {
  if (!(options.alarms_per_hour >= 1e-6 && options.alarms_per_hour <= 60)) {
    refuse_option("calibrate", "--alarms-per-hour", fmt::format("{:g}", options.alarms_per_hour),
                  "1e-6 to 60");
  }
  const double act = options.act_alarms_per_hour.value_or(options.alarms_per_hour);
  if (!(act >= 1e-9 && act <= options.alarms_per_hour)) {
    refuse_option("calibrate", "--act-alarms-per-hour", fmt::format("{:g}", act),
                  fmt::format("1e-9 to --alarms-per-hour, which is {:g}", options.alarms_per_hour));
  }
  const double error = options.velocity_error.value_or(0);
  if (!(error >= 0 && std::isfinite(error))) {
    refuse_option("calibrate", "--velocity-error", fmt::format("{:g}", error),
                  "at least 0, rad/s or m/s");
  }
}

void check_act(const CalibrateOptions& options, const RobotDescription& robot) {
  if (!options.act_alarms_per_hour || robot.estimator.space == EstimatorSpace::kTorque) return;
  refuse_option("calibrate", "--act-alarms-per-hour",
                fmt::format("{:g}, beside one threshold of all joints in {}",
                            *options.act_alarms_per_hour, options.files.robot),
                "none: two levels are of joints that are judged one by one",
                "leave it out, or set estimator.space to \"torque\" in the robot file");
}

void check_velocity_error(const CalibrateOptions& options, const RobotDescription& robot) {
  if (!options.velocity_error || robot.estimator.space != EstimatorSpace::kTorque) return;
  refuse_option("calibrate", "--velocity-error",
                fmt::format("{:g}, beside estimator.space = \"torque\" in {}",
                            *options.velocity_error, options.files.robot),
                "none: what it adds to a joint's momentum depends on the others",
                "leave it out; momentum errors are found with the bounds");
}

// Result: a Calibration, or a JointsCalibration.
template <typename Result, typename Faults>
void tell(const Result& result, const CalibrateOptions& options, const CalibrateNames& names,
          const FitData& data, const Faults& faults, ExitCode& exit_code) {
  write_report(options.answer, [&] { return with_faults(page_of(result, names), faults); });
  std::vector<std::string> written;
  if (result.objections.empty()) {
    write_robot(result.robot, options.files.robot, options.output, options.answer);
    written.push_back(options.output);
  } else {
    exit_code = ExitCode::kCheckFailed;
  }
  const MonitorFilter filter = monitor_filter(data.robot, data.logs.front());
  const auto text = [&] {
    std::string notes;
    std::set<std::string> told;  // a recording may be in parts
    for (const auto* group : {&data.logs, &data.holdout}) {
      for (const Log& log : *group) {
        if (!told.insert(log.file).second) continue;
        for (const std::string& remark : log.remarks) {
          notes += fmt::format("note: {}: {}\n", log.file, remark);
        }
      }
    }
    return notes + words_of(filter) + "\n" + text_of(result, names);
  };
  const auto json = [&] {
    auto told = to_json(result, names);
    told["filter"] = to_json(filter);
    return with_faults(std::move(told), faults);
  };
  print_answer(options.answer, json, text, written);
}

void run(const CalibrateOptions& options, const std::string& command_line, ExitCode& exit_code) {
  check_numbers(options);
  Progress progress;
  RobotDescription robot = read_robot(options.files.robot);
  check_velocity_error(options, robot);
  check_act(options, robot);
  FitData data =
      read_fit_data("calibrate", "LOG", options.files, std::move(robot), read_log, progress);
  const FaultFree healthy = keep_fault_free(data, options.keep, progress);
  observe_velocities(options.files, data);
  progress.begin("shapes of the bound");
  const CalibrateRequest request{
      .alarms_per_hour = options.alarms_per_hour,
      .velocity_error = options.velocity_error,
      .source = "Calibrated by offnominal calibrate on " + file_names(options.files.logs) + ".",
      .left_out = healthy.left_out,
      .act_alarms_per_hour = options.act_alarms_per_hour};
  require_carried(data.robot, options.files.robot);
  const CalibrateNames names{options.files.robot, options.output, command_line};
  const auto on_step = [&progress] { progress.step(); };
  if (data.robot.estimator.space == EstimatorSpace::kTorque) {
    const auto result = calibrate_joints(data.robot, request, data.logs, data.holdout, on_step);
    progress.end();
    tell(result, options, names, data, healthy.faults, exit_code);
  } else {
    const auto result = calibrate(data.robot, request, data.logs, data.holdout, on_step);
    progress.end();
    tell(result, options, names, data, healthy.faults, exit_code);
  }
}
constexpr const char* kHowItCalibrates =
    "The recordings must be free of faults: what they hold is what the monitor will tolerate. The "
    "threshold mu is the bound after the monitor's own filter, and it is mu, not the bound at an "
    "instant, that |e| is held against.\n"
    "Constant, scaled-norm and table bounds are tried; the tightest that keeps the level on parts "
    "it has not seen is taken. Without --holdout the last of several recordings is held out, or "
    "the last fifth of a single one.\n"
    "With estimator.space = \"torque\" each joint gets a bound of its own, a constant or a table "
    "over its speed, load or position, and with fast_alpha_per_s one more behind a second, faster "
    "filter; --act-alarms-per-hour adds a second level to each, and --velocity-error is refused.\n"
    "Exit code 1, and nothing written, when the hold-out data raise more alarms than the level "
    "allows, or when one part's error is so unlike the others' that it may hold a fault.";

}  // namespace

void set_up_calibrate(CLI::App& verb, ExitCode& exit_code) {
  const auto options = std::make_shared<CalibrateOptions>();
  verb.add_option("LOG", options->files.logs, "Fault-free recordings, " + log_format_names())
      ->required();
  verb.add_option("--robot", options->files.robot, "Robot file to start from")->required();
  verb.add_option("--holdout", options->files.holdout, "Fault-free recordings to count alarms on");
  verb.add_option("-o,--output", options->output, "Robot file to write")
      ->type_name(kNewRobotFile)
      ->required();
  add_force_option(verb, options->answer,
                   "Replace files that are there, for -o be it the robot file that is read");
  verb.add_option("--alarms-per-hour", options->alarms_per_hour,
                  "False alarms per hour to aim at, by extrapolation")
      ->capture_default_str();
  verb.add_option("--act-alarms-per-hour", options->act_alarms_per_hour,
                  "The same of a second level, at which the controller acts (stops, compensates) "
                  "and below which it only reports; with estimator.space = \"torque\". Without "
                  "it, it acts on every alarm");
  verb.add_option("--velocity-error", options->velocity_error,
                  "Largest error of the measured velocity, rad/s or m/s, where it is known; "
                  "without it, it is found with the bound. None where "
                  "estimator.space = \"torque\"");
  add_observe_option(verb, options->files.observe_velocity);
  add_channels_option(verb, options->files.channels, "recordings'");
  add_keep_option(verb, options->keep);
  add_report_option(verb, options->answer);
  add_json_option(verb, options->answer);
  verb.footer(kHowItCalibrates);
  verb.callback([&verb, options, &exit_code] { run(*options, command_line_of(verb), exit_code); });
}

}  // namespace offnominal::desk
