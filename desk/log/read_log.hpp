#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "log/log.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk {

// Reads a recording of one of the kinds in log_format.hpp, told apart by content and extension.
// It may come through a pipe; the path "-" is standard input (recording_file.hpp).
//
// With a channel map its names are looked up; without one the common header is expected:
// t, q1..qn, dq1..dqn, tau1..taun in SI units, in any order; a missing dq is derived from q, and
// whatever other numeric column is there becomes an extra quantity.
//
// Sampling: steps that differ by at most kSamplingJitter of their mean are taken as even. Otherwise
// the recording is resampled to its median step (positions by a cubic spline, the rest by straight
// lines) and a remark says so.
//
// Throws InputError, with the place in the file, when a column is missing (the message lists those
// that are there), is not numeric, or differs in length from the time; when the number of joints is
// not joint_count; when in most rows a value is not finite, or time does not ascend in more than a
// few: rows of that kind are left out otherwise (usable_rows.hpp); when there are fewer than
// kMinSamples samples, or gaps that leave less than a quarter of the rows (sampling.hpp).
//
// "a.csv+b.csv" are two files of one recording (joined_files.hpp). Units that a file says of its
// columns are taken where the channels say neither unit nor scale, positions that jump by 2 pi as
// an angle folded into a turn does are unfolded, both with a remark. `period_s` takes the place of
// the channels' time.
Log read_log(const std::filesystem::path& path, int joint_count,
             const std::optional<ChannelMap>& channels,
             std::optional<double> period_s = std::nullopt);

// What a command line says of a recording's columns.
struct ChannelOptions {
  std::optional<std::filesystem::path> file;    // with [channels], instead of the robot file's
  std::optional<double> period_s;               // instead of a time, s
  std::vector<RecordingPayload> payloads = {};  // before what the channels say of payloads
};

// The recording as the robot's file maps it, unless the options say otherwise. Throws InputError
// where that says that it is a hold map.
Log read_log(const std::filesystem::path& path, const RobotDescription& robot,
             const ChannelOptions& options = {});

// The same for a recording in time or a hold map (hold_map.hpp), as the channels say.
Log read_log_or_hold_map(const std::filesystem::path& path, const RobotDescription& robot,
                         const ChannelOptions& options);

inline constexpr int kMinReadings = 200;  // of a hold map
inline constexpr double kSamplingJitter = 0.01;
inline constexpr int kMinSamples = 10;
inline constexpr double kMaxGap = 5;

}  // namespace offnominal::desk
