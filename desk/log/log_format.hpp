#pragma once

#include <optional>
#include <span>
#include <string>

#include "log/drive_frames.hpp"
#include "log/named_columns.hpp"
#include "log/recording_file.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk {

/// A kind of file that recordings come in. A new one is its reader, two files, and a row of the
/// table in log_format.cpp; help texts and messages name what the table has.
struct LogFormat {
  const char* name;
  /// Whether a file is of this kind, by its beginning or its extension; null: whatever is of no
  /// other kind.
  bool (*recognises)(const RecordingFile& file);
  /// Reads what `need_of` wants of the file, under its own names or those that `channels`, where
  /// they are not null, tell the reader to find. Throws InputError with the place in the file.
  NamedColumns (*read)(RecordingFile& file, const ChannelMap* channels, const NeedOf& need_of);
  /// Reads a log of a robot's bus, without a DBC file, under the common names; null: of no bus.
  NamedColumns (*read_bus)(RecordingFile& file, const RobotBus& bus) = nullptr;
};

/// By the format: of the robot's bus where there is one, and the channels name no DBC file.
[[nodiscard]] NamedColumns read_in(const LogFormat& format, RecordingFile& file,
                                   const ChannelMap* channels, const std::optional<RobotBus>& bus,
                                   const NeedOf& need_of);

[[nodiscard]] std::span<const LogFormat> log_formats();

/// The first of the formats that recognises the file, else the one for all others. Throws
/// InputError where it is of a kind that is known and not read, with what to export instead: by its
/// beginning, or by its extension where it is no text.
[[nodiscard]] const LogFormat& log_format_of(const RecordingFile& file);

/// "CSV, MATLAB .mat or candump -l"
[[nodiscard]] std::string log_format_names();

}  // namespace offnominal::desk
