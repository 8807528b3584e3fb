#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "command/answer.hpp"
#include "command/verbs.hpp"
#include "common/file.hpp"
#include "common/input_name.hpp"
#include "common/output_file.hpp"
#include "exchange/import_report.hpp"
#include "exchange/import_urdf.hpp"
#include "robot/robot_file.hpp"

namespace offnominal::desk {
namespace {

struct ImportOptions {
  std::string urdf;
  exchange::ChainRequest chain;
  bool nearest_inertia = false;
  std::string output;
  AnswerOptions answer;
};

void run(const ImportOptions& options) {
  const std::string file = names_standard_input(options.urdf) ? "/dev/stdin" : options.urdf;
  const exchange::ImportedRobot imported = exchange::import_urdf(
      read_text_file(file), shown_name(options.urdf), options.chain,
      options.nearest_inertia ? exchange::InertiaRule::kNearest : exchange::InertiaRule::kPossible);
  const std::string text = exchange::robot_text_of(imported, options.urdf);
  static_cast<void>(parse_robot(text, options.output + " (to be written)"));
  write_file_atomically(options.output, text, options.answer.existing());
  print_answer(
      options.answer,
      [&] {
        auto json = exchange::to_json(imported);
        json["urdf"] = options.urdf;
        json["written"] = options.output;
        return json;
      },
      [&] { return exchange::text_of(imported); }, {options.output});
}

}  // namespace

void set_up_import_urdf(CLI::App& verb, ExitCode& /*exit_code*/) {
  const auto options = std::make_shared<ImportOptions>();
  verb.add_option("URDF", options->urdf,
                  "URDF file, or - for standard input; xacro has to be expanded first")
      ->required();
  verb.add_option(
      "--base", options->chain.base,
      "Link that stands still, whose frame the robot file's base is. Default: the root");
  verb.add_option("--tip", options->chain.tip,
                  "Link in which the chain of joints ends. Default: where the only one ends");
  verb.add_flag("--nearest-inertia", options->nearest_inertia,
                "Where no body can have a link's inertia, take the nearest that one can, and say "
                "so. Default: what is off by more than a tenth is refused");
  verb.add_option("-o,--output", options->output, "Robot file to write")
      ->type_name(kNewFile)
      ->required();
  add_force_option(verb, options->answer, "Replace the robot file if it is there");
  add_json_option(verb, options->answer);
  verb.footer(
      "Fixed joints are merged, what moves beside the chain is held still, <dynamics> become "
      "viscous "
      "and Coulomb friction. What was merged, held, left out or assumed is printed, and stands in "
      "the "
      "robot file as comments (docs/your-own-arm.md).");
  verb.callback([options] { run(*options); });
}

}  // namespace offnominal::desk
