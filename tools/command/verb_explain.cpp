#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "command/command_line.hpp"
#include "command/progress.hpp"
#include "command/recordings.hpp"
#include "command/verbs.hpp"
#include "common/output_file.hpp"
#include "discovery/explain_report.hpp"
#include "log/log_format.hpp"
#include "report/page.hpp"
#include "robot/robot_file.hpp"

namespace offnominal::tools {
namespace {

struct ExplainOptions {
  std::vector<std::string> logs;
  std::vector<std::string> holdout;
  std::string robot;
  std::optional<std::filesystem::path> channels;
  discovery::ExplainOptions explain;
  std::optional<std::string> report;
  bool force = false;
  bool json = false;
};

void run(const ExplainOptions& options, const std::string& command_line) {
  check_recordings_differ("explain", "LOG", options.logs, options.holdout);
  Progress progress;
  const RobotDescription robot = read_robot_file(options.robot);
  const std::vector<Log> logs =
      read_recordings_or_hold_maps(options.logs, robot, options.channels, progress);
  const std::vector<Log> holdout =
      read_recordings_or_hold_maps(options.holdout, robot, options.channels, progress);
  check_recordings_differ("explain", "LOG", logs, holdout);
  discovery::ExplainOptions explain = options.explain;
  explain.robot_file = options.robot;
  const discovery::Explanation explanation = discovery::explain(
      robot, logs, holdout, explain, [&](const std::string& doing) { progress.begin(doing); });
  progress.end();
  const discovery::ExplainNames names{options.logs, options.holdout, options.robot, command_line,
                                      options.channels ? options.channels->string() : ""};
  if (options.report)
    report::write_page(*options.report, page_of(explanation, names), existing_if(options.force));
  if (options.json) {
    std::cout << to_json(explanation, names).dump(2) << '\n';
    return;
  }
  std::cout << text_of(explanation, names);
  if (options.report) std::cout << "written: " << *options.report << '\n';
}

}  // namespace

void register_explain(CLI::App& app, ExitCode& exit_code) {
  static_cast<void>(exit_code);
  CLI::App* verb = app.add_subcommand(
      "explain", "Say which physical effect a model lacks, by recordings, with the evidence");
  const auto options = std::make_shared<ExplainOptions>();
  options->explain.threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  verb->add_option("LOG", options->logs, "Recordings, " + log_format_names())->required();
  verb->add_option("--robot", options->robot, "Robot file")->required();
  verb->add_option("--holdout", options->holdout,
                   "Recordings that no fit may see. Without any, blocks of time are held out");
  verb->add_option("--channels", options->channels,
                   "TOML file that maps the recordings' columns, instead of the robot file's "
                   "[channels]");
  verb->add_option("--link-share", options->explain.link_share,
                   "How far mass and inertia of a link may be off the file, as a share")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  verb->add_option("--replays", options->explain.replays,
                   "How often each finding is checked against the model without it; 0: never")
      ->check(CLI::Range(0, 10000))
      ->capture_default_str();
  verb->add_option("--seed", options->explain.seed, "Seed of the bootstrap and of the replays")
      ->capture_default_str();
  verb->add_option("--threads", options->explain.threads,
                   "Threads; the result does not depend on their number")
      ->check(CLI::Range(1, 256));
  verb->add_option("--report", options->report, "Write the pictures as an HTML page")
      ->type_name(kNewPage);
  verb->add_flag("--force", options->force, "Replace the file of --report, whatever it is");
  verb->add_flag("--json", options->json, "Print one JSON object and nothing else");
  verb->footer(
      "Verdicts: explained, found, ambiguous, parameter_shift, unknown_state_dependent, "
      "unknown_external, not_excited, data_fault. A diagnostic aid: it does not replace a look at "
      "the recordings.");
  verb->callback([verb, options] { run(*options, command_line_of(*verb)); });
}

}  // namespace offnominal::tools
