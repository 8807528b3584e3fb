#include <nlohmann/json.hpp>

#include "motion/design_report.hpp"

namespace offnominal::desk::motion {

using nlohmann::ordered_json;

namespace {

ordered_json json_of(const Contender& one) {
  return {{"effect", one.effect->name()}, {"joint", one.joint + 1}};
}

ordered_json json_of(const Separation& one) {
  return {{"sine", one.sine},
          {"torque_rms", one.torque_rms},
          {"noise_rms", one.noise_rms},
          {"evidence", one.evidence}};
}

ordered_json json_of(const RobotDescription& robot, const PairReport& pair) {
  ordered_json json = json_of(pair.truth);
  json["against"] = pair.rival ? json_of(*pair.rival) : ordered_json(nullptr);
  json["unit"] = unit_of(Quantity::kEffort,
                         robot.joints[static_cast<std::size_t>(pair.truth.joint)].joint.type);
  json["possible"] = pair.possible;
  json["before"] = pair.before ? json_of(*pair.before) : ordered_json(nullptr);
  json["after"] = json_of(pair.after);
  return json;
}

ordered_json joint_json(const RobotDescription& robot, const Design& design, std::size_t joint) {
  const JointUse use = use_of(robot, design, joint);
  const JointLimits& limits = design.limits[joint];
  return {{"joint", joint + 1},
          {"position", {{"low", use.low}, {"high", use.high}, {"unit", use.position_unit}}},
          {"top_speed", {{"value", use.top_speed}, {"unit", use.velocity_unit}}},
          {"top_torque", {{"value", use.top_torque}, {"unit", use.torque_unit}}},
          {"allowed",
           {{"low", limits.low},
            {"high", limits.high},
            {"velocity", limits.velocity},
            {"torque", limits.torque}}},
          {"sufficient", static_cast<bool>(design.excited[joint])}};
}

}  // namespace

ordered_json to_json(const RobotDescription& robot, const Design& design,
                     const DesignNames& names) {
  ordered_json json;
  json["robot"] = names.robot_file;
  json["logs"] = names.logs;
  json["output"] = names.output;
  json["sentence"] = sentence_of(robot, design, names);
  json["purpose"] = design.request.effects.size() > 1 ? "separate" : "excite";
  json["effects"] = ordered_json::array();
  for (const Contender& one : design.request.effects) json["effects"].push_back(json_of(one));
  json["seed"] = design.request.seed;
  json["duration"] = {{"value", design.request.duration_s}, {"unit", "s"}};
  json["rate"] = {{"value", design.request.rate_hz}, {"unit", "Hz"}};
  json["slow_from"] = {{"value", design.slow_from_s}, {"unit", "s"}};
  json["margin"] = design.request.margin;
  json["expected"] = {{"effect_share", design.request.expectation.effect_share},
                      {"noise_share", design.request.expectation.noise_share}};
  json["motions_tried"] = design.motions_tried;
  json["joints"] = ordered_json::array();
  for (std::size_t j = 0; j < robot.joints.size(); ++j) {
    json["joints"].push_back(joint_json(robot, design, j));
  }
  json["pairs"] = ordered_json::array();
  for (const PairReport& pair : design.pairs) json["pairs"].push_back(json_of(robot, pair));
  return json;
}

}  // namespace offnominal::desk::motion
