#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "command/answer.hpp"
#include "command/command_line.hpp"
#include "command/doctor.hpp"
#include "command/input_options.hpp"
#include "command/progress.hpp"
#include "command/verbs.hpp"
#include "common/error.hpp"
#include "compare/compare_report.hpp"
#include "log/log_format.hpp"
#include "log/read_log.hpp"
#include "robot/robot_file.hpp"

namespace offnominal::desk {
namespace {

struct CompareOptions {
  std::string log;
  std::string robot;
  std::optional<std::string> against;
  ChannelOptions channels;
  FilterRequest filter;
  AnswerOptions answer;
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
  const auto faults = examined({std::span(&log, 1)}, robot, progress);
  progress.begin("filtering");
  const Measurement measured = measure(std::move(log), robot, options.filter);
  progress.begin("computing the model's torque");
  const Comparison comparison = compare(robot, measured);
  std::optional<Comparison> before;
  if (older) before = compare(*older, measured);
  const Comparison* against = before ? &*before : nullptr;
  progress.end();
  const CompareNames names{options.log, options.robot, command_line, options.against.value_or("")};
  write_report(options.answer,
               [&] { return with_faults(page_of(comparison, names, against), faults); });
  print_answer(
      options.answer, [&] { return with_faults(to_json(comparison, names, against), faults); },
      [&] { return text_of(comparison, names, against); });
}

}  // namespace

void set_up_compare(CLI::App& verb, ExitCode& /*exit_code*/) {
  const auto options = std::make_shared<CompareOptions>();
  verb.add_option("LOG", options->log, "Recording, " + log_format_names())->required();
  verb.add_option("--robot", options->robot, "Robot file")->required();
  verb.add_option("--against", options->against,
                  "An older file of the robot: prints how far the error has fallen from it");
  add_channels_option(verb, options->channels, "recording's");
  add_filter_options(verb, options->filter);
  add_page_options(verb, options->answer);
  add_json_option(verb, options->answer);
  verb.footer(
      "Velocity and acceleration come from the low-passed position. Measured and model torque pass "
      "the same low-pass, without phase; the recording's ends, where the filter has not settled, "
      "are "
      "left out. Without a channel map the recording's columns are t, q1.., dq1.., tau1.. in SI "
      "units.");
  verb.callback([&verb, options] { run(*options, command_line_of(verb)); });
}

}  // namespace offnominal::desk
