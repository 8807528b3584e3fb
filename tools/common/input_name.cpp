#include "common/input_name.hpp"

#include <filesystem>

namespace offnominal::tools {
namespace {

bool is_standard_input(const std::string& file) {
  return file == "-" || file == "/dev/stdin" || file == "/dev/fd/0" || file == "/proc/self/fd/0";
}

}  // namespace

bool is_stream(const std::string& file) {
  if (is_standard_input(file)) return true;
  if (file.starts_with("/dev/fd/") || file.starts_with("/proc/self/fd/")) return true;
  std::error_code failure;
  return std::filesystem::is_fifo(file, failure) && !failure;
}

std::string input_name(const std::string& file) {
  if (is_standard_input(file)) return "standard input";
  if (is_stream(file)) return "a pipe";
  return std::filesystem::path(file).filename().string();
}

}  // namespace offnominal::tools
