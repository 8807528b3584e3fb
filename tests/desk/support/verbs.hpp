#pragma once

#include <sstream>
#include <string>
#include <vector>

#include "desk/support/run_command.hpp"
#include "support/places.hpp"

namespace offnominal::test {

/// The verbs as the command's help lists them, below its heading.
inline std::vector<std::string> verbs() {
  std::istringstream help(run_command(command_file(), {"--help"}).out);
  std::vector<std::string> names;
  bool listed = false;
  for (std::string line; std::getline(help, line);) {
    if (listed && line.starts_with("  ") && line.size() > 2 && line[2] != ' ') {
      names.push_back(line.substr(2, line.find(' ', 2) - 2));
    }
    listed = listed || line.starts_with("Subcommands:");
  }
  return names;
}

}  // namespace offnominal::test
