#include <CLI/CLI.hpp>
#include <memory>
#include <optional>
#include <string>

#include "command/answer.hpp"
#include "command/command_line.hpp"
#include "command/progress.hpp"
#include "command/verbs.hpp"
#include "common/numeric_options.hpp"
#include "log/log_format.hpp"
#include "look/look.hpp"
#include "look/look_report.hpp"
#include "robot/robot_file.hpp"

namespace offnominal::desk {
namespace {

struct LookOptions {
  std::string recording;
  std::optional<std::string> robot;
  std::optional<double> period_s;
  AnswerOptions answer;
};

void run(const LookOptions& options, const std::string& command_line) {
  Progress progress;
  std::optional<RobotDescription> robot;
  if (options.robot) robot = read_robot_file(*options.robot, Blanks::kAllowed);
  progress.begin("reading " + options.recording);
  const Look look = look_at(options.recording, robot ? &*robot : nullptr, options.period_s);
  progress.end();
  write_report(options.answer, [&] { return page_of(look, command_line); });
  print_answer(
      options.answer, [&] { return to_json(look); }, [&] { return text_of(look); });
}

}  // namespace

void set_up_look(CLI::App& verb, ExitCode& /*exit_code*/) {
  const auto options = std::make_shared<LookOptions>();
  verb.add_option("RECORDING", options->recording, "Recording, " + log_format_names())->required();
  verb.add_option(
      "--robot", options->robot,
      "Robot file: its [channels] are shown as they read the recording; without them, for the "
      "number of joints, their names and their limits");
  verb.add_option("--period", options->period_s,
                  "Time between two samples, s, where no column has it")
      ->check(above_zero());
  add_page_options(verb, options->answer);
  add_json_option(verb, options->answer);
  verb.footer(
      "Says what was understood of every column: unit, range, step, what rests and what stays at "
      "an end; and prints the [channels] that would read it, to be pasted into a robot file. What "
      "is taken for what follows from the columns' names; where there is no header, from the "
      "numbers. With a robot file that has [channels] it shows what these read. FILE+FILE are two "
      "files of one recording.");
  verb.callback([&verb, options] { run(*options, command_line_of(verb)); });
}

}  // namespace offnominal::desk
