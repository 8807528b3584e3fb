#include "replay/monitor_filter.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numbers>

#include "log/sampling.hpp"

namespace offnominal::desk {

double MonitorFilter::cutoff_hz() const { return alpha_per_s / (2 * std::numbers::pi); }

MonitorFilter monitor_filter(const RobotDescription& robot, const Log& log) {
  MonitorFilter filter;
  filter.alpha_per_s = robot.estimator.alpha;
  filter.observed = log.readings.rows() > 0;
  if (std::find(log.dq_derived.begin(), log.dq_derived.end(), true) != log.dq_derived.end())
    filter.velocity_cutoff_hz = derived_velocity_cutoff_hz(log.sample_rate_hz());
  return filter;
}

std::string words_of(const MonitorFilter& filter) {
  std::string words =
      fmt::format("samples as {}, the monitor's own filter {:.4g} Hz by alpha_per_s",
                  filter.observed ? "a controller observes them" : "recorded", filter.cutoff_hz());
  if (filter.velocity_cutoff_hz) {
    words += fmt::format("; velocities that were not recorded: of positions, low-pass {:.4g} Hz",
                         *filter.velocity_cutoff_hz);
  }
  return words;
}

nlohmann::ordered_json to_json(const MonitorFilter& filter) {
  nlohmann::ordered_json json{{"cutoff_hz", filter.cutoff_hz()},
                              {"cutoff_from", "alpha_per_s"},
                              {"alpha_per_s", filter.alpha_per_s},
                              {"velocity_cutoff_hz", nullptr},
                              {"observed", filter.observed}};
  if (filter.velocity_cutoff_hz) json["velocity_cutoff_hz"] = *filter.velocity_cutoff_hz;
  return json;
}

}  // namespace offnominal::desk
