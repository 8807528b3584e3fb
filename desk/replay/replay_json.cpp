#include <cmath>
#include <cstddef>
#include <nlohmann/json.hpp>

#include "replay/replay.hpp"

namespace offnominal::desk {
namespace {

nlohmann::json finite_or_null(double value) {
  return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json();
}

nlohmann::json alarms_json(const std::vector<Alarm>& all) {
  nlohmann::json alarms = nlohmann::json::array();
  for (const Alarm& alarm : all) {
    nlohmann::json& json = alarms.emplace_back(
        nlohmann::json{{"start_s", alarm.start_s},
                       {"end_s", alarm.end_s},
                       {"max_error_to_threshold", finite_or_null(alarm.max_error_to_threshold)}});
    for (const int joint : alarm.joints) json["joints"].push_back(joint + 1);
  }
  return alarms;
}

nlohmann::json blind_json(const std::vector<BlindStretch>& all) {
  nlohmann::json stretches = nlohmann::json::array();
  for (const BlindStretch& one : all) {
    stretches.push_back({{"start_s", one.start_s}, {"end_s", one.end_s}, {"samples", one.samples}});
  }
  return stretches;
}

nlohmann::json time_or_null(const std::optional<double>& time_s) {
  return time_s ? nlohmann::json(*time_s) : nlohmann::json();
}

nlohmann::json faults_json(const Replay& replay) {
  nlohmann::json faults = nlohmann::json::array();
  for (const IsolatedFault& fault : replay.faults) {
    faults.push_back(to_json(fault, replay.joint_names));
  }
  return faults;
}

// What is said of joints that are judged one by one.
void add_joints(const Replay& replay, nlohmann::json& json) {
  nlohmann::json joints = nlohmann::json::array();
  for (std::size_t i = 0; i < replay.joints.size(); ++i) {
    const JointReplay& joint = replay.joints[i];
    const auto index = static_cast<Eigen::Index>(i);
    joints.push_back({{"joint", i + 1},
                      {"name", replay.joint_names[i]},
                      {"unit", joint.unit},
                      {"max_residual", joint.max_residual},
                      {"max_threshold", joint.max_threshold},
                      {"max_error_to_threshold", finite_or_null(joint.max_error_to_threshold)},
                      {"max_abs_psi_hat", replay.psi_hat.col(index).cwiseAbs().maxCoeff()},
                      {"detection_time_s", time_or_null(joint.detection_time_s)},
                      {"alarms", alarms_json(joint.alarms)}});
    if (replay.has_two_levels) joints.back()["act_time_s"] = time_or_null(joint.act_time_s);
    if (replay.fast_error.size() > 0) {
      joints.back()["fast_max_residual"] = joint.fast_max_residual;
      joints.back()["fast_max_threshold"] = joint.fast_max_threshold;
      joints.back()["fast_max_error_to_threshold"] = finite_or_null(joint.max_ratio_fast);
    }
  }
  // Of whichever joint was nearest to its threshold, and of mixed units.
  for (const char* key : {"max_error", "max_threshold", "max_abs_psi_hat"}) json[key] = nullptr;
  json["space"] = "torque";
  if (replay.has_two_levels) json["act_time_s"] = time_or_null(replay.act_time_s);
  json["first_joint"] =
      replay.first_joint ? nlohmann::json(*replay.first_joint + 1) : nlohmann::json();
  json["joints"] = joints;
  json["faults"] = faults_json(replay);
}

}  // namespace

nlohmann::json to_json(const Replay& replay) {
  nlohmann::json refused = nlohmann::json::object();
  for (const auto& [status, refusals] : replay.refused) {
    refused[status] = {{"count", refusals.count}, {"first_s", refusals.first_s}};
  }
  nlohmann::json json = {{"robot", replay.robot},
                         {"log", replay.log},
                         {"unit", replay.unit},
                         {"period_s", replay.period_s},
                         {"scalar", "double"},
                         {"hidden_units", replay.hidden_units},
                         {"seed", replay.seed},
                         {"samples", replay.samples()},
                         {"judged", replay.judged()},
                         {"blind", replay.is_blind()},
                         {"too_short", replay.is_too_short()},
                         {"blind_s", replay.blind_s()},
                         {"blind_stretches", blind_json(replay.blind)},
                         {"refused", refused},
                         {"detection_time_s", time_or_null(replay.detection_time_s)},
                         {"alarms", alarms_json(replay.alarms)},
                         {"max_error_to_threshold", finite_or_null(replay.max_error_to_threshold)},
                         {"max_error", replay.error_norm.maxCoeff()},
                         {"max_threshold", replay.threshold.maxCoeff()},
                         {"max_abs_psi_hat", replay.psi_hat.cwiseAbs().maxCoeff()},
                         {"max_weight_norm", replay.max_weight_norm}};
  if (replay.space == EstimatorSpace::kTorque) add_joints(replay, json);
  return json;
}

}  // namespace offnominal::desk
