#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "calibrate/calibrate.hpp"
#include "calibrate/calibrate_report.hpp"
#include "command/command_line.hpp"
#include "command/doctor.hpp"
#include "command/progress.hpp"
#include "command/recordings.hpp"
#include "command/refuse_option.hpp"
#include "command/verbs.hpp"
#include "common/output_file.hpp"
#include "discovery/data_fault_report.hpp"
#include "log/log_format.hpp"
#include "report/page.hpp"
#include "robot/robot_file.hpp"

namespace offnominal::tools {
namespace {

struct CalibrateOptions {
  std::vector<std::string> logs;
  std::vector<std::string> holdout;
  std::string robot;
  std::string output;
  double alarms_per_hour = 0.1;
  std::optional<double> velocity_error;
  std::optional<std::filesystem::path> channels;
  bool force = false;
  std::optional<std::string> report;
  bool json = false;
};

void check_numbers(const CalibrateOptions& options) {
  if (!(options.alarms_per_hour >= 1e-6 && options.alarms_per_hour <= 60)) {
    refuse_option("calibrate", "--alarms-per-hour", fmt::format("{:g}", options.alarms_per_hour),
                  "1e-6 to 60");
  }
  const double error = options.velocity_error.value_or(0);
  if (!(error >= 0 && std::isfinite(error))) {
    refuse_option("calibrate", "--velocity-error", fmt::format("{:g}", error),
                  "at least 0, rad/s or m/s");
  }
}

void run(const CalibrateOptions& options, const std::string& command_line, ExitCode& exit_code) {
  check_numbers(options);
  check_recordings_differ("calibrate", "LOG", options.logs, options.holdout);
  Progress progress;
  const RobotDescription robot = read_robot_file(options.robot);
  const std::vector<Log> logs = read_recordings(options.logs, robot, options.channels, progress);
  const std::vector<Log> holdout =
      read_recordings(options.holdout, robot, options.channels, progress);
  check_recordings_differ("calibrate", "LOG", logs, holdout);
  progress.begin("examining the recordings");
  const std::vector<discovery::DataFault> faults = examine_all({logs, holdout}, robot);
  refuse_spoilt(faults, discovery::RestsOn::kVelocityToo);
  progress.end();
  print_hints(faults);
  progress.begin("shapes of the bound");
  const CalibrateRequest request{
      options.alarms_per_hour, options.velocity_error,
      "Calibrated by offnominal calibrate on " + file_names(options.logs) + "."};
  const Calibration result =
      calibrate(robot, request, logs, holdout, [&progress] { progress.step(); });
  progress.end();
  const CalibrateNames names{options.robot, options.output, command_line};
  const bool good = result.objections.empty();
  if (options.report) {
    report::Page page = page_of(result, names);
    add_faults(faults, page);
    report::write_page(*options.report, page, existing_if(options.force));
  }
  if (good) {
    write_robot_file(result.robot, options.output, existing_if(options.force));
  } else {
    exit_code = ExitCode::kCheckFailed;
  }
  if (options.json) {
    auto json = to_json(result, names);
    json["data_faults"] = discovery::to_json(faults);
    std::cout << json.dump(2) << '\n';
    return;
  }
  for (const auto* group : {&logs, &holdout}) {
    for (const Log& log : *group) {
      for (const std::string& remark : log.remarks) {
        std::cout << "note: " << log.file << ": " << remark << '\n';
      }
    }
  }
  std::cout << text_of(result, names);
  if (good) std::cout << "written: " << options.output << '\n';
  if (options.report) std::cout << "written: " << *options.report << '\n';
}

constexpr const char* kHowItCalibrates =
    "The recordings must be free of faults: what they hold is what the monitor will tolerate. The "
    "threshold mu is the bound after the monitor's own filter, and it is mu, not the bound at an "
    "instant, that |e| is held against.\n"
    "Constant, scaled-norm and table bounds are tried; the tightest that keeps the level on parts "
    "it has not seen is taken. Without --holdout the last of several recordings is held out, or "
    "the last fifth of a single one.\n"
    "Exit code 1, and nothing written, when the hold-out data raise more alarms than the level "
    "allows, or when one part's error is so unlike the others' that it may hold a fault.";

}  // namespace

void register_calibrate(CLI::App& app, ExitCode& exit_code) {
  CLI::App* verb = app.add_subcommand(
      "calibrate", "Find the uncertainty bound from recordings of the healthy robot");
  const auto options = std::make_shared<CalibrateOptions>();
  verb->add_option("LOG", options->logs, "Fault-free recordings, " + log_format_names())
      ->required();
  verb->add_option("--robot", options->robot, "Robot file to start from")->required();
  verb->add_option("--holdout", options->holdout, "Fault-free recordings to count alarms on");
  verb->add_option("-o,--output", options->output, "Robot file to write")
      ->type_name(kNewRobotFile)
      ->required();
  verb->add_flag("--force", options->force,
                 "Replace files that are there, for -o be it the robot file that is read");
  verb->add_option("--alarms-per-hour", options->alarms_per_hour,
                   "False alarms per hour to aim at, by extrapolation")
      ->capture_default_str();
  verb->add_option("--velocity-error", options->velocity_error,
                   "Largest error of the measured velocity, rad/s or m/s, where it is known; "
                   "without it, it is found with the bound");
  verb->add_option("--channels", options->channels,
                   "TOML file that maps the recordings' columns, instead of the robot file's "
                   "[channels]");
  verb->add_option("--report", options->report, "Write the pictures as an HTML page")
      ->type_name(kNewPage);
  verb->add_flag("--json", options->json, "Print one JSON object and nothing else");
  verb->footer(kHowItCalibrates);
  verb->callback([verb, options, &exit_code] { run(*options, command_line_of(*verb), exit_code); });
}

}  // namespace offnominal::tools
