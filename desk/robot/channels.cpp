#include "robot/channels.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>
#include <vector>

#include "common/error.hpp"
#include "common/file.hpp"
#include "common/nearest.hpp"
#include "common/number.hpp"
#include "common/toml_table.hpp"
#include "robot/payload.hpp"
#include "robot/units.hpp"

namespace offnominal::desk {
namespace {

using Words = std::vector<std::string>;

bool contains(const Words& words, std::string_view word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

std::string type_of(const toml::node& node) {
  switch (node.type()) {
    case toml::node_type::table:
      return "a table";
    case toml::node_type::array:
      return "an array";
    case toml::node_type::string:
      return "the string \"" + node.as_string()->get() + "\"";
    case toml::node_type::boolean:
      return "true or false";
    case toml::node_type::integer:
    case toml::node_type::floating_point:
      return "a number";
    default:
      return "a date or time";
  }
}

class Parser {
 public:
  Parser(std::string file, int joint_count) : file_(std::move(file)), joints_(joint_count) {}

  ChannelMap map(const toml::table& table) const {
    check_keys(
        table, "channels",
        {"time", "period_s", "position", "motor_position", "velocity", "motor_velocity", "torque",
         "motor_torque", "motor_current", "sensor_torque", "extra", "dbc", "at_rest", "payload"});
    ChannelMap map;
    map.time.source = "t";
    map.at_rest = flag(table, "at_rest");
    if (map.at_rest) {
      for (const char* key : {"time", "period_s", "velocity", "motor_velocity", "extra"}) {
        const toml::node* node = table.get(key);
        if (node == nullptr) continue;
        fail(*node, std::string("channels.") + key, "a channel beside at_rest = true",
             "position and torque", "leave it out: readings at rest have none");
      }
    }
    read_time(table, map);
    Sided position = of_sides(table, "position", {ChannelOf::kJoint, ChannelOf::kMotor});
    map.position = all_of(table, "position", position);
    map.position_of = std::move(position.of);
    Sided velocity = of_sides(table, "velocity", {ChannelOf::kJoint, ChannelOf::kMotor});
    map.velocity = std::move(velocity.channels);
    map.velocity_of = std::move(velocity.of);
    read_torques(table, map);
    if (const toml::node* node = table.get("extra")) extra(*node, map);
    if (const toml::node* node = table.get("dbc")) map.dbc = path_of(*node, "channels.dbc");
    if (const toml::node* node = table.get("payload")) read_payloads(*node, map);
    return map;
  }

 private:
  // A path in the file is relative to the file's folder.
  std::string path_of(const toml::node& node, const std::string& place) const {
    const auto* text = node.as_string();
    if (text == nullptr || text->get().empty()) {
      fail(node, place, type_of(node), "the path of a DBC file");
    }
    const std::filesystem::path path(text->get());
    return path.is_absolute() ? path.string()
                              : (std::filesystem::path(file_).parent_path() / path).string();
  }

  struct Entry {
    const toml::node* node;
    std::string place;
  };

  [[noreturn]] void fail(const toml::node& at, const std::string& place, const std::string& found,
                         const std::string& allowed, const std::string& mend = {}) const {
    std::string where = place;
    if (at.source().begin.line > 0) {
      where = "line " + std::to_string(at.source().begin.line) + ", " + place;
    }
    throw InputError({file_, where, found, allowed, mend});
  }

  void check_keys(const toml::table& table, const std::string& place, const Words& allowed) const {
    for (const auto& [key, node] : table) {
      if (contains(allowed, key.str())) continue;
      fail(node, place, "unknown key \"" + std::string(key.str()) + "\"", list_of(allowed));
    }
  }

  bool flag(const toml::table& table, const std::string& key) const {
    const toml::node* node = table.get(key);
    if (node == nullptr) return false;
    if (!node->is_boolean()) fail(*node, "channels." + key, type_of(*node), "true or false");
    return node->as_boolean()->get();
  }

  // The entries of one list, one per joint; empty where the key is absent and may be.
  std::vector<Entry> list(const toml::table& table, const std::string& key, bool required) const {
    const std::string place = "channels." + key;
    const std::string allowed = "a list of " + std::to_string(joints_) +
                                (joints_ == 1 ? " channel" : " channels") + ", one per joint";
    const toml::node* node = table.get(key);
    if (node == nullptr) {
      if (!required) return {};
      fail(table, place, "nothing", allowed);
    }
    if (!node->is_array()) {
      if (joints_ != 1) fail(*node, place, type_of(*node), allowed);
      return {{node, place}};
    }
    const toml::array& array = *node->as_array();
    if (array.size() != static_cast<std::size_t>(joints_)) {
      fail(
          *node, place, std::to_string(array.size()) + " entries", allowed,
          array.size() > static_cast<std::size_t>(joints_)
              ? "leave out those that are of none of the robot's joints, or take the robot file of "
                "the robot that was recorded"
              : "write one for each joint, from the base outwards");
    }
    std::vector<Entry> entries;
    for (std::size_t i = 0; i < array.size(); ++i) {
      entries.push_back({array.get(i), place + "[" + std::to_string(i + 1) + "]"});
    }
    return entries;
  }

  // One channel, or one for each file that a recording has; or the period, where nothing has it.
  void read_time(const toml::table& table, ChannelMap& map) const {
    if (const toml::node* node = table.get("period_s")) {
      if (const toml::node* time = table.get("time")) {
        fail(*time, "channels.time", "a channel beside period_s", "one of the two",
             "leave out period_s, or the time that it stands for");
      }
      map.period_s = number_of(table, "channels", "period_s", 0);
      if (map.period_s <= 0) {
        fail(*node, "channels.period_s", shortest(map.period_s), "more than 0, in s");
      }
    }
    const toml::node* node = table.get("time");
    if (node == nullptr) return;
    const toml::array* times = node->as_array();
    if (times == nullptr) {
      map.time = channel(*node, "channels.time", ChannelQuantity::kTime);
      return;
    }
    if (times->empty()) fail(*node, "channels.time", "an empty list", "a channel for each file");
    for (std::size_t i = 0; i < times->size(); ++i) {
      const std::string place = "channels.time[" + std::to_string(i + 1) + "]";
      Channel time = channel(*times->get(i), place, ChannelQuantity::kTime);
      if (i == 0) {
        map.time = std::move(time);
      } else {
        map.more_times.push_back(std::move(time));
      }
    }
  }

  // What the lists of one quantity say, each of its own side; one entry per joint.
  struct Sided {
    std::vector<std::optional<Channel>> channels;
    std::vector<ChannelOf> of;  // empty: of the joints, all of them
  };

  static bool is_blank(const toml::node& node) {
    const auto* text = node.as_string();
    return text != nullptr && text->get().empty();
  }

  Sided of_sides(const toml::table& table, std::string_view quantity,
                 std::initializer_list<ChannelOf> sides) const {
    const auto joints = static_cast<std::size_t>(joints_);
    Sided read{std::vector<std::optional<Channel>>(joints), {}};
    std::vector<std::string> place_of(joints);
    for (const ChannelOf side : sides) {
      const std::vector<Entry> entries = list(table, channel_key(quantity, side), false);
      for (std::size_t i = 0; i < entries.size(); ++i) {
        const auto& [node, place] = entries[i];
        if (is_blank(*node)) continue;
        if (read.channels[i]) {
          fail(*node, place, "a channel beside " + place_of[i], "one of the two",
               "write \"\" for the joint in one of the lists");
        }
        read.channels[i] = channel(*node, place, channel_quantity(quantity, side));
        place_of[i] = place;
        if (side == ChannelOf::kJoint) continue;
        read.of.resize(joints, ChannelOf::kJoint);
        read.of[i] = side;
      }
    }
    return read;
  }

  // Every joint has to have one.
  std::vector<Channel> all_of(const toml::table& table, const std::string& quantity,
                              const Sided& read) const {
    std::vector<Channel> channels;
    for (std::size_t i = 0; i < read.channels.size(); ++i) {
      if (!read.channels[i]) {
        if (read.of.empty()) static_cast<void>(list(table, quantity, true));
        fail(table, "channels." + quantity, "nothing for joint " + std::to_string(i + 1),
             "a channel for every joint, in the list of the joint or of its motor");
      }
      channels.push_back(*read.channels[i]);
    }
    return channels;
  }

  void read_torques(const toml::table& table, ChannelMap& map) const {
    Sided torque =
        of_sides(table, "torque", {ChannelOf::kJoint, ChannelOf::kMotor, ChannelOf::kCurrent});
    Sided sensor = of_sides(table, "torque", {ChannelOf::kSensor});
    for (std::size_t i = 0; i < torque.channels.size(); ++i) {
      if (torque.channels[i] || !sensor.channels[i]) continue;
      torque.channels[i] = std::move(sensor.channels[i]);
      sensor.channels[i].reset();
      torque.of.resize(torque.channels.size(), ChannelOf::kJoint);
      torque.of[i] = ChannelOf::kSensor;
    }
    map.torque = all_of(table, "torque", torque);
    map.torque_of = std::move(torque.of);
    const auto has = [](const auto& channel) { return channel.has_value(); };
    if (std::any_of(sensor.channels.begin(), sensor.channels.end(), has)) {
      map.sensor_torque = std::move(sensor.channels);
    }
  }

  enum class Part { kWhole, kTerm };

  Channel channel(const toml::node& node, const std::string& place,
                  std::optional<ChannelQuantity> quantity, Part part = Part::kWhole) const {
    Channel channel;
    const char* const allowed = "the name of a column, its number from 1, or a table with either";
    if (node.is_string() || node.is_integer()) {
      channel.source = source_of(node, place);
    } else if (const auto* table = node.as_table()) {
      Words keys{"source", "scale", "scale_source", "unit"};
      if (part == Part::kWhole) keys.insert(keys.end(), {"offset", "sum"});
      check_keys(*table, place, keys);
      if (const toml::node* source = table->get("source")) {
        channel.source = source_of(*source, place + ".source");
      }
      channel.scale_source = text_of(*table, place, "scale_source");
      channel.unit = text_of(*table, place, "unit");
      channel.scale = number_of(*table, place, "scale", 1);
      channel.offset = number_of(*table, place, "offset", 0);
      if (const toml::node* sum = table->get("sum")) read_sum(*sum, place + ".sum", channel);
    } else {
      fail(node, place, type_of(node), allowed);
    }
    if (channel.source.empty() && channel.sum.empty()) fail(node, place, "no source", allowed);
    if (!channel.source.empty() && !channel.sum.empty()) {
      fail(node, place, "a source beside a sum", "one of the two",
           "make the source a term of the sum");
    }
    if (channel.scale == 0) fail(node, place, "scale 0", "any other number");
    if (quantity) check_unit(node, place, *quantity, channel);
    return channel;
  }

  std::string source_of(const toml::node& node, const std::string& place) const {
    if (const auto* text = node.as_string()) return text->get();
    if (const auto* number = node.as_integer(); number != nullptr && number->get() >= 1) {
      return std::to_string(number->get());
    }
    fail(node, place, node.is_integer() ? "a number below 1" : type_of(node),
         "the name of a column, or its number from 1");
  }

  void read_sum(const toml::node& node, const std::string& place, Channel& channel) const {
    const toml::array* terms = node.as_array();
    if (terms == nullptr || terms->size() < 2) {
      fail(node, place, terms == nullptr ? type_of(node) : "fewer than two terms",
           "a list of channels that are added", "name a single column as the source");
    }
    for (std::size_t i = 0; i < terms->size(); ++i) {
      channel.sum.push_back(this->channel(*terms->get(i), place + "[" + std::to_string(i + 1) + "]",
                                          std::nullopt, Part::kTerm));
    }
  }

  // A unit of the quantity's own says its factor itself; any other needs one. Both at once are one
  // factor too many.
  void check_unit(const toml::node& node, const std::string& place, ChannelQuantity quantity,
                  const Channel& channel) const {
    constexpr double kSameFactor = 0.01;
    if (channel.unit.empty()) return;
    const SourceUnit* unit = find_unit(channel.unit);
    const bool is_own = unit != nullptr && is_unit_of(*unit, quantity);
    if (is_own && unit->factor != 1 &&
        std::abs(std::abs(channel.scale) / unit->factor - 1) < kSameFactor) {
      fail(node, place,
           "scale " + shortest(channel.scale) + " beside unit \"" + channel.unit + "\"",
           "the unit, whose factor that is, or the scale",
           "leave the scale out; what it says comes on top of the unit");
    }
    const bool as_it_stands =
        channel.scale == 1 && channel.offset == 0 && channel.scale_source.empty();
    const auto scales = [](const Channel& term) {
      return term.scale != 1 || !term.scale_source.empty();
    };
    if (is_own || !as_it_stands || std::any_of(channel.sum.begin(), channel.sum.end(), scales)) {
      return;
    }
    fail(node, place, "unit \"" + channel.unit + "\" without a scale",
         std::string(units_of(quantity)) + "; any other unit with its scale",
         unit == nullptr ? "add scale = what one \"" + channel.unit + "\" is in SI"
                         : std::string("add scale = what one ") + si_name(unit->dimension) +
                               " is in SI, a torque constant in Nm/A, say");
  }

  std::string text_of(const toml::table& table, const std::string& place,
                      const std::string& key) const {
    const toml::node* node = table.get(key);
    if (node == nullptr) return {};
    if (!node->is_string()) fail(*node, place + "." + key, type_of(*node), "a string");
    return node->as_string()->get();
  }

  double number_of(const toml::table& table, const std::string& place, const std::string& key,
                   double otherwise) const {
    const toml::node* node = table.get(key);
    if (node == nullptr) return otherwise;
    const auto value = node->value<double>();
    if (!node->is_number() || !value || !std::isfinite(*value)) {
      const std::string found = node->is_number() ? "a number that is not finite" : type_of(*node);
      fail(*node, place + "." + key, found, "a finite number");
    }
    return *value;
  }

  void extra(const toml::node& node, ChannelMap& map) const {
    const toml::table* table = node.as_table();
    if (table == nullptr) fail(node, "channels.extra", type_of(node), "a table of channels");
    for (const auto& [key, value] : *table) {
      const std::string name(key.str());
      map.extra[name] = channel(value, "channels.extra." + name, std::nullopt);
    }
  }

  void read_payloads(const toml::node& node, ChannelMap& map) const {
    const toml::array* entries = node.as_array();
    if (entries == nullptr) {
      fail(node, "channels.payload", type_of(node), "a list of tables, one per recording");
    }
    for (std::size_t i = 0; i < entries->size(); ++i) {
      const std::string place = "channels.payload[" + std::to_string(i + 1) + "]";
      const toml::node& entry = *entries->get(i);
      const toml::table* table = entry.as_table();
      const char* const allowed = "{recording = \"FILE\", mass_kg = KG, place_m = [X, Y, Z]}";
      if (table == nullptr) fail(entry, place, type_of(entry), allowed);
      check_keys(*table, place, {"recording", "mass_kg", "place_m"});
      for (const char* key : {"recording", "mass_kg", "place_m"}) {
        if (table->get(key) == nullptr) {
          fail(entry, place, std::string("no ") + key, allowed, "nothing of it is guessed");
        }
      }
      RecordingPayload payload;
      payload.recording = text_of(*table, place, "recording");
      if (payload.recording.empty()) fail(entry, place, "no name", "the recording's file");
      payload.payload.mass_kg = number_of(*table, place, "mass_kg", 0);
      if (payload.payload.mass_kg < 0 || payload.payload.mass_kg > kMostPayloadKg) {
        fail(*table->get("mass_kg"), place + ".mass_kg", shortest(payload.payload.mass_kg),
             "0 to " + shortest(kMostPayloadKg) + " kg",
             "write what the robot carried, in kg; of a recording without a payload leave the "
             "entry out");
      }
      read_place(*table->get("place_m"), place + ".place_m", payload.payload);
      map.payloads.push_back(std::move(payload));
    }
  }

  void read_place(const toml::node& node, const std::string& place, Payload& payload) const {
    const std::string allowed =
        "[x, y, z] in the last link's frame, each within " + shortest(kFurthestPayloadM) + " m";
    const toml::array* numbers = node.as_array();
    if (numbers == nullptr) fail(node, place, type_of(node), allowed);
    if (numbers->size() != 3)
      fail(node, place, std::to_string(numbers->size()) + " numbers", allowed);
    for (std::size_t i = 0; i < 3; ++i) {
      const toml::node& one = *numbers->get(i);
      const auto value = one.value<double>();
      if (!one.is_number() || !value || !(std::abs(*value) <= kFurthestPayloadM)) {
        fail(one, place, one.is_number() ? "a number that is too large" : type_of(one), allowed);
      }
      payload.place_m[i] = *value;
    }
  }

  std::string file_;
  int joints_;
};

}  // namespace

std::string channel_key(std::string_view quantity, ChannelOf of) {
  switch (of) {
    case ChannelOf::kJoint:
      return std::string(quantity);
    case ChannelOf::kMotor:
      return "motor_" + std::string(quantity);
    case ChannelOf::kCurrent:
      return "motor_current";
    case ChannelOf::kSensor:
      return "sensor_torque";
  }
  return {};
}

ChannelQuantity channel_quantity(std::string_view quantity, ChannelOf of) {
  if (of == ChannelOf::kCurrent) return ChannelQuantity::kCurrent;
  const bool of_motor = of == ChannelOf::kMotor;
  if (quantity == "position") {
    return of_motor ? ChannelQuantity::kMotorPosition : ChannelQuantity::kPosition;
  }
  if (quantity == "velocity") {
    return of_motor ? ChannelQuantity::kMotorVelocity : ChannelQuantity::kVelocity;
  }
  return of_motor ? ChannelQuantity::kMotorTorque : ChannelQuantity::kTorque;
}

ChannelMap parse_channels(const toml::table& table, const std::string& file, int joint_count) {
  return Parser(file, joint_count).map(table);
}

ChannelMap read_channels_file(const std::filesystem::path& file, int joint_count) {
  const toml::table whole = parse_toml(read_text_file(file), file.string());
  const toml::node* inner = whole.get("channels");
  if (inner == nullptr) return parse_channels(whole, file.string(), joint_count);
  if (!inner->is_table()) {
    throw InputError({file.string(), "channels", type_of(*inner), "a table", ""});
  }
  return parse_channels(*inner->as_table(), file.string(), joint_count);
}

}  // namespace offnominal::desk
