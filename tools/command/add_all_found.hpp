#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "command/verbs.hpp"

namespace offnominal::tools {

struct AddAllFound {
  std::vector<std::string> logs;
  std::vector<std::string> holdout;
  std::string robot;
  std::optional<std::filesystem::path> channels;
  std::string output;
  bool force = false;  // replace `output`
  std::optional<double> link_share;
  int threads = 1;
  std::optional<std::string> report;
  bool json = false;
};

/// `offnominal add --all-found`: searches, writes the robot file with everything that was found,
/// prints the error before and after. kCheckFailed, nothing written, where nothing may be added.
void add_all_found(const AddAllFound& options, const std::string& command_line,
                   ExitCode& exit_code);

}  // namespace offnominal::tools
