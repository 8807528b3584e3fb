#pragma once

#include <CLI/CLI.hpp>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

#include "common/json_text.hpp"
#include "common/output_file.hpp"
#include "report/page.hpp"

namespace offnominal::desk {

/// How a verb gives its answer: the options are the same for all of them.
struct AnswerOptions {
  std::optional<std::string> report;
  bool force = false;
  bool json = false;

  [[nodiscard]] Existing existing() const { return existing_if(force); }
};

inline void add_report_option(CLI::App& verb, AnswerOptions& options,
                              const std::string& what = "pictures") {
  verb.add_option("--report", options.report, "Write the " + what + " as an HTML page")
      ->type_name(kNewPage);
}

inline void add_force_option(CLI::App& verb, AnswerOptions& options,
                             const std::string& what = "Replace files that are there") {
  verb.add_flag("--force", options.force, what);
}

inline void add_json_option(CLI::App& verb, AnswerOptions& options) {
  verb.add_flag("--json", options.json, "Print one JSON object and nothing else");
}

/// --report and --force of a verb that writes nothing else.
inline void add_page_options(CLI::App& verb, AnswerOptions& options,
                             const std::string& what = "pictures") {
  add_report_option(verb, options, what);
  add_force_option(verb, options, "Replace the file of --report, whatever it is");
}

/// Writes the page that make_page() gives, where one was asked for.
template <typename MakePage>
void write_report(const AnswerOptions& options, const MakePage& make_page) {
  if (options.report) report::write_page(*options.report, make_page(), options.existing());
}

/// Prints what make_json() gives, where that was asked for; else the text of make_text(), then the
/// names of the files that were written, the page last.
template <typename MakeJson, typename MakeText>
void print_answer(const AnswerOptions& options, const MakeJson& make_json,
                  const MakeText& make_text, std::vector<std::string> written = {}) {
  if (options.json) {
    std::cout << json_text(make_json());
    return;
  }
  std::cout << make_text();
  if (options.report) written.push_back(*options.report);
  for (const std::string& file : written) std::cout << "written: " << file << '\n';
}

}  // namespace offnominal::desk
