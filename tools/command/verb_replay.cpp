#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstddef>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "command/command_line.hpp"
#include "command/doctor.hpp"
#include "command/verbs.hpp"
#include "common/output_file.hpp"
#include "discovery/data_fault_report.hpp"
#include "log/log_format.hpp"
#include "log/read_log.hpp"
#include "replay/replay.hpp"
#include "report/page.hpp"
#include "robot/robot_file.hpp"

namespace offnominal::tools {
namespace {

constexpr std::size_t kPrintedAlarms = 10;

struct ReplayOptions {
  std::string log;
  std::string robot;
  std::optional<std::filesystem::path> channels;
  std::optional<std::string> report;
  bool force = false;
  bool check = false;
  bool json = false;
};

void print(const Replay& replay) {
  const auto row = [](const std::string& name, const std::string& value) {
    std::cout << fmt::format("  {:<28} {}\n", name, value);
  };
  std::cout << fmt::format("{} on {}: {} samples, tick {:g} ms, {} hidden units, seed {}\n",
                           replay.robot, replay.log, replay.samples(), 1000 * replay.period_s,
                           replay.hidden_units, replay.seed);
  row("largest |e|", fmt::format("{:.4g} {}", replay.error_norm.maxCoeff(), replay.unit));
  row("largest threshold mu", fmt::format("{:.4g} {}", replay.threshold.maxCoeff(), replay.unit));
  row("largest |e| / mu", fmt::format("{:.4g}", replay.max_error_to_threshold));
  for (Eigen::Index joint = 0; joint < replay.psi_hat.cols(); ++joint) {
    const auto index = static_cast<std::size_t>(joint);
    row("largest |psi_hat|, " + replay.joint_names[index],
        fmt::format("{:.4g} {}", replay.psi_hat.col(joint).cwiseAbs().maxCoeff(),
                    replay.acceleration_units[index]));
  }
  for (std::size_t i = 0; i < replay.alarms.size() && i < kPrintedAlarms; ++i) {
    const Alarm& alarm = replay.alarms[i];
    row(i == 0 ? "alarms" : "",
        fmt::format("{:.3f} to {:.3f} s, |e| up to {:.3g} mu", alarm.start_s, alarm.end_s,
                    alarm.max_error_to_threshold));
  }
  if (replay.alarms.size() > kPrintedAlarms) {
    row("", fmt::format("and {} more (--json)", replay.alarms.size() - kPrintedAlarms));
  }
  std::cout << words_of(replay) << '\n';
}

void run(const ReplayOptions& options, const std::string& command_line, ExitCode& exit_code) {
  const RobotDescription robot = read_robot_file(options.robot);
  require_bound(robot, options.robot);
  const Log log = read_log(options.log, robot, options.channels);
  const std::vector<discovery::DataFault> faults = examine_all({std::span(&log, 1)}, robot);
  print_hints(faults);
  const Replay result = replay(robot, log);
  if (options.report) {
    report::Page page = page_of(result, command_line);
    add_faults(faults, page);
    report::write_page(*options.report, page, existing_if(options.force));
  }
  if (options.json) {
    auto json = to_json(result);
    json["data_faults"] = discovery::to_json(faults);
    std::cout << json.dump(2) << '\n';
  } else {
    for (const std::string& remark : log.remarks) std::cout << "note: " << remark << '\n';
    print(result);
    if (options.report) std::cout << "written: " << *options.report << '\n';
  }
  if (options.check && result.detection_time_s) exit_code = ExitCode::kCheckFailed;
}

}  // namespace

void register_replay(CLI::App& app, ExitCode& exit_code) {
  CLI::App* verb = app.add_subcommand(
      "replay", "Run the on-board monitor over a recording: residual, threshold, alarms");
  const auto options = std::make_shared<ReplayOptions>();
  verb->add_option("LOG", options->log, "Recording, " + log_format_names())->required();
  verb->add_option("--robot", options->robot,
                   "Robot file; its uncertainty bound sets the threshold")
      ->required();
  verb->add_option("--channels", options->channels,
                   "TOML file that maps the recording's columns, instead of the robot file's "
                   "[channels]");
  verb->add_option("--report", options->report, "Write the figures as an HTML page")
      ->type_name(kNewPage);
  verb->add_flag("--force", options->force, "Replace the file of --report, whatever it is");
  verb->add_flag("--check", options->check, "Exit with 1 when there is an alarm");
  verb->add_flag("--json", options->json, "Print one JSON object and nothing else");
  verb->footer(
      "The tick is the recording's sampling period. The recording's torque has to be the torque "
      "that was really applied, not the commanded one.");
  verb->callback([verb, options, &exit_code] { run(*options, command_line_of(*verb), exit_code); });
}

}  // namespace offnominal::tools
