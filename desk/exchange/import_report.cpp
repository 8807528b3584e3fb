#include "exchange/import_report.hpp"

#include <fmt/format.h>

#include "common/error.hpp"
#include "common/input_name.hpp"
#include "common/json_text.hpp"
#include "common/number.hpp"
#include "common/text_table.hpp"
#include "exchange/limits.hpp"
#include "robot/robot_file.hpp"

namespace offnominal::desk::exchange {
namespace {

std::string line_of(const ImportNote& note) {
  const std::string at = note.line > 0 ? fmt::format(" (line {})", note.line) : "";
  return fmt::format("{}: {}{}\n", name_of(note.kind), on_one_line(note.text), at);
}

std::string range_of(const Joint<double>& joint) {
  if (!has_range(joint)) return "-";
  return fmt::format("{:.4g} .. {:.4g}", joint.min_position, joint.max_position);
}

std::string limit_of(double limit) {
  return limit == kUnlimited ? "-" : fmt::format("{:.4g}", limit);
}

double friction(const RobotDescription& robot, std::size_t joint, EffectKind kind) {
  for (const RobotEffect& effect : robot.effects) {
    if (effect.joint == joint && effect.kind == kind) return effect.parameters[0];
  }
  return 0;
}

std::string friction_of(const RobotDescription& robot, std::size_t joint, EffectKind kind) {
  const double value = friction(robot, joint, kind);
  return value == 0 ? "-" : fmt::format("{:.4g}", value);
}

}  // namespace

std::string robot_text_of(const ImportedRobot& imported, const std::string& file) {
  std::string text = fmt::format("# Imported from the URDF {} by `offnominal import-urdf{}`.\n",
                                 on_one_line(as_utf8(input_name(file))),
                                 on_one_line(as_utf8(options_of(imported.request))));
  for (const ImportNote& note : imported.notes) text += "# " + as_utf8(line_of(note));
  return text + "\n" + robot_text(imported.robot);
}

std::string text_of(const ImportedRobot& imported) {
  const RobotDescription& robot = imported.robot;
  const std::size_t count = robot.joints.size();
  std::string text = fmt::format("{}: {} {} from `{}` to `{}`\n", robot.name, count,
                                 count == 1 ? "joint" : "joints", imported.base, imported.tip);
  const TextTable table({{"", 2},
                         {"joint", -22},
                         {"type", -9},
                         {"mass kg", 8},
                         {"range rad, m", 18},
                         {"speed /s", 9},
                         {"torque", 7},
                         {"viscous", 8},
                         {"Coulomb", 8}});
  text += table.heading();
  for (std::size_t i = 0; i < count; ++i) {
    const RobotJoint& joint = robot.joints[i];
    const Joint<double>& of = joint.joint;
    text += table.row(i + 1, joint.name, of.type == JointType::kRevolute ? "revolute" : "prismatic",
                      fmt::format("{:.4g}", of.mass_kg), range_of(of), limit_of(of.max_velocity),
                      limit_of(of.max_torque), friction_of(robot, i, EffectKind::kViscousFriction),
                      friction_of(robot, i, EffectKind::kCoulombFriction));
  }
  for (const ImportNote& note : imported.notes) text += line_of(note);
  return text;
}

nlohmann::ordered_json to_json(const ImportedRobot& imported) {
  const RobotDescription& robot = imported.robot;
  nlohmann::ordered_json json{{"robot", robot.name},
                              {"base", imported.base},
                              {"tip", imported.tip},
                              {"gravity_m_s2", robot.gravity_m_s2},
                              {"joints", nlohmann::ordered_json::array()},
                              {"notes", nlohmann::ordered_json::array()}};
  for (std::size_t i = 0; i < robot.joints.size(); ++i) {
    const Joint<double>& joint = robot.joints[i].joint;
    nlohmann::ordered_json one{
        {"name", robot.joints[i].name},
        {"type", joint.type == JointType::kRevolute ? "revolute" : "prismatic"},
        {"link", imported.links[i]},
        {"mass_kg", joint.mass_kg},
        {"viscous_friction", friction(robot, i, EffectKind::kViscousFriction)},
        {"coulomb_friction", friction(robot, i, EffectKind::kCoulombFriction)}};
    if (has_range(joint)) {
      one["position"] = {joint.min_position, joint.max_position};
    }
    if (joint.max_velocity != kUnlimited) one["velocity"] = joint.max_velocity;
    if (joint.max_torque != kUnlimited) one["torque"] = joint.max_torque;
    json["joints"].push_back(std::move(one));
  }
  for (const ImportNote& note : imported.notes) {
    nlohmann::ordered_json one{{"kind", name_of(note.kind)}, {"text", note.text}};
    if (note.line > 0) one["line"] = note.line;
    json["notes"].push_back(std::move(one));
  }
  return json;
}

}  // namespace offnominal::desk::exchange
