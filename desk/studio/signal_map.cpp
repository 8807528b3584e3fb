#include "studio/signal_map.hpp"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <utility>

#include "common/nearest.hpp"
#include "common/refused.hpp"
#include "common/toml_table.hpp"
#include "log/channel_needs.hpp"
#include "look/name_guess.hpp"
#include "robot/channel_text.hpp"
#include "robot/channels.hpp"
#include "robot/units.hpp"

namespace offnominal::desk::studio {
namespace {

using nlohmann::ordered_json;

struct Side {
  const char* name;
  ChannelOf of;
};
constexpr std::array<Side, 4> kSides{{{"joint", ChannelOf::kJoint},
                                      {"motor", ChannelOf::kMotor},
                                      {"current", ChannelOf::kCurrent},
                                      {"sensor", ChannelOf::kSensor}}};
constexpr std::array<const char*, 3> kQuantities = {"position", "velocity", "torque"};

[[noreturn]] void refuse_edit(const std::string& words) {
  throw Refused(Refused::Why::kBadRequest, words);
}

// Of those of kSides, the first so many.
std::size_t sides_of(std::string_view quantity) { return quantity == "torque" ? 4 : 2; }

const char* name_of(ChannelOf of) {
  const auto* at =
      std::find_if(kSides.begin(), kSides.end(), [&](const Side& side) { return side.of == of; });
  return at->name;
}

std::vector<ChannelOf>& sides_in(ChannelMap& map, std::string_view quantity) {
  if (quantity == "position") return map.position_of;
  return quantity == "velocity" ? map.velocity_of : map.torque_of;
}

// Of the quantity's own, as far as a joint of that type has them; of a torque also what a scale
// makes one.
std::vector<std::string> units_for(std::string_view quantity, ChannelOf of, JointType type) {
  const bool is_time = quantity == "time";
  const bool turns = type == JointType::kRevolute || of == ChannelOf::kMotor;
  std::string_view all =
      units_of(is_time ? ChannelQuantity::kTime : channel_quantity(quantity, of));
  std::vector<std::string> units;
  while (!all.empty()) {
    const std::size_t comma = all.find(", ");
    const std::string_view name = all.substr(0, comma);
    const SourceUnit* unit = find_unit(name);
    const Dimension dimension = unit->dimension;
    const bool of_turning = dimension == Dimension::kAngle || dimension == Dimension::kTorque ||
                            dimension == Dimension::kAngularVelocity;
    const bool of_either = dimension == Dimension::kTime || dimension == Dimension::kCurrent;
    if (of_either || of_turning == turns) units.emplace_back(name);
    all.remove_prefix(comma == std::string_view::npos ? all.size() : comma + 2);
  }
  if (quantity == "torque" && of != ChannelOf::kCurrent) {
    units.insert(units.end(), {"A", "mA", "V"});
  }
  return units;
}

std::string own_unit(std::string_view quantity, ChannelOf of, JointType type) {
  for (const std::string& name : units_for(quantity, of, type)) {
    if (find_unit(name)->factor == 1) return name;
  }
  return "1";
}

std::string unit_of_file(const Channel& channel, const NamedColumns& columns) {
  const auto said = columns.units.find(channel.source);
  return said == columns.units.end() ? std::string() : said->second;
}

std::string more_words(const Channel& channel, bool is_time) {
  std::string words;
  const auto add = [&](const std::string& what) { words += (words.empty() ? "" : "; ") + what; };
  if (!channel.sum.empty()) {
    add("the sum of " +
        list_of(channel.sum, [](const Channel& term) { return "\"" + term.source + "\""; }));
  }
  if (!channel.scale_source.empty()) add("times \"" + channel.scale_source + "\"");
  if (!is_time && channel.offset != 0) add(fmt::format("plus {:.6g} in SI units", channel.offset));
  return words;
}

ordered_json signal_json(const ChannelMap& map, std::string_view quantity, std::size_t joint,
                         JointType type, const NamedColumns& columns, std::size_t file = 0) {
  const bool is_time = quantity == "time";
  const Channel* channel = is_time ? &time_channel(map, file) : channel_of(map, quantity, joint);
  const Channel none;
  const Channel& shown = channel == nullptr ? none : *channel;
  const ChannelOf of = side_of(map, quantity, joint);
  std::vector<std::string> units = units_for(quantity, of, type);
  const std::string unit = unit_read(shown, quantity, of, type, columns);
  if (std::find(units.begin(), units.end(), unit) == units.end()) units.push_back(unit);
  ordered_json sides = ordered_json::array();
  for (std::size_t i = 0; i < (is_time ? 0 : sides_of(quantity)); ++i) {
    sides.push_back(kSides[i].name);
  }
  return {{"quantity", quantity},
          {"joint", is_time ? ordered_json(nullptr) : ordered_json(joint + 1)},
          {"file", is_time ? ordered_json(file + 1) : ordered_json(nullptr)},
          {"source", shown.source},
          {"unit", unit},
          {"units", std::move(units)},
          {"scale", shown.scale},
          {"of", name_of(of)},
          {"sides", std::move(sides)},
          {"offset_s", is_time ? ordered_json(shown.offset) : ordered_json(nullptr)},
          {"more", more_words(shown, is_time)}};
}

void set_side(ChannelMap& map, const SignalEdit& edit, std::size_t joints) {
  const std::size_t count = sides_of(edit.quantity);
  const auto end = kSides.begin() + static_cast<std::ptrdiff_t>(count);
  const auto* side =
      std::find_if(kSides.begin(), end, [&](const Side& one) { return *edit.of == one.name; });
  if (side == end) refuse_edit("A " + edit.quantity + " is of no such side.");
  std::vector<ChannelOf>& sides = sides_in(map, edit.quantity);
  sides.resize(joints, ChannelOf::kJoint);
  sides[edit.joint] = side->of;
  const auto is_joint = [](ChannelOf of) { return of == ChannelOf::kJoint; };
  if (std::all_of(sides.begin(), sides.end(), is_joint)) sides.clear();
}

// With the unit that its name says, as it is guessed; what the file says is taken without a word.
void set_source(Channel& channel, const std::string& source, const NamedColumns& columns,
                const std::vector<std::string>& units, const std::string& own) {
  if (source == channel.source && channel.sum.empty()) return;
  if (!columns.columns.contains(source)) refuse_edit("No recording has a column of that name.");
  channel = {};
  channel.source = source;
  const std::string said = guess_of(source).unit;
  const bool is_unit = std::find(units.begin(), units.end(), said) != units.end();
  if (unit_of_file(channel, columns).empty() && is_unit && said != own) channel.unit = said;
}

void set_factor(Channel& channel, const SignalEdit& edit, const std::string& own,
                const std::vector<std::string>& units, const NamedColumns& columns) {
  const std::string of_file = unit_of_file(channel, columns);
  if (edit.unit) {
    const bool known = std::find(units.begin(), units.end(), *edit.unit) != units.end();
    if (!known && *edit.unit != channel.unit && *edit.unit != of_file) {
      refuse_edit("A " + edit.quantity + " has no such unit.");
    }
    // As it is read without a word.
    channel.unit = *edit.unit == (of_file.empty() ? own : of_file) ? "" : *edit.unit;
  }
  if (edit.scale) {
    if (*edit.scale == 0) refuse_edit("A factor has to be a number other than 0.");
    channel.scale = *edit.scale;
  }
  // Beside a scale the file's own word on its unit does not count.
  if (channel.scale != 1 && channel.unit.empty()) channel.unit = of_file;
}

void set_time(ChannelMap& map, const SignalEdit& edit, const MappedColumns& columns) {
  if (edit.file >= columns.files.size()) refuse_edit("A recording has no such file.");
  if (edit.period_s) map.period_s = *edit.period_s;
  if (edit.file > map.more_times.size()) map.more_times.resize(edit.file, map.time);
  Channel& time = edit.file == 0 ? map.time : map.more_times[edit.file - 1];
  const NamedColumns& of_file = *columns.files[edit.file];
  const auto units = units_for("time", ChannelOf::kJoint, JointType::kRevolute);
  if (edit.source) {
    set_source(time, *edit.source, of_file, units, "s");
    map.period_s = 0;
  }
  if (edit.offset_s) time.offset = *edit.offset_s;
  set_factor(time, edit, "s", units, of_file);
}

}  // namespace

const Channel* channel_of(const ChannelMap& map, std::string_view quantity, std::size_t joint) {
  if (quantity == "time") return &map.time;
  if (quantity == "position") return &map.position[joint];
  if (quantity == "torque") return &map.torque[joint];
  return map.velocity[joint] ? &*map.velocity[joint] : nullptr;
}

ChannelOf side_of(const ChannelMap& map, std::string_view quantity, std::size_t joint) {
  if (quantity == "time") return ChannelOf::kJoint;
  if (quantity == "position") return side_at(map.position_of, joint);
  return side_at(quantity == "velocity" ? map.velocity_of : map.torque_of, joint);
}

std::string unit_read(const Channel& channel, std::string_view quantity, ChannelOf of,
                      JointType type, const NamedColumns& columns) {
  if (!channel.unit.empty()) return channel.unit;
  const std::string said = channel.scale == 1 ? unit_of_file(channel, columns) : "";
  return said.empty() ? own_unit(quantity, of, type) : said;
}

SignalKey SignalEdit::key() const {
  return quantity == "time" ? SignalKey{quantity, 0, file} : SignalKey{quantity, joint, 0};
}

ChannelMap with_all_joints(ChannelMap map, std::size_t joints, std::size_t files) {
  if (files > map.more_times.size() + 1) map.more_times.resize(files - 1, map.time);
  map.position.resize(joints);
  map.velocity.resize(joints);
  map.torque.resize(joints);
  return map;
}

void set_signal(ChannelMap& map, const SignalEdit& edit, const RobotDescription& robot,
                const MappedColumns& columns) {
  ChannelMap changed = map;
  if (edit.quantity == "time") {
    set_time(changed, edit, columns);
    map = std::move(changed);
    return;
  }
  if (edit.joint >= robot.joints.size()) refuse_edit("There is no such joint.");
  const bool is_velocity = edit.quantity == "velocity";
  std::optional<Channel>& velocity = changed.velocity[edit.joint];
  if (is_velocity && edit.source && edit.source->empty()) {
    velocity.reset();
    map = std::move(changed);
    return;
  }
  if (is_velocity && !velocity) velocity.emplace();
  Channel& channel = is_velocity ? *velocity
                                 : (edit.quantity == "position" ? changed.position[edit.joint]
                                                                : changed.torque[edit.joint]);
  if (edit.of) {
    set_side(changed, edit, robot.joints.size());
    channel.unit.clear();
  }
  const ChannelOf of = side_of(changed, edit.quantity, edit.joint);
  const JointType type = robot.joints[edit.joint].joint.type;
  const std::string own = own_unit(edit.quantity, of, type);
  const std::vector<std::string> units = units_for(edit.quantity, of, type);
  if (edit.source) set_source(channel, *edit.source, columns.all, units, own);
  if (channel.source.empty() && channel.sum.empty()) refuse_edit("Say its column first.");
  set_factor(channel, edit, own, units, columns.all);
  map = std::move(changed);
}

std::vector<std::string> missing_of(const ChannelMap& map) {
  std::vector<std::string> missing;
  const auto is_none = [](const Channel& one) { return one.source.empty() && one.sum.empty(); };
  const bool has_time = map.period_s == 0 && !map.at_rest;
  if (has_time && is_none(map.time)) missing.emplace_back("the time");
  for (std::size_t k = 0; has_time && k < map.more_times.size(); ++k) {
    if (is_none(map.more_times[k])) missing.push_back(fmt::format("the time of file {}", k + 2));
  }
  for (std::size_t i = 0; i < map.position.size(); ++i) {
    for (const char* quantity : {"position", "torque"}) {
      if (!is_none(*channel_of(map, quantity, i))) continue;
      missing.push_back(fmt::format("the {} of joint {}", quantity, i + 1));
    }
  }
  return missing;
}

ChannelMap as_written(ChannelMap map) {
  if (!map.at_rest) return map;
  map.velocity.assign(map.position.size(), std::nullopt);
  map.velocity_of.clear();
  map.extra.clear();
  return map;
}

ChannelMap read_back(const ChannelMap& map, const std::string& file) {
  const toml::table whole = parse_toml(channels_table(as_written(map)), file);
  return parse_channels(*whole["channels"].as_table(), file, static_cast<int>(map.position.size()));
}

ordered_json signals_json(const ChannelMap& map, const RobotDescription& robot,
                          const MappedColumns& columns) {
  ordered_json all = ordered_json::array();
  for (std::size_t k = 0; k < columns.files.size(); ++k) {
    all.push_back(signal_json(map, "time", 0, JointType::kRevolute, *columns.files[k], k));
  }
  for (std::size_t i = 0; i < robot.joints.size(); ++i) {
    for (const char* quantity : kQuantities) {
      all.push_back(signal_json(map, quantity, i, robot.joints[i].joint.type, columns.all));
    }
  }
  return all;
}

}  // namespace offnominal::desk::studio
