#include "paper/paper_json.hpp"

#include <nlohmann/json.hpp>

namespace offnominal::desk::paper {
namespace {

using Json = nlohmann::ordered_json;

Json nullable(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

}  // namespace

Json to_json(const ExperimentResult& result) {
  Json json = {
      {"fault", name_of(result.fault)},
      {"accommodate", result.accommodate},
      {"fault_time_s", nullable(result.fault_time_s)},
      {"detection_time_s", nullable(result.detection_time_s)},
      {"guaranteed_detection_time_s", nullable(result.guaranteed_time_s)},
      {"max_error_to_threshold_before_fault", result.max_error_to_threshold_before_fault},
      {"max_abs_psi_hat_before_fault", result.max_abs_psi_hat_before_fault},
      {"tracking_rms_rad", result.tracking_rms_rad},
      {"fault_estimate_relative_error", nullable(result.fault_estimate_relative_error)},
      {"max_weight_norm", result.max_weight_norm},
      {"steps", result.steps},
      {"scalar", name_of(result.precision)},
      {"seed", result.seed},
  };
  if (result.tracking_rms_m) json["tracking_rms_m"] = *result.tracking_rms_m;
  if (result.joints.empty()) return json;
  if (result.has_two_levels) json["act_time_s"] = nullable(result.act_time_s);
  json["first_joint"] = result.first_joint ? Json(*result.first_joint + 1) : Json(nullptr);
  for (const JointRun& joint : result.joints) {
    json["joints"].push_back(
        {{"name", joint.name},
         {"detection_time_s", nullable(joint.detection_time_s)},
         {"max_error_to_threshold_before_fault", joint.max_error_to_threshold_before_fault}});
    if (result.has_two_levels) json["joints"].back()["act_time_s"] = nullable(joint.act_time_s);
  }
  return json;
}

Json to_json(const SweepResult& sweep) {
  Json probes = Json::array();
  for (const SweepProbe& probe : sweep.probes) {
    probes.push_back(
        {{"mass_loss", probe.mass_loss}, {"detection_time_s", nullable(probe.detection_time_s)}});
  }
  return {{"resolution", sweep.resolution},
          {"smallest_detected_mass_loss", nullable(sweep.smallest_detected)},
          {"largest_undetected_mass_loss", nullable(sweep.largest_undetected)},
          {"false_alarm_s", nullable(sweep.false_alarm_s)},
          {"probes", probes}};
}

Json to_json(const PaperRuns& runs, const std::vector<Comparison>& lines,
             const std::string& verdict) {
  Json comparison = Json::array();
  for (const Comparison& line : lines) {
    comparison.push_back({{"what", line.what},
                          {"paper", line.paper},
                          {"here", line.here},
                          {"agrees", line.agrees ? Json(*line.agrees) : Json(nullptr)}});
  }
  Json all = Json::array();
  for (const ExperimentResult* run : {&runs.healthy, &runs.mass_loss, &runs.nonlinear,
                                      &runs.mass_loss_accommodated, &runs.nonlinear_accommodated}) {
    all.push_back(to_json(*run));
  }
  return {{"runs", all},
          {"sweep", to_json(runs.sweep)},
          {"comparison", comparison},
          {"verdict", verdict}};
}

}  // namespace offnominal::desk::paper
