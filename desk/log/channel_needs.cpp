#include "log/channel_needs.hpp"

#include <algorithm>
#include <set>

namespace offnominal::desk {

namespace {

bool is_number(const std::string& name) {
  return std::all_of(name.begin(), name.end(), [](char c) { return c >= '0' && c <= '9'; });
}

}  // namespace

std::optional<int> number_behind(const std::string& name, const std::string& prefix) {
  if (!name.starts_with(prefix) || name.size() == prefix.size() ||
      name.size() > prefix.size() + 3) {
    return std::nullopt;
  }
  int number = 0;
  for (const char digit : name.substr(prefix.size())) {
    if (digit < '0' || digit > '9') return std::nullopt;
    number = 10 * number + (digit - '0');
  }
  return number;
}

int joint_of(const std::string& name, const std::string& prefix) {
  return number_behind(name, prefix).value_or(0);
}

bool is_common_name(const std::string& name) {
  return name == "t" || number_behind(name, "q") || number_behind(name, "dq") ||
         number_behind(name, "tau");
}

std::string name_in_file(std::size_t file, const std::string& name) {
  return std::to_string(file + 1) + ":" + name;
}

const Channel& time_channel(const ChannelMap& channels, std::size_t file) {
  if (file == 0 || file > channels.more_times.size()) return channels.time;
  return channels.more_times[file - 1];
}

NeedOf needs_of(const std::optional<ChannelMap>& channels, std::size_t file, std::size_t files) {
  if (!channels) {
    return [](const std::string& name) {
      if (name == "t") return Need::kAscending;
      if (name == "time") return Need::kTime;
      if (is_common_name(name)) return Need::kRequired;
      // A column without a name is nobody's extra: what has no header is refused before it is read.
      return is_number(name) ? Need::kNone : Need::kWelcome;
    };
  }
  std::set<std::string> wanted;
  const auto want = [&wanted](const Channel& channel) {
    if (!channel.source.empty()) wanted.insert(channel.source);
    if (!channel.scale_source.empty()) wanted.insert(channel.scale_source);
    for (const Channel& term : channel.sum) {
      wanted.insert(term.source);
      if (!term.scale_source.empty()) wanted.insert(term.scale_source);
    }
  };
  for (const Channel& channel : channels->position) want(channel);
  for (const auto& channel : channels->velocity) {
    if (channel) want(*channel);
  }
  for (const Channel& channel : channels->torque) want(channel);
  for (const auto& channel : channels->sensor_torque) {
    if (channel) want(*channel);
  }
  for (const auto& [name, channel] : channels->extra) want(channel);
  std::string ascending;
  if (!channels->at_rest && channels->period_s == 0) {
    const Channel& time = time_channel(*channels, file);
    want(time);
    // Scaled by a negative number time ascends where its column descends.
    if (time.scale > 0 && time.scale_source.empty()) ascending = time.source;
  }
  return [wanted = std::move(wanted), ascending, file, files](const std::string& name) {
    if (!wanted.contains(name) && !(files > 1 && wanted.contains(name_in_file(file, name)))) {
      return Need::kNone;
    }
    return name == ascending ? Need::kAscending : Need::kRequired;
  };
}

}  // namespace offnominal::desk
