#include "common/input_name.hpp"

#include <filesystem>
#include <string_view>
#include <system_error>

namespace offnominal::desk {
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

std::vector<std::filesystem::path> recording_files(const std::filesystem::path& recording) {
  const std::string name = recording.string();
  std::error_code failure;
  if (name.find('+') == std::string::npos || std::filesystem::exists(recording, failure)) {
    return {recording};
  }
  std::vector<std::filesystem::path> files;
  std::string_view left = name;
  for (;;) {
    const std::size_t plus = left.find('+');
    const std::string_view file = left.substr(0, plus);
    if (file.empty()) return {recording};
    files.emplace_back(file);
    if (plus == std::string_view::npos) return files;
    left.remove_prefix(plus + 1);
  }
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
  if (const auto files = recording_files(file); files.size() > 1) {
    std::string names;
    for (const auto& one : files) names += (names.empty() ? "" : "+") + input_name(one.string());
    return names;
  }
  return std::filesystem::path(file).filename().string();
}

std::string extension_of(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  for (char& c : extension) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return extension;
}

}  // namespace offnominal::desk
