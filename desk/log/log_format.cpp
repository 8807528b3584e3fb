#include "log/log_format.hpp"

#include <algorithm>
#include <array>
#include <string_view>

#include "common/error.hpp"
#include "common/input_name.hpp"
#include "common/nearest.hpp"
#include "log/candump_log.hpp"
#include "log/csv_log.hpp"
#include "log/mat_log.hpp"

namespace offnominal::desk {
namespace {

// Control characters that no text has.
bool has_bytes_of_no_text(std::string_view bytes) {
  return std::any_of(bytes.begin(), bytes.end(), [](char c) {
    return static_cast<unsigned char>(c) < 0x20 && c != '\t' && c != '\n' && c != '\r' && c != '\f';
  });
}

constexpr std::array<LogFormat, 3> kFormats = {{
    {"CSV", nullptr, read_csv, nullptr},
    {"MATLAB .mat", is_mat_file, read_mat, nullptr},
    {"candump -l", is_candump_file, read_candump, read_drive_frames},
}};

// What recordings come in and this does not read, with what to do instead.
struct OtherFormat {
  const char* words;
  std::string_view beginning;   // of its bytes
  std::string_view extensions;  // in small letters, a blank between two
  const char* mend;
};

constexpr const char* kByPandas =
    "write its columns as CSV: in Python, pandas.read_...(FILE).to_csv(\"recording.csv\", "
    "index=False)";
constexpr const char* kByRosTopic =
    "write the topic as CSV: rostopic echo -b FILE -p /joint_states > recording.csv";
constexpr const char* kByRos2Topic =
    "write the topic as CSV: ros2 topic echo --csv /joint_states > recording.csv while ros2 bag "
    "play plays it, or export it from PlotJuggler";
constexpr const char* kByNumpy =
    "write it as text: in Python, numpy.savetxt(\"recording.csv\", A, delimiter=\",\", "
    "header=\"t,q1,tau1\")";
constexpr const char* kUnpack = "unpack it, and name what is in it; packed with gzip it is read";

using namespace std::string_view_literals;

constexpr std::array kOthers = {
    OtherFormat{"a workbook of a spreadsheet", "\xD0\xCF\x11\xE0"sv, ".xlsx .xlsm .xls .ods",
                "save its sheet as CSV: Save as, CSV UTF-8"},
    OtherFormat{"an HDF5 file", "\x89HDF\r\n\x1A\n"sv, ".h5 .hdf5 .hdf", kByPandas},
    OtherFormat{"a Parquet file", "PAR1"sv, ".parquet", kByPandas},
    OtherFormat{"a Feather file", "ARROW1"sv, ".feather .arrow", kByPandas},
    OtherFormat{"a bag of ROS 1", "#ROSBAG"sv, ".bag", kByRosTopic},
    OtherFormat{"an MCAP file", "\x89MCAP"sv, ".mcap", kByRos2Topic},
    OtherFormat{"an SQLite file: a bag of ROS 2, or results of offnominal", "SQLite format 3\0"sv,
                ".db3 .sqlite3", kByRos2Topic},
    OtherFormat{"an array of numpy", "\x93NUMPY"sv, ".npy .npz", kByNumpy},
    OtherFormat{"a pickle of Python", {}, ".pkl .pickle", kByPandas},
    OtherFormat{"a log of PX4", "ULog"sv, ".ulg", "write it as CSV: ulog2csv FILE"},
    OtherFormat{"a TDMS file", "TDSm"sv, ".tdms", "export its channels as CSV"},
    OtherFormat{"an MDF file", "MDF     "sv, ".mf4 .mdf", "export its channels as CSV"},
    OtherFormat{"a ZIP archive", "PK\x03\x04"sv, ".zip", kUnpack},
    OtherFormat{"data packed with xz",
                "\xFD"
                "7zXZ"sv,
                ".xz", kUnpack},
    OtherFormat{"data packed with bzip2", "BZh"sv, ".bz2", kUnpack},
    OtherFormat{"data packed with zstd", "\x28\xB5\x2F\xFD"sv, ".zst", kUnpack},
};

bool has_extension(const OtherFormat& format, const std::string& extension) {
  return !extension.empty() &&
         (std::string(format.extensions) + ' ').find(extension + ' ') != std::string::npos;
}

// By its extension first, since several formats are archives inside. A text is read, whatever it is
// called and begins with.
void refuse_other_format(const RecordingFile& file) {
  const std::string_view begin = file.beginning();
  if (!has_bytes_of_no_text(begin)) return;
  const std::string extension = extension_of(file.path());
  const auto* found = std::find_if(kOthers.begin(), kOthers.end(), [&](const OtherFormat& format) {
    return has_extension(format, extension);
  });
  if (found == kOthers.end()) {
    found = std::find_if(kOthers.begin(), kOthers.end(), [&](const OtherFormat& format) {
      return !format.beginning.empty() && begin.starts_with(format.beginning);
    });
  }
  if (found == kOthers.end()) return;
  throw InputError(
      {file.name(), "", found->words, "a recording: " + log_format_names(), found->mend});
}

}  // namespace

NamedColumns read_in(const LogFormat& format, RecordingFile& file, const ChannelMap* channels,
                     const std::optional<RobotBus>& bus, const NeedOf& need_of) {
  const bool has_dbc = channels != nullptr && !channels->dbc.empty();
  if (bus && format.read_bus != nullptr && !has_dbc) return format.read_bus(file, *bus);
  return format.read(file, channels, need_of);
}

std::span<const LogFormat> log_formats() { return kFormats; }

const LogFormat& log_format_of(const RecordingFile& file) {
  const auto found = std::find_if(kFormats.begin(), kFormats.end(), [&](const LogFormat& format) {
    return format.recognises != nullptr && format.recognises(file);
  });
  if (found != kFormats.end()) return *found;
  refuse_other_format(file);
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
