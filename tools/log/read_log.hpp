#pragma once

#include <filesystem>
#include <optional>

#include "log/log.hpp"
#include "robot/robot.hpp"

namespace offnominal::tools {

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
// not joint_count; when a value is not finite; when time does not ascend; when there are fewer than
// kMinSamples samples, or a gap of more than kMaxGap median steps.
Log read_log(const std::filesystem::path& path, int joint_count,
             const std::optional<ChannelMap>& channels);

// The recording as the robot's file maps it, unless `channels_file` names a file that does. Throws
// InputError where that says that it is a hold map.
Log read_log(const std::filesystem::path& path, const RobotDescription& robot,
             const std::optional<std::filesystem::path>& channels_file = std::nullopt);

// The same for a recording in time or a hold map (hold_map.hpp), as the channels say.
Log read_log_or_hold_map(const std::filesystem::path& path, const RobotDescription& robot,
                         const std::optional<std::filesystem::path>& channels_file);

inline constexpr int kMinReadings = 200;  // of a hold map
inline constexpr double kSamplingJitter = 0.01;
inline constexpr int kMinSamples = 10;
inline constexpr double kMaxGap = 5;

}  // namespace offnominal::tools
