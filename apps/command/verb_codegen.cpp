#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstddef>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "codegen/model_header.hpp"
#include "command/answer.hpp"
#include "command/read_robot.hpp"
#include "command/verbs.hpp"
#include "common/amount.hpp"
#include "common/file.hpp"
#include "common/output_file.hpp"

namespace offnominal::desk {
namespace {

struct CodegenOptions {
  std::string robot;
  std::string output;
  std::string name_space = ModelHeaderOptions{}.name_space;
  AnswerOptions answer;
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
  const RobotDescription robot = read_robot(options.robot);
  const ModelHeader header =
      model_header(robot, {.robot_file = options.robot, .name_space = options.name_space});
  write_file_atomically(options.output, header.text, options.answer.existing());
  const auto text = [&] {
    const std::string note =
        header.in_float == Status::kOk
            ? ""
            : fmt::format("note: for double only; rounded to float the core refuses it ({})\n",
                          name_of(header.in_float));
    return note +
           fmt::format("{}: {}, {}, {}\n", robot.name,
                       counted(static_cast<std::size_t>(header.joints), "joint"),
                       counted(static_cast<std::size_t>(header.effects), "effect"),
                       counted(static_cast<std::size_t>(header.hidden_units), "hidden unit"));
  };
  print_answer(options.answer, [&] { return to_json(options, robot, header); }, text,
               {options.output});
}

}  // namespace

void set_up_codegen(CLI::App& verb, ExitCode& /*exit_code*/) {
  const auto options = std::make_shared<CodegenOptions>();
  verb.add_option("ROBOT", options->robot, "Robot file")->required();
  verb.add_option("-o,--output", options->output, "The header to write")
      ->type_name(kNewFile)
      ->required();
  verb.add_option("--namespace", options->name_space, "Name space of the constants")
      ->capture_default_str();
  add_force_option(verb, options->answer, "Replace the header if it is there");
  add_json_option(verb, options->answer);
  verb.footer(
      "The constants are templates over the scalar, kMonitorConfig<float> and so on, and equal to "
      "the bit what the tools compute with. The header needs the core's headers and nothing else "
      "(docs/codegen.md).");
  verb.callback([options] { run(*options); });
}

}  // namespace offnominal::desk
