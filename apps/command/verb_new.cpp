#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "command/answer.hpp"
#include "command/refuse_option.hpp"
#include "command/verbs.hpp"
#include "common/error.hpp"
#include "common/file.hpp"
#include "common/input_name.hpp"
#include "common/json_text.hpp"
#include "common/output_file.hpp"
#include "exchange/blank_robot.hpp"
#include "exchange/dh_table.hpp"

namespace offnominal::desk {
namespace {

struct NewOptions {
  std::string table;
  std::optional<std::string> joints;  // as it was written
  std::optional<std::string> convention;
  std::optional<std::string> name;
  std::string output;
  AnswerOptions answer;
};

void run(const NewOptions& options) {
  using exchange::DhConvention;
  if (options.name && options.name->empty())
    refuse_option("new", "--name", "nothing", "a name that is not empty");
  std::optional<DhConvention> convention;
  if (options.convention) {
    convention =
        *options.convention == "modified" ? DhConvention::kModified : DhConvention::kStandard;
  }
  const exchange::DhTable table = exchange::read_dh_table(options.table, convention);
  const std::size_t count = table.rows.size();
  if (options.joints && *options.joints != std::to_string(count)) {
    refuse_option("new", "--joints", *options.joints,
                  fmt::format("{}, the rows of {}", count, options.table),
                  "correct it, or the table");
  }
  const std::string stem =
      as_utf8(std::filesystem::path(input_name(options.output)).stem().string());
  const std::string name = options.name.value_or(stem);
  write_file_atomically(options.output, exchange::blank_robot_text(table, name, options.table),
                        options.answer.existing());
  print_answer(
      options.answer,
      [&] {
        return nlohmann::ordered_json{
            {"robot", name},
            {"joints", count},
            {"convention", exchange::name_of(table.convention)},
            {"notes", table.notes},
            {"blank_needed", {"joint.link.mass_kg", "joint.link.centre_of_mass_m"}},
            {"blank", {"joint.link.inertia_kg_m2", "joint.limits"}},
            {"written", options.output}};
      },
      [&] {
        std::string notes;
        for (const std::string& note : table.notes) notes += "note: " + note + "\n";
        return fmt::format(
            "{}: {} {} of a {} DH table\n{}blank, needed: mass_kg and centre_of_mass_m of every "
            "link\n"
            "blank, may stay so: inertia_kg_m2, limits\nassumed: gravity of 9.81 m/s^2 along -z of "
            "the "
            "base\n",
            on_one_line(name), count, count == 1 ? "joint" : "joints",
            exchange::name_of(table.convention), notes);
      },
      {options.output});
}

}  // namespace

void set_up_new(CLI::App& verb, ExitCode& /*exit_code*/) {
  const auto options = std::make_shared<NewOptions>();
  verb.add_option(
          "--dh", options->table,
          "Table of Denavit-Hartenberg parameters, .toml or else CSV: a_m or a_mm, alpha_rad or "
          "alpha_deg, d_m or d_mm, theta_rad or theta_deg")
      ->required();
  verb.add_option("--convention", options->convention,
                  "Of the table, where it does not say: standard (distal) or modified (Craig)")
      ->check(CLI::IsMember({"standard", "modified"}));
  verb.add_option("--joints", options->joints, "How many joints the table has, as a check")
      ->type_name("UINT");
  verb.add_option("--name", options->name, "The robot's name. Default: that of the file written");
  verb.add_option("-o,--output", options->output, "Robot file to write")
      ->type_name(kNewFile)
      ->required();
  add_force_option(verb, options->answer, "Replace the robot file if it is there");
  add_json_option(verb, options->answer);
  verb.footer(
      "What a DH table does not know, masses above all, stands as blanks in comments, each with "
      "its "
      "unit (docs/your-own-arm.md).");
  verb.callback([options] { run(*options); });
}

}  // namespace offnominal::desk
