#include "robot/channels.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <vector>

#include "common/error.hpp"
#include "common/file.hpp"
#include "common/nearest.hpp"
#include "common/toml_table.hpp"

namespace offnominal::tools {
namespace {

using Words = std::vector<std::string>;
const Words kTimeUnits{"s"};
const Words kPositionUnits{"rad", "m"};
const Words kVelocityUnits{"rad/s", "m/s"};
const Words kTorqueUnits{"Nm", "N m", "N"};

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
    check_keys(table, "channels",
               {"time", "position", "velocity", "torque", "extra", "dbc", "at_rest"});
    ChannelMap map;
    map.time.source = "t";
    map.at_rest = flag(table, "at_rest");
    if (map.at_rest) {
      for (const char* key : {"time", "velocity", "extra"}) {
        const toml::node* node = table.get(key);
        if (node == nullptr) continue;
        fail(*node, std::string("channels.") + key, "a channel beside at_rest = true",
             "position and torque", "leave it out: readings at rest have none");
      }
    }
    if (const toml::node* node = table.get("time")) {
      map.time = channel(*node, "channels.time", &kTimeUnits);
    }
    for (const auto& joint : list(table, "position", true)) {
      map.position.push_back(channel(*joint.node, joint.place, &kPositionUnits));
    }
    for (const auto& joint : list(table, "torque", true)) {
      map.torque.push_back(channel(*joint.node, joint.place, &kTorqueUnits));
    }
    map.velocity.assign(static_cast<std::size_t>(joints_), std::nullopt);
    const auto velocity = list(table, "velocity", false);
    for (std::size_t i = 0; i < velocity.size(); ++i) {
      const auto* text = velocity[i].node->as_string();
      if (text != nullptr && text->get().empty()) continue;
      map.velocity[i] = channel(*velocity[i].node, velocity[i].place, &kVelocityUnits);
    }
    if (const toml::node* node = table.get("extra")) extra(*node, map);
    if (const toml::node* node = table.get("dbc")) map.dbc = path_of(*node, "channels.dbc");
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
      fail(*node, place, std::to_string(array.size()) + " entries", allowed);
    }
    std::vector<Entry> entries;
    for (std::size_t i = 0; i < array.size(); ++i) {
      entries.push_back({array.get(i), place + "[" + std::to_string(i + 1) + "]"});
    }
    return entries;
  }

  Channel channel(const toml::node& node, const std::string& place, const Words* si_units) const {
    Channel channel;
    if (const auto* text = node.as_string()) {
      channel.source = text->get();
    } else if (const auto* table = node.as_table()) {
      check_keys(*table, place, {"source", "scale", "offset", "scale_source", "unit"});
      channel.source = text_of(*table, place, "source");
      channel.scale_source = text_of(*table, place, "scale_source");
      channel.unit = text_of(*table, place, "unit");
      channel.scale = number_of(*table, place, "scale", 1);
      channel.offset = number_of(*table, place, "offset", 0);
    } else {
      fail(node, place, type_of(node), "the name of a column, or a table with its source");
    }
    if (channel.source.empty()) fail(node, place, "no source", "the name of a column");
    if (channel.scale == 0) fail(node, place, "scale 0", "any other number");
    const bool as_it_stands =
        channel.scale == 1 && channel.offset == 0 && channel.scale_source.empty();
    if (si_units != nullptr && as_it_stands && !channel.unit.empty() &&
        !contains(*si_units, channel.unit)) {
      fail(node, place, "unit \"" + channel.unit + "\" without a scale",
           list_of(*si_units) + "; any other unit with its scale",
           "add scale = what one \"" + channel.unit + "\" is in SI");
    }
    return channel;
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
      map.extra[name] = channel(value, "channels.extra." + name, nullptr);
    }
  }

  std::string file_;
  int joints_;
};

}  // namespace

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

}  // namespace offnominal::tools
