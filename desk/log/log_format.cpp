#include "log/log_format.hpp"

#include <algorithm>
#include <array>
#include <iterator>

#include "common/nearest.hpp"
#include "log/candump_log.hpp"
#include "log/csv_log.hpp"
#include "log/mat_log.hpp"

namespace offnominal::desk {
namespace {

constexpr std::array<LogFormat, 3> kFormats = {{
    {"CSV", nullptr, read_csv},
    {"MATLAB .mat", is_mat_file, read_mat},
    {"candump -l", is_candump_file, read_candump},
}};

}  // namespace

std::span<const LogFormat> log_formats() { return kFormats; }

const LogFormat& log_format_of(const RecordingFile& file) {
  const auto found = std::find_if(kFormats.begin(), kFormats.end(), [&](const LogFormat& format) {
    return format.recognises != nullptr && format.recognises(file);
  });
  if (found != kFormats.end()) return *found;
  return *std::find_if(kFormats.begin(), kFormats.end(),
                       [](const LogFormat& format) { return format.recognises == nullptr; });
}

std::string log_format_names() {
  const auto name = [](const LogFormat& format) { return std::string(format.name); };
  std::array<std::string, kFormats.size()> names;
  std::transform(kFormats.begin(), kFormats.end(), names.begin(), name);
  return choice_of(names);
}

}  // namespace offnominal::desk
