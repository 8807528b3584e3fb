#include "command/output_file.hpp"

#include <filesystem>

#include "command/refuse_option.hpp"

namespace offnominal::tools {

bool same_file(const std::string& a, const std::string& b) {
  std::error_code not_there;
  return std::filesystem::equivalent(a, b, not_there) && !not_there;
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
