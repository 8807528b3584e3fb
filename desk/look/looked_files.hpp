#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "log/drive_frames.hpp"
#include "log/joined_files.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk {

// The columns of a recording before it is known what they are.
struct LookedFiles {
  NamedColumns columns;
  // Of several files, joined as every verb does it; none of a single one, whose time is still to be
  // looked for.
  std::optional<FileTime> time;
  Channel time_channel;
  std::vector<Channel> more_times;
  std::vector<std::string> notes;
};

// Everything that is numeric. Throws InputError; of several files also where one has no time.
[[nodiscard]] LookedFiles read_looked_files(const std::filesystem::path& path,
                                            const RobotDescription* robot,
                                            std::optional<double> period_s);

// The same for channels that are known: what they want has to be there, the rest is welcome, and
// the time is theirs. `bus`: of the robot (drive_frames.hpp).
struct ReadFiles {
  NamedColumns all;        // its time included, where there is one file
  TimedColumns recording;  // what the channels want
};
[[nodiscard]] ReadFiles read_files_of(const std::filesystem::path& path, const ChannelMap& channels,
                                      const std::optional<RobotBus>& bus);

// The time of `channel`; where it counts from 1970 in no seconds, the channel gets the unit, with a
// note. Throws InputError where it is no time.
[[nodiscard]] FileTime looked_time(NamedColumns& columns, Channel& channel, double period_s,
                                   std::vector<std::string>& notes);

}  // namespace offnominal::desk
