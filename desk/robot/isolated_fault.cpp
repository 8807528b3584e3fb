#include "robot/isolated_fault.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

namespace offnominal::desk {
namespace {

// With the sign that `factor` gives it.
std::string range_of(const IsolatedFault& fault, double factor, const std::string& unit) {
  const double size = factor * fault.size;
  const double two = 2 * std::abs(factor) * fault.deviation;
  return fmt::format("{:.3g} {} ({:.3g} to {:.3g})", size, unit, size - two, size + two);
}

std::string what_it_is(const IsolatedFault& fault) {
  const bool more = fault.size >= 0;
  const double sign = more ? 1 : -1;
  switch (fault.kind) {
    case FaultKind::kFriction:
      return (more ? "friction up by " : "friction down by ") + range_of(fault, sign, fault.unit);
    case FaultKind::kLostTorque:
      return (more ? "torque lost, " : "torque gained, ") + range_of(fault, sign * 100, "%") +
             " of what the drive is told";
    case FaultKind::kOffset:
      return fmt::format("a constant torque of {} acts on it", range_of(fault, 1, fault.unit));
    case FaultKind::kPayload:
      return (more ? "payload gained, " : "payload lost, ") + range_of(fault, sign, fault.unit);
    case FaultKind::kContact:
      return fmt::format(
          "contact with its link or one behind it, torques of joints up to {:.3g} {}",
          std::abs(fault.size), fault.unit);
    case FaultKind::kEncoderStuck:
      return "its encoder sticks";
    case FaultKind::kEncoderJump:
      return fmt::format("its encoder has jumped by {:.3g} {}", fault.size, fault.unit);
    case FaultKind::kLockedJoint:
      return fmt::format("locked, against up to {:.3g} {}", std::abs(fault.size), fault.unit);
    case FaultKind::kUnknown:
      break;
  }
  return "";
}

}  // namespace

std::vector<JointType> joint_types(const RobotDescription& robot) {
  std::vector<JointType> types;
  for (const RobotJoint& joint : robot.joints) types.push_back(joint.joint.type);
  return types;
}

std::vector<std::string> joint_names(const RobotDescription& robot) {
  std::vector<std::string> names;
  for (const RobotJoint& joint : robot.joints) names.push_back(joint.name);
  return names;
}

std::string words_of(const IsolatedFault& fault, const std::vector<std::string>& names) {
  const std::string how =
      fmt::format("{:.2f} s after the detection{}", fault.time_s - fault.detection_time_s,
                  fault.decided ? "" : ", not decided yet");
  if (fault.kind == FaultKind::kUnknown && !fault.decided) {
    return fmt::format(
        "Unknown so far: what is seen does not say which fault it is, {}; an arm that stands says "
        "little, let it move",
        how);
  }
  if (fault.kind == FaultKind::kUnknown) {
    return fmt::format("Unknown: none of the faults that it can name fits, {}", how);
  }
  const auto joint = static_cast<std::size_t>(fault.joint);
  return fmt::format("Joint {} ({}): {}, {}, confidence {:.0f} %", joint + 1, names[joint],
                     what_it_is(fault), how, 100 * fault.confidence);
}

nlohmann::json to_json(const IsolatedFault& fault, const std::vector<std::string>& names) {
  const auto number = [](bool is_there, double value) {
    return is_there && std::isfinite(value) ? nlohmann::json(value) : nlohmann::json();
  };
  const bool has_joint = fault.kind != FaultKind::kUnknown;
  const bool has_size = !fault.unit.empty();
  return {{"kind", name_of(fault.kind)},
          {"joint", has_joint ? nlohmann::json(fault.joint + 1) : nlohmann::json()},
          {"size", number(has_size, fault.size)},
          {"deviation", number(has_size, fault.deviation)},
          {"unit", has_size ? nlohmann::json(fault.unit) : nlohmann::json()},
          {"confidence", fault.confidence},
          {"unexplained", fault.unexplained},
          {"detection_time_s", fault.detection_time_s},
          {"time_s", fault.time_s},
          {"decided", fault.decided},
          {"words", words_of(fault, names)}};
}

IsolatedFault isolated_fault_of(const nlohmann::json& json) {
  const auto number = [&](const char* key) {
    return json.at(key).is_null() ? 0.0 : json.at(key).get<double>();
  };
  IsolatedFault fault;
  for (std::size_t i = 0; i < kFaultKinds; ++i) {
    const auto kind = static_cast<FaultKind>(i);
    if (json.at("kind") == name_of(kind)) fault.kind = kind;
  }
  fault.joint = json.at("joint").is_null() ? 0 : json.at("joint").get<int>() - 1;
  fault.size = number("size");
  fault.deviation = number("deviation");
  if (!json.at("unit").is_null()) fault.unit = json.at("unit");
  fault.confidence = number("confidence");
  fault.unexplained = number("unexplained");
  fault.detection_time_s = number("detection_time_s");
  fault.time_s = number("time_s");
  fault.decided = json.at("decided");
  return fault;
}

}  // namespace offnominal::desk
