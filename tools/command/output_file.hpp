#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace offnominal::tools {

bool same_file(const std::string& a, const std::string& b);

// Throws InputError, in the name of `verb` ("add") and the option that names the file ("-o"), when
// `output` is one of the recordings, or is there already and `force` does not allow to replace it.
void check_output_file(const std::string& verb, const std::string& option,
                       const std::string& output, bool force,
                       const std::vector<std::string>& recordings = {});

// Throws InputError when `output` is one of the files that the verb reads.
void check_output_is_no_input(const std::string& verb, const std::string& option,
                              const std::string& output, const std::vector<std::string>& inputs);

// Throws InputError when the page that --report of a verb names is another file of its command
// line, one that it reads or one that it writes.
void check_report_apart(const CLI::App& verb);

}  // namespace offnominal::tools
