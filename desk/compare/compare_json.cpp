#include <nlohmann/json.hpp>

#include "compare/before_after.hpp"
#include "compare/compare_report.hpp"

namespace offnominal::desk {
namespace {

nlohmann::ordered_json joints_json(const std::vector<JointComparison>& joints) {
  auto json = nlohmann::ordered_json::array();
  for (const JointComparison& joint : joints) {
    json.push_back({{"joint", joint.joint + 1},
                    {"unit", joint.unit},
                    {"rms_error", joint.rms_error},
                    {"rms_torque", joint.rms_torque},
                    {"relative_error_percent", joint.relative_error_percent},
                    {"fit_percent", joint.fit_percent},
                    {"left_out_percent", 100 * joint.left_out},
                    {"at_fault_percent", 100 * joint.at_fault},
                    {"samples", joint.samples}});
    if (!joint.gear) continue;
    json.back()["gear"] = {{"rms", joint.gear->rms},
                           {"percent_of_drive", joint.gear->percent},
                           {"follows", joint.gear->follows.variable},
                           {"share", joint.gear->follows.share}};
  }
  return json;
}

nlohmann::ordered_json where_json(const std::vector<JointComparison>& joints) {
  auto json = nlohmann::ordered_json::array();
  for (const JointComparison& joint : joints) {
    for (const ErrorShare& where : joint.where) {
      json.push_back({{"joint", joint.joint + 1},
                      {"variable", where.variable},
                      {"share_of_residual", where.share}});
    }
  }
  return json;
}

nlohmann::ordered_json fall_json(const std::vector<JointComparison>& before,
                                 const std::vector<JointComparison>& after) {
  auto json = nlohmann::ordered_json::array();
  for (const BeforeAfter& error : before_after(before, after)) {
    json.push_back({{"joint", error.joint + 1},
                    {"unit", error.unit},
                    {"rms_error", error.before_rms},
                    {"relative_error_percent", error.before_percent},
                    {"fall_percent", 100 * error.fall()}});
  }
  return json;
}

}  // namespace

nlohmann::ordered_json to_json(const FilterPlan& plan) {
  using nlohmann::ordered_json;
  const bool by_encoder = plan.reason.kind == CutoffReason::Kind::kEncoder;
  return {{"sample_rate_hz", plan.sample_rate_hz},
          {"position_cutoff_hz", plan.position_cutoff_hz},
          {"torque_cutoff_hz", plan.torque_cutoff_hz},
          {"cutoff_from", name_of(plan.reason.kind)},
          {"cutoff_joint", by_encoder ? ordered_json(plan.reason.joint + 1) : ordered_json()},
          {"decimation", plan.decimation}};
}

nlohmann::ordered_json to_json(const std::optional<Payload>& payload) {
  if (!payload) return nullptr;
  return {{"mass_kg", payload->mass_kg}, {"place_m", payload->place_m}};
}

nlohmann::ordered_json to_json(const Comparisons& comparisons, const CompareNames& names,
                               const Comparisons* against) {
  nlohmann::ordered_json json;
  const Comparison& first = comparisons.recordings[0];
  const bool several = comparisons.recordings.size() > 1;
  if (!several) json["log"] = names.logs[0];
  json["logs"] = names.logs;
  json["robot"] = names.robot_file;
  json["joints"] = joints_json(comparisons.joints);
  json["where"] = where_json(comparisons.joints);
  Eigen::Index samples = 0;
  for (const Comparison& one : comparisons.recordings) samples += one.t_s.size();
  json["samples"] = samples;
  if (!several) {
    json["filter"] = to_json(first.plan);
    json["remarks"] = first.remarks;
  }
  json["recordings"] = nlohmann::ordered_json::array();
  for (std::size_t r = 0; r < comparisons.recordings.size(); ++r) {
    const Comparison& one = comparisons.recordings[r];
    nlohmann::ordered_json recording{{"log", names.logs[r]},
                                     {"joints", joints_json(one.joints)},
                                     {"where", where_json(one.joints)},
                                     {"samples", one.t_s.size()},
                                     {"filter", to_json(one.plan)},
                                     {"remarks", one.remarks},
                                     {"payload", to_json(one.payload)}};
    if (against != nullptr) {
      recording["against"] = fall_json(against->recordings[r].joints, one.joints);
    }
    json["recordings"].push_back(std::move(recording));
  }
  json["verdict"] = verdict_of(comparisons, against);
  if (against == nullptr) return json;
  json["against"] = {{"robot", names.against_file},
                     {"joints", fall_json(against->joints, comparisons.joints)}};
  return json;
}

}  // namespace offnominal::desk
