#include "common/input_name.hpp"

#include <algorithm>
#include <filesystem>
#include <system_error>

namespace offnominal::desk {
namespace {

constexpr const char* kStandardInput = "standard input";

bool is_standard_input(const std::string& file) {
  return names_standard_input(file) || file == "/dev/stdin" || file == "/dev/fd/0" ||
         file == "/proc/self/fd/0";
}

bool is_there(const std::string& file) {
  std::error_code failure;
  return is_standard_input(file) || std::filesystem::exists(file, failure);
}

}  // namespace

bool names_standard_input(const std::filesystem::path& file) { return file == "-"; }

std::string shown_name(const std::filesystem::path& file) {
  return names_standard_input(file) ? kStandardInput : file.string();
}

std::vector<std::filesystem::path> recording_files(const std::filesystem::path& recording) {
  const std::string name = recording.string();
  if (name.find('+') == std::string::npos) return {recording};
  std::vector<std::filesystem::path> files;
  for (std::size_t begin = 0; begin <= name.size();) {
    // The longest that is there, else up to the next '+'.
    std::size_t end = name.size();
    while (end != std::string::npos && end > begin && !is_there(name.substr(begin, end - begin))) {
      end = name.rfind('+', end - 1);
      if (end != std::string::npos && end < begin) end = std::string::npos;
    }
    const bool found = end != std::string::npos && end > begin;
    if (!found) end = std::min(name.find('+', begin), name.size());
    if (end == begin) return {recording};
    files.emplace_back(name.substr(begin, end - begin));
    begin = end + 1;
  }
  return files;
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
