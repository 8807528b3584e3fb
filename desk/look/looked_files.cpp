#include "look/looked_files.hpp"

#include <fmt/format.h>

#include <utility>

#include "common/error.hpp"
#include "common/input_name.hpp"
#include "log/channel_needs.hpp"
#include "log/drive_frames.hpp"
#include "log/log_format.hpp"
#include "log/read_log.hpp"
#include "log/recording_file.hpp"
#include "log/usable_rows.hpp"
#include "look/looked_columns.hpp"
#include "look/name_guess.hpp"
#include "look/nameless.hpp"
#include "look/stamp_in_two.hpp"
#include "robot/units.hpp"

namespace offnominal::desk {
namespace {

// Everything that is numeric; a column of a text that is called a time may hold dates. Which of
// several is the time shows when all are read.
Need need_in_text(const std::string& name) {
  if (name == "t") return Need::kAscending;
  if (guess_of(name).role == Role::kTime) return Need::kTime;
  return is_common_name(name) ? Need::kRequired : Need::kWelcome;
}
Need need_elsewhere(const std::string& name) {
  return is_common_name(name) ? Need::kRequired : Need::kWelcome;
}
// Whatever a column of time has in it where a period stands for it.
Need need_beside_period(const std::string& name) {
  return guess_of(name).role == Role::kTime ? Need::kWelcome : need_elsewhere(name);
}

NamedColumns read_all(const std::filesystem::path& path, const std::filesystem::path& joined,
                      const ChannelMap* channels, const std::optional<RobotBus>& bus,
                      bool has_period) {
  RecordingFile file(path, joined);
  const LogFormat& format = log_format_of(file);
  const bool is_text = format.recognises == nullptr;
  const auto need = has_period ? need_beside_period : is_text ? need_in_text : need_elsewhere;
  return read_in(format, file, channels, bus, need);
}

Channel named(const std::string& source) {
  Channel channel;
  channel.source = source;
  return channel;
}

// By its name; of a file without names, the first column where it is a clock.
Channel time_of_one_file(const NamedColumns& columns) {
  const std::optional<std::string> time = time_in(columns_of(look_of(columns)), {});
  if (time && ascends_as_time(columns.columns.at(*time))) return named(*time);
  if (const auto stamp = stamp_in_two(columns)) return *stamp;
  if (time) return named(*time);
  const auto first = columns.columns.find("1");
  if (!columns.has_names && first != columns.columns.end() && is_clock(first->second)) {
    return named("1");
  }
  throw InputError({columns.file, "columns", "none that is called a time",
                    "a time in each of the files that are joined",
                    "name it in the header: t, s; or say --period, where no file has one"});
}

}  // namespace

FileTime looked_time(NamedColumns& columns, Channel& channel, double period_s,
                     std::vector<std::string>& notes) {
  const auto found = columns.columns.find(channel.source);
  if (period_s > 0 || found == columns.columns.end() || found->second.size() == 0 ||
      columns.units.contains(channel.source)) {
    return time_of(columns, channel, period_s);
  }
  const auto origin = columns.origins.find(channel.source);
  const bool is_date = origin != columns.origins.end() && origin->second.is_date;
  const double first = origin == columns.origins.end() ? found->second[0] : origin->second.value;
  for (const char* unit : kShortTimeUnits) {
    const double seconds = first * unit_factor(unit);
    // From 2001 to 2065, as time_of() tells it.
    if (is_date || !channel.unit.empty() || !(seconds >= 1e9 && seconds < 3e9)) continue;
    channel.unit = unit;
    notes.push_back(fmt::format("{} counts {} since 1970, by its size", channel.source, unit));
  }
  return time_of(columns, channel, 0);
}

namespace {

// Of files whose times are in other units, which their lengths tell.
void take_units_by_length(std::vector<TimedColumns>& files, LookedFiles& looked) {
  const auto take = [&](std::size_t longer, std::size_t shorter) {
    FileTime& time = files[longer].time;
    const char* const unit = unit_by_length(time, files[shorter].time);
    if (unit == nullptr) return;
    looked.notes.push_back(
        fmt::format("{}: {} lasts as many times as long as {} of {} as one in {} does: taken so; "
                    "where its clock counts from another zero, add offset = ..., in s",
                    files[longer].columns.file, time.channel.source,
                    files[shorter].time.channel.source, files[shorter].columns.file, unit));
    time.channel.unit = unit;
    time.t_s *= unit_factor(unit);
    time.origin_s *= unit_factor(unit);
    (longer == 0 ? looked.time_channel : looked.more_times[longer - 1]).unit = unit;
  };
  for (std::size_t k = 1; k < files.size(); ++k) take(0, k);
  for (std::size_t k = 1; k < files.size(); ++k) take(k, 0);
}

}  // namespace

LookedFiles read_looked_files(const std::filesystem::path& path, const RobotDescription* robot,
                              std::optional<double> period_s) {
  const ChannelMap* const channels =
      robot != nullptr && robot->channels ? &*robot->channels : nullptr;
  const std::optional<RobotBus> bus = robot != nullptr ? bus_of(*robot) : std::nullopt;
  const std::vector<std::filesystem::path> paths = recording_files(path);
  LookedFiles looked;
  if (paths.size() == 1) {
    looked.columns = read_all(path, path, channels, bus, period_s.has_value());
    return looked;
  }
  std::vector<TimedColumns> files;
  for (const auto& one : paths) {
    TimedColumns file{read_all(one, path, channels, bus, period_s.has_value()), {}};
    Channel time = period_s ? Channel{} : time_of_one_file(file.columns);
    file.time = looked_time(file.columns, time, period_s.value_or(0), looked.notes);
    if (files.empty()) {
      looked.time_channel = time;
    } else {
      looked.more_times.push_back(time);
    }
    files.push_back(std::move(file));
  }
  take_units_by_length(files, looked);
  TimedColumns joined = joined_files(std::move(files), kMinSamples, kMaxGap);
  looked.columns = std::move(joined.columns);
  looked.time = std::move(joined.time);
  return looked;
}

ReadFiles read_files_of(const std::filesystem::path& path, const ChannelMap& channels,
                        const std::optional<RobotBus>& bus) {
  const std::vector<std::filesystem::path> paths = recording_files(path);
  if (channels.at_rest && paths.size() > 1) {
    throw InputError({path.string(), "", fmt::format("{} files", paths.size()),
                      "one, as the channels' at_rest = true says", "join them before"});
  }
  std::vector<TimedColumns> files;
  ReadFiles read;
  for (std::size_t k = 0; k < paths.size(); ++k) {
    const NeedOf need_of = needs_of(channels, k, paths.size());
    const NeedOf also = [&](const std::string& name) {
      const Need need = need_of(name);
      return need == Need::kNone ? Need::kWelcome : need;
    };
    RecordingFile file(paths[k], path);
    NamedColumns columns = read_in(log_format_of(file), file, &channels, bus, also);
    if (paths.size() == 1) read.all = columns;
    TimedColumns timed{std::move(columns), {}};
    if (!channels.at_rest) {
      timed.time = time_of(timed.columns, time_channel(channels, k), channels.period_s);
    }
    files.push_back(std::move(timed));
  }
  if (files.size() == 1) {
    read.recording = std::move(files.front());
    return read;
  }
  read.recording = joined_files(std::move(files), kMinSamples, kMaxGap);
  read.all = read.recording.columns;
  return read;
}

}  // namespace offnominal::desk
