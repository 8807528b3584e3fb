#include "codegen/model_header.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <offnominal/control/arming.hpp>
#include <offnominal/control/computed_torque.hpp>
#include <offnominal/model/effect_list.hpp>
#include <offnominal/model/quantity.hpp>
#include <offnominal/monitor.hpp>
#include <offnominal/version.hpp>
#include <span>
#include <string_view>
#include <vector>

#include "codegen/bound_constant.hpp"
#include "codegen/cpp_text.hpp"
#include "common/error.hpp"
#include "common/nearest.hpp"
#include "common/number.hpp"
#include "drives/drive_table.hpp"
#include "robot/chain_of.hpp"
#include "robot/monitor_config_of.hpp"
#include "robot/robot_file.hpp"

namespace offnominal::desk {
namespace {

using cpp_text::indented;
using cpp_text::member;

// Limits that are not set keep the default, the largest number of the scalar.
std::string limits_text(const Joint<double>& joint) {
  const Joint<double> unlimited;
  std::string text;
  const auto limit = [&](const char* name, double value, double none, Quantity quantity,
                         const char* remark) {
    if (value == none) return;
    text += member(name, cpp_text::number(value),
                   fmt::format("{}{}", unit_of(quantity, joint.type), remark));
  };
  limit("min_position", joint.min_position, unlimited.min_position, Quantity::kPosition, "");
  limit("max_position", joint.max_position, unlimited.max_position, Quantity::kPosition, "");
  limit("max_velocity", joint.max_velocity, unlimited.max_velocity, Quantity::kVelocity,
        ", magnitude");
  limit("max_torque", joint.max_torque, unlimited.max_torque, Quantity::kEffort, ", magnitude");
  return text;
}

// A zero with a sign is another number than one without.
template <std::size_t Size>
bool same_bits(const std::array<double, Size>& a, const std::array<double, Size>& b) {
  using Bits = std::array<std::uint64_t, Size>;
  return std::bit_cast<Bits>(a) == std::bit_cast<Bits>(b);
}

std::string joint_text(const Joint<double>& joint) {
  const bool turns = joint.type == JointType::kRevolute;
  std::string text = member(
      "type", turns ? "offnominal::JointType::kRevolute" : "offnominal::JointType::kPrismatic");
  text += member("axis", cpp_text::numbers(joint.axis), "unit vector, joint's frame");
  text += member("origin_m", cpp_text::numbers(joint.origin_m), "m, in the frame before it");
  const Joint<double> plain;
  if (!same_bits(joint.rotation, plain.rotation)) {
    text += member("rotation", cpp_text::numbers(joint.rotation),
                   "row by row, into the frame before it");
  }
  text += member("mass_kg", cpp_text::number(joint.mass_kg), "kg");
  text += member("centre_of_mass_m", cpp_text::numbers(joint.centre_of_mass_m), "m, link's frame");
  const bool point_mass = same_bits(joint.inertia_kg_m2, plain.inertia_kg_m2);
  text += member(
      "inertia_kg_m2", point_mass ? "{}" : cpp_text::numbers(joint.inertia_kg_m2),
      point_mass ? "a point mass" : "kg m^2 about the centre of mass: xx, yy, zz, xy, xz, yz");
  return text + limits_text(joint);
}

// What the parameters are called, and in what unit: "level 0.5 N m, smoothing 0.01 rad/s".
std::string parameter_remark(const EffectInfo& info, JointType type) {
  std::string text;
  for (const ParameterInfo& parameter : info.parameters) {
    const std::string_view unit = unit_of(parameter.quantity, type);
    const bool plain = unit.empty() || unit == "1";
    text += fmt::format("{}{}{}{}", text.empty() ? "" : ", ", parameter.name, plain ? "" : " in ",
                        plain ? "" : unit);
  }
  return text;
}

std::string kind_text(EffectKind kind) {
  // The enumerator is the name in a robot file, written together.
  std::string name = "k";
  bool upper = true;
  for (const char c : std::string_view(info_of(kind)->name)) {
    if (c != '_') name += upper ? static_cast<char>(c - 'a' + 'A') : c;
    upper = c == '_';
  }
  return "offnominal::EffectKind::" + name;
}

std::string effect_constant(const Effect<double>& effect, const RobotDescription& robot) {
  const EffectInfo& info = *info_of(effect.kind);
  std::string text =
      cpp_text::comment(fmt::format("{}{}: {}; {}", info.name, effect.of_motor ? " of a motor" : "",
                                    info.formula, parameter_remark(info, robot.type_of(effect))));
  const std::span<const double> parameters(effect.parameters.data(), info.parameters.size());
  return text + fmt::format("{{.kind = {}, .joint = {}, .parameters = {}{}}},\n",
                            kind_text(effect.kind), effect.joint, cpp_text::numbers(parameters),
                            effect.of_motor ? ", .of_motor = true" : "");
}

// Nothing where no effect asks for it.
std::string transmission_text(const Chain<kRuntimeJoints, double>& chain) {
  const auto effects = chain.effects.view();
  const bool used = std::any_of(effects.begin(), effects.end(),
                                [](const Effect<double>& effect) { return effect.of_motor; });
  if (!used) return {};
  // The chain of run time has room for more joints than there are.
  const std::size_t joints = chain.joints.size();
  std::vector<double> matrix;
  for (std::size_t motor = 0; motor < joints; ++motor) {
    const auto row = chain.transmission.motor_per_joint.begin() +
                     static_cast<std::ptrdiff_t>(motor * chain.transmission.kMost);
    matrix.insert(matrix.end(), row, row + static_cast<std::ptrdiff_t>(joints));
  }
  const std::span<const double> offset = chain.transmission.motor_offset_rad;
  std::string members = member("motor_per_joint", cpp_text::numbers(matrix),
                               "row by row, rad of the motor per rad or m");
  members += member("motor_offset_rad", cpp_text::numbers(offset.first(joints)));
  return ".transmission =\n    {\n" + indented(members, "        ") + "    },\n";
}

std::string chain_text(const Chain<kRuntimeJoints, double>& chain, const RobotDescription& robot) {
  std::string joints;
  for (std::size_t i = 0; i < chain.joints.size(); ++i) {
    const RobotJoint& from = robot.joints[i];
    joints += cpp_text::comment(fmt::format("joint {}: {}{}{}", i + 1, from.name,
                                            from.source.empty() ? "" : "; ", from.source));
    joints += "{\n" + indented(joint_text(chain.joints[i]), "    ") + "},\n";
  }
  std::string effects;
  for (const Effect<double>& effect : chain.effects.view()) {
    effects += effect_constant(effect, robot);
  }
  std::string text = ".joints = {{\n" + indented(joints, "    ") + "}},\n";
  text += member("gravity_m_s2", cpp_text::numbers(chain.gravity_m_s2), "m/s^2, base frame");
  if (effects.empty()) return text;
  text += ".effects =\n    {\n        .items = {{\n" + indented(effects, "            ") +
          fmt::format("        }}}},\n        .size = {},\n    }},\n", chain.effects.size);
  return text + transmission_text(chain);
}

std::string estimator_constant(const EstimatorConfig<double>& config) {
  std::string text = member("period_s", cpp_text::number(config.period_s), "s, length of a tick");
  text += member("alpha", cpp_text::number(config.alpha), "1/s, pole of the filter");
  text += member("learning_rate", cpp_text::number(config.learning_rate), "Gamma");
  text += member("weight_radius", cpp_text::number(config.weight_radius), "M");
  text += member("dead_zone", config.dead_zone == DeadZone::kContinuous
                                  ? "offnominal::DeadZone::kContinuous"
                                  : "offnominal::DeadZone::kDiscontinuous");
  text += member("hidden_units", "kHiddenUnits", "L");
  text += member("initial_weight_range", cpp_text::number(config.initial_weight_range));
  return text + member("seed", fmt::format("{}U", config.seed), "of the initial weights");
}

std::string arming_constant(const ArmingConfig<kRuntimeJoints, double>& config,
                            const RobotDescription& robot) {
  return cpp_text::comment(robot.arming.source) +
         member("position_window", cpp_text::numbers(config.position_window), "rad or m") +
         member("speed", cpp_text::numbers(config.speed), "rad/s or m/s") +
         member("torque_rate", cpp_text::numbers(config.torque_rate), "N m/s or N/s") +
         member("ramp_s", cpp_text::number(config.ramp_s), "s");
}

std::string constant(std::string_view type, std::string_view name, std::string_view members,
                     const ModelHeader& header) {
  const char* head = header.in_float == Status::kOk ? "template <typename Scalar>\n"
                                                    : "template <std::same_as<double> Scalar>\n";
  return fmt::format("{}inline constexpr {} {}{{\n{}}};\n\n", head, type, name,
                     indented(members, "    "));
}

std::string units_remark(const RobotDescription& robot) {
  std::string text = "SI units:";
  for (std::size_t i = 0; i < robot.joints.size(); ++i) {
    const bool turns = robot.joints[i].joint.type == JointType::kRevolute;
    text += fmt::format("{} joint {} moves in {}", i == 0 ? "" : ",", i + 1,
                        turns ? "rad and is driven in N m" : "m and is driven in N");
  }
  return text + ".";
}

std::string drive_includes(const DriveProtocol& protocol) {
  return fmt::format("#include <offnominal/hal/drive_description.hpp>\n#include <{}>\n",
                     protocol.header);
}

// What stands in a list of values, in its order: "node, joint_per_turn in rad or m".
std::string keys_remark(std::span<const hal::DriveKey> keys) {
  return list_of(keys, [](const hal::DriveKey& key) {
    const std::string_view unit = key.unit;
    return fmt::format("{}{}{}", key.name, unit.empty() ? "" : " in ", unit);
  });
}

std::string drive_numbers(std::string_view name, const std::vector<double>& values,
                          std::size_t per_line) {
  std::string text =
      fmt::format("inline constexpr std::array<double, {}> {}{{", values.size(), name);
  for (std::size_t i = 0; i < values.size(); ++i) {
    text += fmt::format("{}{}",
                        i == 0              ? ""
                        : i % per_line == 0 ? ",\n    "
                                            : ", ",
                        shortest_real(values[i]));
  }
  return text + "};\n";
}

// Doubles, whatever the scalar: what a driver makes of them it makes before the first tick.
std::string drives_text(const DriveSettings& settings) {
  const DriveProtocol& protocol = protocol_of(settings);
  std::string text = "// How the drives are spoken to.\n" + cpp_text::comment(settings.source);
  text += fmt::format("using DriveProtocol = {};\n", protocol.type);
  if (protocol.keys.empty() && protocol.joint_keys.empty()) {
    return text + "inline constexpr offnominal::hal::DriveValues kDriveValues{};\n\n";
  }
  text += cpp_text::comment(keys_remark(protocol.keys));
  text += drive_numbers("kDriveSettings", settings.shared, protocol.keys.size());
  text += cpp_text::comment("Joint by joint: " + keys_remark(protocol.joint_keys));
  text += drive_numbers("kDriveSettingsOfJoints", settings.of_joints, protocol.joint_keys.size());
  return text +
         "inline constexpr offnominal::hal::DriveValues kDriveValues{kDriveSettings,\n"
         "                                                           kDriveSettingsOfJoints};\n\n";
}

std::string head_text(const RobotDescription& robot, const ModelHeaderOptions& options,
                      const ModelHeader& header) {
  const std::string file = std::filesystem::path(options.robot_file).filename().string();
  std::string text = cpp_text::comment(fmt::format(
      "Robot \"{}\" for a controller, from {}. Written by `offnominal codegen`, version {}.{}.{}: "
      "change the robot file and write this header anew, not by hand.",
      robot.name, file, kVersionMajor, kVersionMinor, kVersionPatch));
  text += "//\n" + cpp_text::comment(units_remark(robot));
  if (!robot.source.empty()) text += "//\n" + cpp_text::comment("Source: " + robot.source);
  text +=
      "#pragma once\n\n#include <algorithm>\n#include <array>\n#include <concepts>\n"
      "#include <limits>\n#include <offnominal/control/arming.hpp>\n"
      "#include <offnominal/control/computed_torque.hpp>\n"
      "#include <offnominal/diagnosis/isolation_choice.hpp>\n"
      "#include <offnominal/monitor.hpp>\n#include <offnominal/version.hpp>\n";
  // Without [drives] the core's headers are all that it takes.
  if (robot.drives) text += drive_includes(protocol_of(*robot.drives));
  text += "\n";
  text += fmt::format(
      "static_assert(offnominal::kVersionMajor == {} && offnominal::kVersionMinor == {},\n"
      "              \"the headers of offnominal are of another version than this model: write it "
      "anew\");\n\n",
      kVersionMajor, kVersionMinor);
  text += fmt::format("namespace {} {{\n\n", options.name_space);
  if (header.in_float != Status::kOk) {
    text += cpp_text::comment(
        fmt::format("For double only: rounded to float the core refuses it with status {}.",
                    name_of(header.in_float)));
  }
  text += fmt::format("inline constexpr int kJoints = {};\n", header.joints);
  text += fmt::format("inline constexpr int kHiddenUnits = {};\n", header.hidden_units);
  const std::string names =
      list_of(robot.joints, [](const RobotJoint& joint) { return cpp_text::literal(joint.name); });
  const bool memory = std::any_of(robot.effects.begin(), robot.effects.end(),
                                  [](const RobotEffect& effect) { return remembers(effect.kind); });
  const bool by_joint = robot.estimator.space == EstimatorSpace::kTorque;
  const bool isolates = robot.estimator.isolation;
  return text +
         fmt::format("inline constexpr std::array<const char*, kJoints> kJointNames{{{}}};\n\n",
                     names) +
         fmt::format("// {}\nusing Memory = offnominal::{};\n",
                     memory ? "Some effects have a memory." : "No effect has a memory.",
                     memory ? "WithMemory" : "WithoutMemory") +
         fmt::format("// {}\nusing Space = offnominal::{};\n",
                     by_joint ? "Thresholds joint by joint, N m or N."
                              : "One threshold of the norm over all joints.",
                     by_joint ? "TorqueSpace" : "AccelerationSpace") +
         fmt::format("// {}\nusing Isolates = offnominal::{};\n",
                     isolates ? "After a detection the controller says which fault it is."
                              : "The controller says where, not which fault it is.",
                     isolates ? "WithIsolation" : "WithoutIsolation") +
         "// Takes kMonitorConfig<Scalar>.\ntemplate <typename Scalar>\n"
         "using Monitor = offnominal::Monitor<kJoints, kHiddenUnits, Scalar, Memory, Space>;\n\n";
}

// Like the other conversions, but it has no type of the core.
std::string encoder_text(const RobotDescription& robot, const ModelHeader& header) {
  std::vector<double> counts;
  for (const RobotJoint& joint : robot.joints) counts.push_back(joint.encoder.counts_per_unit);
  std::string list = cpp_text::numbers(counts);
  return "// Counts per rad or per m; 0: no quantisation is known.\n" +
         constant("std::array<Scalar, kJoints>", "kEncoderCountsPerUnit",
                  list.substr(1, list.size() - 2) + ",\n", header);
}

template <typename Space>
Status validity_in_float(const RobotDescription& robot) {
  const auto config = monitor_config_of<kRuntimeJoints, float, Space>(robot);
  Status status = validate<kMaxHiddenUnits>(config);
  if (status != Status::kOk) return status;
  status = EffectMemory<kRuntimeJoints, float>::validate(config.chain, config.estimator.period_s);
  if (status != Status::kOk) return status;
  status = validate(gains_of<kRuntimeJoints, float>(robot));
  return status == Status::kOk ? validate(arming_of<kRuntimeJoints, float>(robot)) : status;
}

template <typename Space>
ModelHeader write(const RobotDescription& robot, const ModelHeaderOptions& options) {
  const auto config = monitor_config_of<kRuntimeJoints, double, Space>(robot);
  const ComputedTorqueGains<kRuntimeJoints, double> gains = gains_of<kRuntimeJoints, double>(robot);
  ModelHeader header{.text = {},
                     .joints = robot.joint_count(),
                     .hidden_units = config.estimator.hidden_units,
                     .effects = config.chain.effects.size,
                     .in_float = validity_in_float<Space>(robot)};
  std::string text = head_text(robot, options, header);
  text += constant("offnominal::Chain<kJoints, Scalar>", "kChain", chain_text(config.chain, robot),
                   header);
  text += constant("offnominal::EstimatorConfig<Scalar>", "kEstimatorConfig",
                   cpp_text::comment(robot.estimator.source) + estimator_constant(config.estimator),
                   header);
  const BoundConstant bound = bound_constant(config.bound, robot);
  text += cpp_text::comment(bound.remark) +
          constant(bound.type, "kBound", cpp_text::comment(robot.bound->source) + bound.members,
                   header);
  const bool held = config.torque_signal == TorqueSignal::kHeld;
  text +=
      constant("offnominal::MonitorConfig<kJoints, Scalar, Space>", "kMonitorConfig",
               member("chain", "kChain<Scalar>") + member("estimator", "kEstimatorConfig<Scalar>") +
                   member("bound", "kBound<Scalar>") +
                   member("torque_signal", held ? "offnominal::TorqueSignal::kHeld"
                                                : "offnominal::TorqueSignal::kSampled") +
                   "// N m or N: the joints' limits. All zero: report, do not act.\n" +
                   member("max_compensation", cpp_text::numbers(config.max_compensation)),
               header);
  text += constant("offnominal::ComputedTorqueGains<kJoints, Scalar>", "kComputedTorqueGains",
                   member("kp", cpp_text::numbers(gains.kp), "1/s^2") +
                       member("kd", cpp_text::numbers(gains.kd), "1/s"),
                   header);
  text += constant("offnominal::ArmingConfig<kJoints, Scalar>", "kArmingConfig",
                   arming_constant(arming_of<kRuntimeJoints, double>(robot), robot), header);
  if (robot.drives) text += drives_text(*robot.drives);
  header.text =
      text + encoder_text(robot, header) + fmt::format("}}  // namespace {}\n", options.name_space);
  return header;
}

}  // namespace

ModelHeader model_header(const RobotDescription& robot, const ModelHeaderOptions& options) {
  if (!cpp_text::is_namespace(options.name_space)) {
    throw InputError({.file = "offnominal codegen",
                      .place = "--namespace",
                      .found = options.name_space,
                      .allowed = "names of letters, digits and single _ that C++ has not taken, :: "
                                 "between them",
                      .mend = "choose another name"});
  }
  require_bound(robot, options.robot_file);
  return robot.estimator.space == EstimatorSpace::kTorque
             ? write<TorqueSpace>(robot, options)
             : write<AccelerationSpace>(robot, options);
}

}  // namespace offnominal::desk
