#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "analysis/compare_report.hpp"
#include "command/command_line.hpp"
#include "command/doctor.hpp"
#include "command/filter_options.hpp"
#include "command/progress.hpp"
#include "command/verbs.hpp"
#include "common/error.hpp"
#include "common/output_file.hpp"
#include "discovery/data_fault_report.hpp"
#include "log/log_format.hpp"
#include "log/read_log.hpp"
#include "report/page.hpp"
#include "robot/robot_file.hpp"

namespace offnominal::tools {
namespace {

struct CompareOptions {
  std::string log;
  std::string robot;
  std::optional<std::string> against;
  std::optional<std::filesystem::path> channels;
  FilterRequest filter;
  std::optional<std::string> report;
  bool force = false;
  bool json = false;
};

void run(const CompareOptions& options, const std::string& command_line) {
  Progress progress;
  progress.begin("reading " + options.log);
  const RobotDescription robot = read_robot_file(options.robot);
  std::optional<RobotDescription> older;
  if (options.against) older = read_robot_file(*options.against);
  if (older && older->joint_count() != robot.joint_count()) {
    throw InputError({*options.against, "", fmt::format("{} joints", older->joint_count()),
                      fmt::format("{}, as in {}", robot.joint_count(), options.robot),
                      "give an older file of the same robot"});
  }
  Log log = read_log(options.log, robot, options.channels);
  progress.begin("examining the recording");
  const std::vector<discovery::DataFault> faults = examine_all({std::span(&log, 1)}, robot);
  progress.end();
  print_hints(faults);
  progress.begin("filtering");
  const Measurement measured = measure(std::move(log), options.filter);
  progress.begin("computing the model's torque");
  const Comparison comparison = compare(robot, measured);
  std::optional<Comparison> before;
  if (older) before = compare(*older, measured);
  const Comparison* against = before ? &*before : nullptr;
  progress.end();
  const CompareNames names{options.log, options.robot, command_line, options.against.value_or("")};
  if (options.report) {
    report::Page page = page_of(comparison, names, against);
    add_faults(faults, page);
    report::write_page(*options.report, page, existing_if(options.force));
  }
  if (options.json) {
    auto json = to_json(comparison, names, against);
    json["data_faults"] = discovery::to_json(faults);
    std::cout << json.dump(2) << '\n';
    return;
  }
  std::cout << text_of(comparison, names, against);
  if (options.report) std::cout << "written: " << *options.report << '\n';
}

}  // namespace

void register_compare(CLI::App& app, ExitCode& exit_code) {
  static_cast<void>(exit_code);
  CLI::App* verb = app.add_subcommand(
      "compare", "Compare a model with a recording: error per joint, and what it follows");
  const auto options = std::make_shared<CompareOptions>();
  verb->add_option("LOG", options->log, "Recording, " + log_format_names())->required();
  verb->add_option("--robot", options->robot, "Robot file")->required();
  verb->add_option("--against", options->against,
                   "An older file of the robot: prints how far the error has fallen from it");
  verb->add_option("--channels", options->channels,
                   "TOML file that maps the recording's columns, instead of the robot file's "
                   "[channels]");
  add_filter_options(*verb, options->filter);
  verb->add_option("--report", options->report, "Write the pictures as an HTML page")
      ->type_name(kNewPage);
  verb->add_flag("--force", options->force, "Replace the file of --report, whatever it is");
  verb->add_flag("--json", options->json, "Print one JSON object and nothing else");
  verb->footer(
      "Velocity and acceleration come from the low-passed position. Measured and model torque pass "
      "the same low-pass, without phase; the recording's ends, where the filter has not settled, "
      "are "
      "left out. Without a channel map the recording's columns are t, q1.., dq1.., tau1.. in SI "
      "units.");
  verb->callback([verb, options] { run(*options, command_line_of(*verb)); });
}

}  // namespace offnominal::tools
