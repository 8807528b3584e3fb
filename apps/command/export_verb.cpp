#include "command/export_verb.hpp"

#include <fmt/format.h>

#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "command/answer.hpp"
#include "command/read_robot.hpp"
#include "common/file.hpp"
#include "common/output_file.hpp"

namespace offnominal::desk {
namespace {

struct ExportOptions {
  std::string robot;
  std::string output;
  AnswerOptions answer;
};

void run(const ExportOptions& options, const ExportFormat& format) {
  const RobotDescription robot = read_robot(options.robot);
  const exchange::ExportedRobot exported = format.write(robot, options.robot);
  write_file_atomically(options.output, exported.text, options.answer.existing());
  for (const std::string& what : exported.changed) std::cerr << "changed: " << what << '\n';
  for (const std::string& what : exported.not_carried) std::cerr << "not carried: " << what << '\n';
  const auto json = [&] {
    return nlohmann::ordered_json{
        {"robot", robot.name},         {"robot_file", options.robot},
        {"format", format.name},       {"joints", robot.joint_count()},
        {"changed", exported.changed}, {"not_carried", exported.not_carried},
        {"written", options.output}};
  };
  const auto text = [&] {
    return fmt::format("{}: {} {} as {}\n", robot.name, robot.joint_count(),
                       robot.joint_count() == 1 ? "joint" : "joints", format.name);
  };
  print_answer(options.answer, json, text, {options.output});
}

}  // namespace

void set_up_export(CLI::App& verb, const ExportFormat& format) {
  const auto options = std::make_shared<ExportOptions>();
  verb.add_option("ROBOT", options->robot, "Robot file")->required();
  verb.add_option("-o,--output", options->output, fmt::format("The {} to write", format.name))
      ->type_name(kNewFile)
      ->required();
  add_force_option(verb, options->answer, "Replace the file if it is there");
  add_json_option(verb, options->answer);
  verb.footer(
      "What stands there in another form, and what the format has no place for, is listed on "
      "stderr "
      "and in a comment of the file (docs/your-own-arm.md).");
  verb.callback([options, format] { run(*options, format); });
}

}  // namespace offnominal::desk
