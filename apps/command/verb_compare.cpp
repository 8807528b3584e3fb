#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "command/answer.hpp"
#include "command/command_line.hpp"
#include "command/doctor.hpp"
#include "command/input_options.hpp"
#include "command/progress.hpp"
#include "command/read_robot.hpp"
#include "command/recordings.hpp"
#include "command/verbs.hpp"
#include "common/error.hpp"
#include "compare/compare_report.hpp"
#include "log/log_format.hpp"
#include "log/read_log.hpp"
#include "robot/robot_file.hpp"

namespace offnominal::desk {
namespace {

struct CompareOptions {
  std::vector<std::string> logs;
  std::string robot;
  std::optional<std::string> against;
  ChannelOptions channels;
  FilterRequest filter;
  std::vector<KeepFault> keep;
  AnswerOptions answer;
};

std::optional<RobotDescription> read_older(const CompareOptions& options,
                                           const RobotDescription& robot) {
  if (!options.against) return std::nullopt;
  RobotDescription older = read_robot_file(*options.against);
  if (older.joint_count() == robot.joint_count()) return older;
  throw InputError({*options.against, "", fmt::format("{} joints", older.joint_count()),
                    fmt::format("{}, as in {}", robot.joint_count(), options.robot),
                    "give an older file of the same robot"});
}

void run(const CompareOptions& options, const std::string& command_line) {
  Progress progress;
  check_all_differ("compare", "LOG", options.logs);
  check_payloads("compare", options.channels, options.logs);
  const RobotDescription robot = read_robot(options.robot);
  const std::optional<RobotDescription> older = read_older(options, robot);
  std::vector<Log> logs =
      read_recordings(options.logs, robot, options.channels, read_log, progress);
  check_all_differ("compare", "LOG", logs);
  const auto faults = treated({logs}, robot, options.keep, progress);
  progress.begin("computing the model's torque");
  const FilterPlan plan = plan_filter(logs, robot, options.filter);
  std::vector<Comparison> now;
  std::vector<Comparison> before;
  for (Log& log : logs) {
    const Measurement measured = measure(std::move(log), robot, plan);
    now.push_back(compare(robot, measured));
    if (older) before.push_back(compare(*older, measured));
  }
  const Comparisons comparisons = together(std::move(now));
  std::optional<Comparisons> of_older;
  if (older) of_older = together(std::move(before));
  const Comparisons* against = of_older ? &*of_older : nullptr;
  progress.end();
  const CompareNames names{options.logs, options.robot, command_line, options.against.value_or("")};
  write_report(options.answer,
               [&] { return with_faults(page_of(comparisons, names, against), faults); });
  print_answer(
      options.answer, [&] { return with_faults(to_json(comparisons, names, against), faults); },
      [&] { return text_of(comparisons, names, against); });
}

}  // namespace

void set_up_compare(CLI::App& verb, ExitCode& /*exit_code*/) {
  const auto options = std::make_shared<CompareOptions>();
  verb.add_option("LOG", options->logs, "One recording or several, " + log_format_names())
      ->required();
  verb.add_option("--robot", options->robot, "Robot file")->required();
  verb.add_option("--against", options->against,
                  "An older file of the robot: prints how far the error has fallen from it");
  add_channels_option(verb, options->channels, "recordings'");
  add_filter_options(verb, options->filter);
  add_keep_option(verb, options->keep);
  add_page_options(verb, options->answer);
  add_json_option(verb, options->answer);
  verb.footer(
      "Several recordings are compared one by one, with one filter, and all together. "
      "Velocity and acceleration come from the low-passed position. Measured and model torque pass "
      "the same low-pass, without phase; the recording's ends, where the filter has not settled, "
      "are "
      "left out. Without a channel map the recording's columns are t, q1.., dq1.., tau1.. in SI "
      "units.");
  verb.callback([&verb, options] { run(*options, command_line_of(verb)); });
}

}  // namespace offnominal::desk
