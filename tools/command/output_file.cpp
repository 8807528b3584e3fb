#include "command/output_file.hpp"

#include <fmt/format.h>

#include <filesystem>

#include "command/refuse_option.hpp"

namespace offnominal::tools {

bool same_file(const std::string& a, const std::string& b) {
  std::error_code not_there;
  return std::filesystem::equivalent(a, b, not_there) && !not_there;
}

void check_output_is_no_input(const std::string& verb, const std::string& option,
                              const std::string& output, const std::vector<std::string>& inputs) {
  for (const std::string& input : inputs) {
    if (!same_file(output, input)) continue;
    refuse_option(verb, option, output + ", which it reads", "a file of its own");
  }
}

void check_report_apart(const CLI::App& verb) {
  const CLI::Option* report = verb.get_option_no_throw("--report");
  if (report == nullptr || report->count() == 0) return;
  const std::string page = report->results().front();
  for (const CLI::Option* option : verb.get_options()) {
    if (option == report) continue;
    for (const std::string& word : option->results()) {
      std::error_code unknown;
      const bool same =
          same_file(page, word) || std::filesystem::weakly_canonical(page, unknown) ==
                                       std::filesystem::weakly_canonical(word, unknown);
      if (!same) continue;
      const std::string name =
          option->get_positional() ? option->get_name(true) : option->get_name();
      refuse_option(verb.get_name(), "--report", fmt::format("{}, which is that of {}", page, name),
                    "a file of its own");
    }
  }
}

void check_output_file(const std::string& verb, const std::string& option,
                       const std::string& output, bool force,
                       const std::vector<std::string>& recordings) {
  for (const std::string& recording : recordings) {
    if (same_file(output, recording)) {
      refuse_option(verb, option, "a recording", "a robot file");
    }
  }
  if (std::filesystem::exists(output) && !force) {
    refuse_option(verb, option, output + ", which is there already", "a file that is not there yet",
                  "choose another name, or add --force to replace it");
  }
}

}  // namespace offnominal::tools
