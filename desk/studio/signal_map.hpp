#pragma once

#include <compare>
#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "log/named_columns.hpp"
#include "robot/robot.hpp"

// The columns of recordings, signal by signal, as a page shows them and puts them right.

namespace offnominal::desk::studio {

/// Which signal: a quantity of a joint, or the time of a file.
struct SignalKey {
  std::string quantity;   // "time", "position", "velocity" or "torque"
  std::size_t joint = 0;  // from 0; of the time 0
  std::size_t file = 0;   // from 0, of a recording; 0 but for the time

  friend auto operator<=>(const SignalKey&, const SignalKey&) = default;
};

/// What a page says of one signal; what it does not say stays.
struct SignalEdit {
  std::string quantity;                    // as of SignalKey
  std::size_t joint = 0;                   // from 0; of the time not read
  std::optional<std::string> source = {};  // a column; of a velocity empty: derived
  std::optional<std::string> unit = {};
  std::optional<double> scale = {};     // on top of the unit
  std::optional<std::string> of = {};   // "joint", "motor", "current", "sensor"
  std::optional<double> period_s = {};  // of the time: instead of a column; 0: the column
  std::size_t file = 0;                 // of the time: whose, from 0
  std::optional<double> offset_s = {};  // of the time: on top of all else

  [[nodiscard]] SignalKey key() const;
};

/// What the recordings have: `all` by the names that their channels go by, and every file of one by
/// its own names, of which one is its time.
struct MappedColumns {
  explicit MappedColumns(const NamedColumns& one) : all(one), files{&one} {}
  MappedColumns(const NamedColumns& together, std::vector<const NamedColumns*> apart)
      : all(together), files(std::move(apart)) {}

  const NamedColumns& all;
  std::vector<const NamedColumns*> files;
};

/// What is proposed, with an entry for every joint, and a time for every file: those that nothing
/// was found for have no source.
[[nodiscard]] ChannelMap with_all_joints(ChannelMap map, std::size_t joints, std::size_t files = 1);

/// Throws Refused for a column, a unit, a scale, a side or a file that there is not; `map` is as it
/// was then.
void set_signal(ChannelMap& map, const SignalEdit& edit, const RobotDescription& robot,
                const MappedColumns& columns);

/// "the position of joint 2", "the time": those that no column is said of.
[[nodiscard]] std::vector<std::string> missing_of(const ChannelMap& map);

/// Without what readings at rest have none of, where it is of them: what is written of the map.
[[nodiscard]] ChannelMap as_written(ChannelMap map);

/// The map as it is read from the text that is written of it: what a file would be refused for
/// throws here, as InputError in the name of `file`. Nothing is missing.
[[nodiscard]] ChannelMap read_back(const ChannelMap& map, const std::string& file);

/// [{quantity, joint, file, source, unit, units, scale, of, sides, offset_s, more}], the times
/// first, joints and files from 1. `more`: what of a channel the page does not show, in words.
[[nodiscard]] nlohmann::ordered_json signals_json(const ChannelMap& map,
                                                  const RobotDescription& robot,
                                                  const MappedColumns& columns);

/// The channel of a signal; null: none.
[[nodiscard]] const Channel* channel_of(const ChannelMap& map, std::string_view quantity,
                                        std::size_t joint);
/// In what unit it is read: what the map says, else the file, else the SI's own.
[[nodiscard]] std::string unit_read(const Channel& channel, std::string_view quantity, ChannelOf of,
                                    JointType type, const NamedColumns& columns);
/// What a signal is of.
[[nodiscard]] ChannelOf side_of(const ChannelMap& map, std::string_view quantity,
                                std::size_t joint);

}  // namespace offnominal::desk::studio
