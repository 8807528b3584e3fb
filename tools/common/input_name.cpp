#include "common/input_name.hpp"

#include <filesystem>
#include <system_error>

namespace offnominal::tools {
namespace {

constexpr const char* kStandardInput = "standard input";

bool is_standard_input(const std::string& file) {
  return names_standard_input(file) || file == "/dev/stdin" || file == "/dev/fd/0" ||
         file == "/proc/self/fd/0";
}

}  // namespace

bool names_standard_input(const std::filesystem::path& file) { return file == "-"; }

std::string shown_name(const std::filesystem::path& file) {
  return names_standard_input(file) ? kStandardInput : file.string();
}

bool is_stream(const std::string& file) {
  if (is_standard_input(file)) return true;
  if (file.starts_with("/dev/fd/") || file.starts_with("/proc/self/fd/")) return true;
  std::error_code failure;
  return std::filesystem::is_fifo(file, failure) && !failure;
}

std::string input_name(const std::string& file) {
  if (is_standard_input(file)) return kStandardInput;
  if (is_stream(file)) return "a pipe";
  return std::filesystem::path(file).filename().string();
}

}  // namespace offnominal::tools
