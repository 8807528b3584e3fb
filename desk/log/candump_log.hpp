#pragma once

#include <cstddef>
#include <functional>
#include <offnominal/hal/bus/frame.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "log/named_columns.hpp"
#include "log/recording_file.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk {

/// A frame of a `candump -l` log.
struct CandumpFrame {
  hal::Frame frame;
  double time_s = 0;
  std::string interface;
};

/// One line without its end; none for a line of another form.
[[nodiscard]] std::optional<CandumpFrame> parse_candump_line(std::string_view line);

/// Every frame of a `candump -l` log with its line, from 1. Throws InputError for a line of another
/// form, but for the last one, which a killed program may have left short.
void each_candump_frame(RecordingFile& file,
                        const std::function<void(const CandumpFrame&, std::size_t line)>& take);

/// Whether the file's first line is one of a `candump -l` log.
[[nodiscard]] bool is_candump_file(const RecordingFile& file);

/// The signals of a `candump -l` log as columns "message.signal" in the DBC's units, over the
/// frames of the first message in the log that holds a required one: column "t" has their time
/// stamps. Of every other signal a row takes the value that came nearest in time. The DBC file is
/// that of `channels`; where they are null or name none, offnominal's own. Of its messages, in
/// another file too, the columns are also t, q1.., dq1.., tau1.. (the applied torque); records
/// whose CRC is wrong are left out, and a joint whose readings have no velocity has no dq. Throws
/// InputError for a line of another form, but for the last one, which a killed program may have
/// left short; where no frame of a required signal is in the log; and where one of them pauses for
/// longer than kMostMissed of the first message's periods.
[[nodiscard]] NamedColumns read_candump(RecordingFile& file, const ChannelMap* channels,
                                        const NeedOf& need_of);

inline constexpr double kMostMissed = 5;

}  // namespace offnominal::desk
