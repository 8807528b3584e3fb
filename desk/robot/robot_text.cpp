#include <algorithm>
#include <cctype>
#include <cstdio>
#include <filesystem>
#include <span>

#include "common/nearest.hpp"
#include "common/number.hpp"
#include "drives/drive_table.hpp"
#include "robot/bound_names.hpp"
#include "robot/bound_text.hpp"
#include "robot/channel_text.hpp"
#include "robot/channels.hpp"
#include "robot/effect_text.hpp"
#include "robot/read_joint.hpp"
#include "robot/robot_file.hpp"

namespace offnominal::desk {
namespace {

std::string list(std::span<const double> values) {
  return "[" + list_of(values, shortest_real) + "]";
}

std::string rows(const std::vector<std::vector<double>>& matrix) {
  return "[" + list_of(matrix, list) + "]";
}

std::string escaped(char c) {
  switch (c) {
    case '"':
      return "\\\"";
    case '\\':
      return "\\\\";
    case '\n':
      return "\\n";
    case '\t':
      return "\\t";
    default: {
      if (static_cast<unsigned char>(c) >= 0x20 && c != 0x7f) return {c};
      char code[8];
      std::snprintf(code, sizeof code, "\\u%04X", static_cast<unsigned>(c) & 0xffU);
      return code;
    }
  }
}

// Text of several lines keeps them: a line break right behind the opening quotes does not count.
std::string quoted(const std::string& text) {
  const bool lines = text.find('\n') != std::string::npos;
  std::string result = lines ? "\"\"\"\n" : "\"";
  for (const char c : text) result += lines && c == '\n' ? "\n" : escaped(c);
  return result + (lines ? "\"\"\"" : "\"");
}

std::string key(const std::string& name) {
  const bool bare = !name.empty() && std::all_of(name.begin(), name.end(), [](unsigned char c) {
    return c < 0x80 && (std::isalnum(c) != 0 || c == '_' || c == '-');
  });
  if (bare) return name;
  std::string result = "\"";
  for (const char c : name) result += escaped(c);
  return result + "\"";
}

class Writer {
 public:
  void line(const std::string& text) { text_ += text + "\n"; }
  void value(const std::string& name, const std::string& value) {
    text_ += name + " = " + value + "\n";
  }
  void text_if_any(const std::string& name, const std::string& text) {
    if (!text.empty()) value(name, quoted(text));
  }
  void table(const std::string& header) { text_ += "\n" + header + "\n"; }
  void block(const std::string& text) { text_ += "\n" + text; }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::string text_;
};

void write_limits(Writer& out, const Joint<double>& joint) {
  const Joint<double> unlimited;
  const bool position =
      joint.min_position != unlimited.min_position || joint.max_position != unlimited.max_position;
  const bool velocity = joint.max_velocity != unlimited.max_velocity;
  const bool torque = joint.max_torque != unlimited.max_torque;
  if (!position && !velocity && !torque) return;
  out.table("[joint.limits]");
  if (position) {
    const double range[]{joint.min_position, joint.max_position};
    out.value("position", list(range));
  }
  if (velocity) out.value("velocity", shortest_real(joint.max_velocity));
  if (torque) out.value("torque", shortest_real(joint.max_torque));
}

void write_encoder(Writer& out, const RobotJoint& joint) {
  if (joint.encoder.counts_per_unit == 0) return;
  out.table("[joint.encoder]");
  for (int bits = 1; bits <= kMaxEncoderBits && joint.joint.type == JointType::kRevolute; ++bits) {
    if (joint.encoder.counts_per_unit != counts_per_rad(bits)) continue;
    out.value("bits", std::to_string(bits));
    return;
  }
  out.value("counts_per_unit", shortest_real(joint.encoder.counts_per_unit));
}

void write_link(Writer& out, const Joint<double>& joint) {
  out.table("[joint.link]");
  out.value("mass_kg", shortest_real(joint.mass_kg));
  out.value("centre_of_mass_m", list(joint.centre_of_mass_m));
  if (joint.inertia_kg_m2 == Joint<double>{}.inertia_kg_m2) return;
  const auto& [xx, yy, zz, xy, xz, yz] = joint.inertia_kg_m2;
  out.value("inertia_kg_m2", "{xx = " + shortest_real(xx) + ", yy = " + shortest_real(yy) +
                                 ", zz = " + shortest_real(zz) + ", xy = " + shortest_real(xy) +
                                 ", xz = " + shortest_real(xz) + ", yz = " + shortest_real(yz) +
                                 "}");
}

void write_joint(Writer& out, const RobotJoint& robot_joint) {
  const Joint<double>& joint = robot_joint.joint;
  out.table("[[joint]]");
  out.value("name", quoted(robot_joint.name));
  out.value("type", quoted(joint.type == JointType::kRevolute ? "revolute" : "prismatic"));
  out.value("axis", list(joint.axis));
  out.value("origin_m", list(joint.origin_m));
  if (joint.rotation != Joint<double>{}.rotation) {
    std::vector<std::vector<double>> matrix;
    for (std::size_t row = 0; row < 9; row += 3) {
      matrix.push_back({joint.rotation[row], joint.rotation[row + 1], joint.rotation[row + 2]});
    }
    out.value("rotation", rows(matrix));
  }
  out.text_if_any("source", robot_joint.source);
  write_link(out, joint);
  write_limits(out, joint);
  write_encoder(out, robot_joint);
  if (robot_joint.kp != 0 || robot_joint.kd != 0) {
    out.table("[joint.control]");
    out.value("kp_per_s2", shortest_real(robot_joint.kp));
    out.value("kd_per_s", shortest_real(robot_joint.kd));
  }
}

void write_estimator(Writer& out, const EstimatorSettings& settings) {
  out.table("[estimator]");
  out.value("period_s", shortest_real(settings.period_s));
  out.value("alpha_per_s", shortest_real(settings.alpha));
  if (settings.fast_alpha > 0) out.value("fast_alpha_per_s", shortest_real(settings.fast_alpha));
  out.value("hidden_units", std::to_string(settings.hidden_units));
  out.value("learning_rate", shortest_real(settings.learning_rate));
  out.value("weight_radius", shortest_real(settings.weight_radius));
  out.value("initial_weight_range", shortest_real(settings.initial_weight_range));
  out.value("seed", std::to_string(settings.seed));
  out.value("dead_zone",
            quoted(settings.dead_zone == DeadZone::kContinuous ? "continuous" : "discontinuous"));
  out.value("torque_signal",
            quoted(settings.torque_signal == TorqueSignal::kSampled ? "sampled" : "held"));
  if (settings.space == EstimatorSpace::kTorque) out.value("space", quoted("torque"));
  if (settings.isolation) out.value("isolation", "true");
  out.text_if_any("source", settings.source);
}

void write_arming(Writer& out, const ArmingSettings& settings) {
  out.table("[arming]");
  const auto per_joint = [&](const char* name, const std::vector<double>& values) {
    if (!values.empty()) out.value(name, list(values));
  };
  per_joint("position_window", settings.position_window);
  per_joint("speed", settings.speed);
  per_joint("torque_rate", settings.torque_rate);
  out.value("ramp_s", shortest_real(settings.ramp_s));
  out.text_if_any("source", settings.source);
}

void write_bound(Writer& out, const BoundSettings& bound) {
  out.line("[uncertainty_bound]");
  if (bound.kind != BoundSettings::Kind::kPerJoint) out.value("kind", quoted(name_of(bound.kind)));
  switch (bound.kind) {
    case BoundSettings::Kind::kConstant:
      out.value("value", shortest_real(bound.constant.value));
      break;
    case BoundSettings::Kind::kScaledNorm:
      out.value("scale", shortest_real(bound.scaled_norm.scale));
      out.value("offset", shortest_real(bound.scaled_norm.offset));
      out.value("matrix", rows(bound.scaled_norm.matrix));
      break;
    case BoundSettings::Kind::kTable:
      out.value("variable", quoted(bound_variable_names(bound.table.variable).name));
      out.value("joint", std::to_string(bound.table.joint + 1));
      out.value("at", list(bound.table.at));
      out.value("value", list(bound.table.value));
      break;
    case BoundSettings::Kind::kPerJoint:
      out.line(joint_bounds_text(bound));
      break;
  }
  if (bound.velocity_error > 0) out.value("velocity_error", shortest_real(bound.velocity_error));
  if (bound.covers_velocities) out.value("covers_velocities", "true");
  out.text_if_any("source", bound.source);
}

std::string drive_value(const hal::DriveKey& key, double value) {
  if (!key.words.empty()) return quoted(key.words[static_cast<std::size_t>(value)]);
  return key.whole ? shortest(value) : shortest_real(value);
}

void write_drives(Writer& out, const DriveSettings& settings) {
  const DriveProtocol& protocol = protocol_of(settings);
  out.table("[drives]");
  out.value("protocol", quoted(protocol.name));
  for (std::size_t k = 0; k < protocol.keys.size(); ++k) {
    out.value(protocol.keys[k].name, drive_value(protocol.keys[k], settings.shared[k]));
  }
  for (std::size_t k = 0; k < protocol.joint_keys.size(); ++k) {
    const hal::DriveKey& key = protocol.joint_keys[k];
    std::vector<double> values;
    for (std::size_t i = k; i < settings.of_joints.size(); i += protocol.joint_keys.size()) {
      values.push_back(settings.of_joints[i]);
    }
    out.value(key.name,
              "[" + list_of(values, [&](double value) { return drive_value(key, value); }) + "]");
  }
  out.text_if_any("source", settings.source);
}

std::string channel_text(const Channel& channel) {
  std::string text = channel.sum.empty() ? "{source = " + quoted(channel.source)
                                         : "{sum = [" + list_of(channel.sum, channel_text) + "]";
  if (channel.scale != 1) text += ", scale = " + shortest_real(channel.scale);
  if (!channel.scale_source.empty()) text += ", scale_source = " + quoted(channel.scale_source);
  if (channel.offset != 0) text += ", offset = " + shortest_real(channel.offset);
  if (!channel.unit.empty()) text += ", unit = " + quoted(channel.unit);
  return text + "}";
}

std::string payload_text(const RecordingPayload& one) {
  const auto number = [](double value) { return shortest_real(value); };
  return "{recording = " + quoted(one.recording) +
         ", mass_kg = " + shortest_real(one.payload.mass_kg) + ", place_m = [" +
         list_of(one.payload.place_m, number) + "]}";
}

using OptionalChannels = std::vector<std::optional<Channel>>;

std::string channel_list(const OptionalChannels& channels) {
  return "[" +
         list_of(channels,
                 [](const auto& channel) {
                   return channel ? channel_text(*channel) : std::string("\"\"");
                 }) +
         "]";
}

// Key and list for each side that is there; those of the joints first, also where there is nothing.
void add_sides(const OptionalChannels& channels, const std::vector<ChannelOf>& of,
               std::string_view quantity, std::vector<std::string>& lines) {
  for (const ChannelOf side : {ChannelOf::kJoint, ChannelOf::kMotor, ChannelOf::kCurrent}) {
    OptionalChannels mine(channels.size());
    for (std::size_t i = 0; i < channels.size(); ++i) {
      if (side_at(of, i) == side) mine[i] = channels[i];
    }
    const bool none = std::none_of(mine.begin(), mine.end(), [](const auto& c) { return !!c; });
    const bool of_joints = side == ChannelOf::kJoint && of.empty();
    if (none && !of_joints) continue;
    lines.push_back(channel_key(quantity, side) + " = " + channel_list(mine));
  }
}

std::string time_value(const ChannelMap& channels) {
  if (channels.more_times.empty()) return channel_text(channels.time);
  return "[" + channel_text(channels.time) + ", " + list_of(channels.more_times, channel_text) +
         "]";
}

// Of all joints that have one, whether beside the drive's torque or alone.
void add_sensors(const ChannelMap& channels, std::vector<std::string>& lines) {
  OptionalChannels sensors = channels.sensor_torque;
  sensors.resize(channels.torque.size());
  for (std::size_t i = 0; i < sensors.size(); ++i) {
    if (side_at(channels.torque_of, i) == ChannelOf::kSensor) sensors[i] = channels.torque[i];
  }
  if (std::any_of(sensors.begin(), sensors.end(), [](const auto& c) { return !!c; })) {
    lines.push_back(channel_key("torque", ChannelOf::kSensor) + " = " + channel_list(sensors));
  }
}

OptionalChannels as_optional(const std::vector<Channel>& channels) {
  return {channels.begin(), channels.end()};
}

void write_transmission(Writer& out, const TransmissionSettings& settings) {
  out.table("[transmission]");
  const auto any = [&](const char* name, const std::vector<double>& values) {
    if (!values.empty()) out.value(name, list(values));
  };
  any("ratio", settings.ratio);
  if (!settings.matrix.empty()) out.value("matrix", rows(settings.matrix));
  any("offset_rad", settings.offset_rad);
  any("torque_constant", settings.torque_constant);
  out.text_if_any("source", settings.source);
}

void write_channels(Writer& out, const ChannelMap& channels) {
  const auto write = [&](const char* quantity) {
    for (const std::string& line : channel_lines(channels, quantity)) out.line(line);
  };
  out.table("[channels]");
  if (channels.at_rest) {
    out.value("at_rest", "true");
  } else if (channels.period_s > 0) {
    out.value("period_s", shortest_real(channels.period_s));
  } else {
    write("time");
  }
  write("position");
  const bool any_velocity = std::any_of(channels.velocity.begin(), channels.velocity.end(),
                                        [](const auto& channel) { return channel.has_value(); });
  if (any_velocity) write("velocity");
  write("torque");
  // Read as relative to a file whose folder is not known here.
  if (!channels.dbc.empty()) {
    out.value("dbc", quoted(std::filesystem::absolute(channels.dbc).string()));
  }
  if (!channels.payloads.empty()) {
    out.value("payload", "[" + list_of(channels.payloads, payload_text) + "]");
  }
  if (channels.extra.empty()) return;
  out.table("[channels.extra]");
  for (const auto& [name, channel] : channels.extra) out.value(key(name), channel_text(channel));
}

}  // namespace

std::string channels_table(const ChannelMap& channels) {
  Writer out;
  write_channels(out, channels);
  return out.text().substr(1);  // behind the line that parts it from what comes before
}

std::vector<std::string> channel_lines(const ChannelMap& channels, std::string_view quantity) {
  std::vector<std::string> lines;
  if (quantity == "time") {
    lines.push_back("time = " + time_value(channels));
  } else if (quantity == "position") {
    add_sides(as_optional(channels.position), channels.position_of, quantity, lines);
  } else if (quantity == "velocity") {
    add_sides(channels.velocity, channels.velocity_of, quantity, lines);
  } else {
    add_sides(as_optional(channels.torque), channels.torque_of, quantity, lines);
    add_sensors(channels, lines);
  }
  return lines;
}

std::string effect_text(const RobotEffect& effect) {
  const EffectInfo* info = info_of(effect.kind);
  if (info == nullptr) return {};
  Writer out;
  out.line("[[effect]]");
  out.value("kind", quoted(info->name));
  out.value(effect.of_motor ? "motor" : "joint", std::to_string(effect.joint + 1));
  for (std::size_t i = 0; i < info->parameters.size(); ++i) {
    const bool whole = info->parameters[i].quantity == Quantity::kJointNumber;
    out.value(info->parameters[i].name,
              whole ? shortest(effect.parameters[i]) : shortest_real(effect.parameters[i]));
  }
  if (effect.fitted) out.value("fitted", "true");
  out.text_if_any("source", effect.source);
  return out.text();
}

std::string place_of(const Effect<double>& effect) {
  return (effect.of_motor ? "motor " : "joint ") + std::to_string(effect.joint + 1);
}

std::string bound_text(const BoundSettings& bound) {
  Writer out;
  write_bound(out, bound);
  return out.text();
}

std::string robot_text(const RobotDescription& robot) {
  Writer out;
  out.line("# A robot file of offnominal: docs/robot-file.md explains every key.");
  out.value("format", std::to_string(kRobotFileFormat));
  out.value("name", quoted(robot.name));
  out.text_if_any("source", robot.source);
  out.value("gravity_m_s2", list(robot.gravity_m_s2));
  for (const RobotJoint& joint : robot.joints) write_joint(out, joint);
  for (const RobotEffect& effect : robot.effects) out.block(effect_text(effect));
  write_estimator(out, robot.estimator);
  write_arming(out, robot.arming);
  if (robot.bound) out.block(bound_text(*robot.bound));
  if (robot.transmission) write_transmission(out, *robot.transmission);
  if (robot.drives) write_drives(out, *robot.drives);
  if (robot.channels) write_channels(out, *robot.channels);
  return out.text();
}

}  // namespace offnominal::desk
