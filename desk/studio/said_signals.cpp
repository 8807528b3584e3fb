#include "studio/said_signals.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "log/channel_needs.hpp"
#include "robot/channels.hpp"

namespace offnominal::desk::studio {

using nlohmann::ordered_json;

namespace {

bool is_time(const SignalKey& key) { return key.quantity == "time"; }

bool is_signal(const SignalKey& key) {
  return is_time(key) || key.quantity == "position" || key.quantity == "velocity" ||
         key.quantity == "torque";
}

// As it is called among `columns`; none: it is not there.
std::optional<std::string> name_now(const std::string& name, const NamedColumns& columns) {
  const auto has = [&](const std::string& one) {
    return columns.columns.contains(one) || columns.scalars.contains(one);
  };
  if (has(name)) return name;
  if (has(name_in_file(0, name))) return name_in_file(0, name);
  const std::size_t colon = name.find(':');
  if (colon != std::string::npos && has(name.substr(colon + 1))) return name.substr(colon + 1);
  return std::nullopt;
}

// Whether all of its columns are there, by the names that they have now.
bool rename(Channel& channel, const NamedColumns& columns) {
  for (std::string* name : {&channel.source, &channel.scale_source}) {
    if (name->empty()) continue;
    const auto now = name_now(*name, columns);
    if (!now) return false;
    *name = *now;
  }
  return std::all_of(channel.sum.begin(), channel.sum.end(),
                     [&](Channel& term) { return rename(term, columns); });
}

void set_side(std::vector<ChannelOf>& sides, std::size_t joint, std::size_t joints, ChannelOf of) {
  sides.resize(joints, ChannelOf::kJoint);
  sides[joint] = of;
  const auto is_joint = [](ChannelOf one) { return one == ChannelOf::kJoint; };
  if (std::all_of(sides.begin(), sides.end(), is_joint)) sides.clear();
}

bool say_time_again(SaidSignal said, ChannelMap& map, const MappedColumns& columns) {
  if (said.key.file >= columns.files.size() || !said.channel) return false;
  const bool has_column = rename(*said.channel, *columns.files[said.key.file]);
  if (said.period_s <= 0 && !has_column) return false;
  map.period_s = said.period_s;
  if (!has_column) return true;
  if (said.key.file == 0) {
    map.time = *said.channel;
  } else {
    if (map.more_times.size() < said.key.file) map.more_times.resize(said.key.file, map.time);
    map.more_times[said.key.file - 1] = *said.channel;
  }
  return true;
}

ordered_json json_of(const Channel& channel) {
  ordered_json terms = ordered_json::array();
  for (const Channel& term : channel.sum) terms.push_back(json_of(term));
  return {
      {"source", channel.source}, {"scale", channel.scale}, {"scale_source", channel.scale_source},
      {"offset", channel.offset}, {"unit", channel.unit},   {"sum", std::move(terms)}};
}

Channel channel_from(const ordered_json& from, bool is_term = false) {
  Channel channel;
  channel.source = from.at("source").get<std::string>();
  channel.scale = from.at("scale").get<double>();
  channel.scale_source = from.at("scale_source").get<std::string>();
  channel.offset = from.at("offset").get<double>();
  channel.unit = from.at("unit").get<std::string>();
  if (is_term) return channel;
  for (const ordered_json& term : from.at("sum")) channel.sum.push_back(channel_from(term, true));
  return channel;
}

}  // namespace

std::vector<SaidSignal> said_of(const ChannelMap& map, const std::set<SignalKey>& keys) {
  std::vector<SaidSignal> said;
  for (const SignalKey& key : keys) {
    if (!is_time(key) && key.joint >= map.position.size()) continue;
    SaidSignal one{key};
    if (is_time(key)) {
      one.channel = time_channel(map, key.file);
      one.period_s = map.period_s;
    } else {
      if (const Channel* channel = channel_of(map, key.quantity, key.joint)) one.channel = *channel;
      one.of = side_of(map, key.quantity, key.joint);
    }
    said.push_back(std::move(one));
  }
  return said;
}

bool say_again(SaidSignal said, ChannelMap& map, const MappedColumns& columns) {
  if (is_time(said.key)) return say_time_again(std::move(said), map, columns);
  const std::size_t joint = said.key.joint;
  const std::size_t joints = map.position.size();
  if (joint >= joints) return false;
  if (said.channel && !rename(*said.channel, columns.all)) return false;
  if (said.key.quantity == "velocity") {
    map.velocity[joint] = said.channel;
    set_side(map.velocity_of, joint, joints, said.of);
    return true;
  }
  if (!said.channel) return false;
  const bool is_position = said.key.quantity == "position";
  (is_position ? map.position : map.torque)[joint] = *said.channel;
  set_side(is_position ? map.position_of : map.torque_of, joint, joints, said.of);
  return true;
}

std::string words_of(const SignalKey& key) {
  if (!is_time(key)) return fmt::format("the {} of joint {}", key.quantity, key.joint + 1);
  return key.file == 0 ? "the time" : fmt::format("the time of file {}", key.file + 1);
}

ordered_json json_of(const SaidSignal& said) {
  return {{"quantity", said.key.quantity},
          {"joint", said.key.joint + 1},
          {"file", said.key.file + 1},
          {"channel", said.channel ? json_of(*said.channel) : ordered_json(nullptr)},
          {"of", static_cast<int>(said.of)},
          {"period_s", said.period_s}};
}

std::optional<SaidSignal> said_from(const ordered_json& from) {
  SaidSignal said;
  said.key.quantity = from.at("quantity").get<std::string>();
  // 0 becomes the largest number there is, which nothing has.
  said.key.joint = from.at("joint").get<std::size_t>() - 1;
  said.key.file = from.at("file").get<std::size_t>() - 1;
  if (!from.at("channel").is_null()) said.channel = channel_from(from.at("channel"));
  const int of = from.at("of").get<int>();
  const bool is_side = of >= 0 && of <= static_cast<int>(ChannelOf::kSensor);
  if (!is_side || !is_signal(said.key)) return std::nullopt;
  said.of = static_cast<ChannelOf>(of);
  said.period_s = from.at("period_s").get<double>();
  return said;
}

}  // namespace offnominal::desk::studio
