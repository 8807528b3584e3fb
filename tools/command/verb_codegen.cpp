#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "codegen/model_header.hpp"
#include "command/verbs.hpp"
#include "common/file.hpp"
#include "common/json_text.hpp"
#include "common/output_file.hpp"
#include "robot/robot_file.hpp"

namespace offnominal::tools {
namespace {

struct CodegenOptions {
  std::string robot;
  std::string output;
  std::string name_space = ModelHeaderOptions{}.name_space;
  bool force = false;
  bool json = false;
};

nlohmann::ordered_json to_json(const CodegenOptions& options, const RobotDescription& robot,
                               const ModelHeader& header) {
  const bool in_float = header.in_float == Status::kOk;
  return {{"robot", robot.name},
          {"robot_file", options.robot},
          {"written", options.output},
          {"namespace", options.name_space},
          {"joints", header.joints},
          {"hidden_units", header.hidden_units},
          {"effects", header.effects},
          {"scalars", in_float ? std::vector<std::string>{"float", "double"}
                               : std::vector<std::string>{"double"}},
          {"status_in_float", name_of(header.in_float)}};
}

void run(const CodegenOptions& options) {
  const RobotDescription robot = read_robot_file(options.robot);
  const ModelHeader header =
      model_header(robot, {.robot_file = options.robot, .name_space = options.name_space});
  write_file_atomically(options.output, header.text, existing_if(options.force));
  if (options.json) {
    std::cout << json_text(to_json(options, robot, header));
    return;
  }
  if (header.in_float != Status::kOk) {
    std::cout << fmt::format("note: for double only; rounded to float the core refuses it ({})\n",
                             name_of(header.in_float));
  }
  std::cout << fmt::format("{}: {} joints, {} effects, {} hidden units\nwritten: {}\n", robot.name,
                           header.joints, header.effects, header.hidden_units, options.output);
}

}  // namespace

void register_codegen(CLI::App& app, ExitCode& exit_code) {
  static_cast<void>(exit_code);
  CLI::App* verb =
      app.add_subcommand("codegen", "Write a robot file as a C++ header of constants for firmware");
  const auto options = std::make_shared<CodegenOptions>();
  verb->add_option("ROBOT", options->robot, "Robot file")->required();
  verb->add_option("-o,--output", options->output, "The header to write")
      ->type_name(kNewFile)
      ->required();
  verb->add_option("--namespace", options->name_space, "Name space of the constants")
      ->capture_default_str();
  verb->add_flag("--force", options->force, "Replace the header if it is there");
  verb->add_flag("--json", options->json, "Print one JSON object and nothing else");
  verb->footer(
      "The constants are templates over the scalar, kMonitorConfig<float> and so on, and equal to "
      "the bit what the tools compute with. The header needs the core's headers and nothing else "
      "(docs/codegen.md).");
  verb->callback([options] { run(*options); });
}

}  // namespace offnominal::tools
