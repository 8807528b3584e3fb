#include <cmath>
#include <nlohmann/json.hpp>

#include "replay/replay.hpp"

namespace offnominal::desk {
namespace {

nlohmann::json finite_or_null(double value) {
  return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json();
}

}  // namespace

nlohmann::json to_json(const Replay& replay) {
  nlohmann::json alarms = nlohmann::json::array();
  for (const Alarm& alarm : replay.alarms) {
    alarms.push_back({{"start_s", alarm.start_s},
                      {"end_s", alarm.end_s},
                      {"max_error_to_threshold", finite_or_null(alarm.max_error_to_threshold)}});
  }
  nlohmann::json refused = nlohmann::json::object();
  for (const auto& [status, refusals] : replay.refused) {
    refused[status] = {{"count", refusals.count}, {"first_s", refusals.first_s}};
  }
  return {{"robot", replay.robot},
          {"log", replay.log},
          {"unit", replay.unit},
          {"period_s", replay.period_s},
          {"scalar", "double"},
          {"hidden_units", replay.hidden_units},
          {"seed", replay.seed},
          {"samples", replay.samples()},
          {"judged", replay.judged()},
          {"blind", replay.is_blind()},
          {"refused", refused},
          {"detection_time_s",
           replay.detection_time_s ? nlohmann::json(*replay.detection_time_s) : nlohmann::json()},
          {"alarms", alarms},
          {"max_error_to_threshold", finite_or_null(replay.max_error_to_threshold)},
          {"max_error", replay.error_norm.maxCoeff()},
          {"max_threshold", replay.threshold.maxCoeff()},
          {"max_abs_psi_hat", replay.psi_hat.cwiseAbs().maxCoeff()},
          {"max_weight_norm", replay.max_weight_norm}};
}

}  // namespace offnominal::desk
