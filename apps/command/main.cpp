#include <malloc.h>

#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdio>
#include <exception>
#include <iostream>
#include <offnominal/version.hpp>
#include <string>
#include <utility>
#include <vector>

#include "command/verbs.hpp"
#include "common/error.hpp"
#include "common/meant_option.hpp"
#include "common/nearest.hpp"
#include "common/numeric_options.hpp"
#include "common/output_file.hpp"
#include "report/page.hpp"

namespace offnominal::desk {
namespace {

std::string version_text() {
  return "offnominal " + std::to_string(kVersionMajor) + "." + std::to_string(kVersionMinor) + "." +
         std::to_string(kVersionPatch);
}

// CLI11 would call a wrong first word an argument that was not expected, and say of a wrong option
// in its place that a subcommand is required.
void check_verb(const CLI::App& app, int argc, char** argv) {
  std::vector<std::string> names;
  for (const Verb& verb : all_verbs()) names.emplace_back(verb.name);
  const std::string word = argc > 1 ? argv[1] : "";
  if (word.starts_with("-") && app.get_option_no_throw(word) != nullptr) return;
  for (const std::string& name : names) {
    if (word == name) return;
  }
  const std::string what = word.starts_with("-") ? "unknown option `" : "unknown verb `";
  const std::string meant = nearest(word, names);
  const std::string mend = "run `offnominal --help`";
  throw InputError({.file = "offnominal",
                    .place = "",
                    .found = argc > 1 ? what + word + "`" : "no verb",
                    .allowed = list_of(names),
                    .mend = meant.empty() ? mend : "write `" + meant + "`, or " + mend});
}

void check_options(const CLI::App& verb) {
  check_numbers(verb);
  check_outputs(verb, report::is_page);
}

// Parse errors of the options; --help and --version come this way too.
ExitCode answer(const CLI::App& app, const CLI::ParseError& error) {
  const CLI::App* verb = &app;
  while (!verb->get_subcommands().empty()) verb = verb->get_subcommands().front();
  if (error.get_exit_code() == static_cast<int>(CLI::ExitCodes::Success)) {
    return static_cast<ExitCode>(app.exit(error, std::cout, std::cerr));
  }
  const std::string name = verb == &app ? "offnominal" : "offnominal " + verb->get_name();
  const std::string meant = meant_option(*verb);
  throw InputError({.file = name,
                    .place = error.what(),
                    .found = "",
                    .allowed = "",
                    .mend = (meant.empty() ? "" : meant + ", or ") + "run `" + name + " --help`"});
}

// The rooms below know an option by its name, not the verb that has it.
InputError in_name_of(const CLI::App& app, const InputError& error) {
  InputProblem problem = error.problem();
  const auto verbs = app.get_subcommands();
  if (verbs.empty() || !problem.file.starts_with("--")) return error;
  const std::string place = problem.place.empty() ? "" : ": " + problem.place;
  problem.place = problem.file + place;
  problem.file = "offnominal " + verbs.front()->get_name();
  return InputError(std::move(problem));
}

ExitCode run(int argc, char** argv) {
  CLI::App app{"Model-based fault diagnosis of robot joints", "offnominal"};
  app.set_version_flag("--version", version_text());
  app.set_help_flag("-h,--help", "Print this help and exit");
  app.require_subcommand(1);
  ExitCode exit_code = ExitCode::kDone;
  for (const Verb& verb : all_verbs()) {
    CLI::App* parser = app.add_subcommand(verb.name, verb.words);
    verb.set_up(*parser, exit_code);
    parser->parse_complete_callback([parser] { check_options(*parser); });
  }
  check_verb(app, argc, argv);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    exit_code = answer(app, error);
  } catch (const InputError& error) {
    throw in_name_of(app, error);
  }
  std::cout.flush();
  if (!std::cout || std::fflush(stdout) != 0) {
    throw InputError({.file = "standard output",
                      .place = "",
                      .found = "that it cannot be written",
                      .allowed = "",
                      .mend = "check where it is directed and whether there is room"});
  }
  return exit_code;
}

}  // namespace
}  // namespace offnominal::desk

int main(int argc, char** argv) {
  using offnominal::desk::ExitCode;
  // Fits make and drop matrices of megabytes by the hundred. Handed back to the system each time,
  // as is usual, they cost a quarter of the time of `explain` in page faults. A matrix of a
  // recording of ten million rows is: of those nothing is kept that is not in use.
  constexpr int kKept = 1 << 30;
  constexpr int kLarge = 1 << 29;
  constexpr int kMostOfOlderLibraries = 1 << 25;
  if (mallopt(M_MMAP_THRESHOLD, kLarge) == 0) mallopt(M_MMAP_THRESHOLD, kMostOfOlderLibraries);
  mallopt(M_TRIM_THRESHOLD, kKept);
  // A file that grows beyond what this user may have is said with its name, and does not end us.
  static_cast<void>(std::signal(SIGXFSZ, SIG_IGN));
  try {
    return static_cast<int>(offnominal::desk::run(argc, argv));
  } catch (const offnominal::desk::InputError& error) {
    std::cerr << error.what() << '\n';
  } catch (const std::exception& error) {
    std::cerr << "offnominal: " << offnominal::desk::on_one_line(error.what()) << '\n';
  }
  return static_cast<int>(ExitCode::kBadInput);
}
