#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "log/log.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk {

/// What filters a recording where the monitor itself runs on it: none of the analysis' low-passes
/// (compare/filter_plan.hpp), since it sees on the robot what was recorded.
struct MonitorFilter {
  double alpha_per_s = 0;  // the pole of the residual's filter
  // Of the positions of joints whose velocity was not recorded; none: all were.
  std::optional<double> velocity_cutoff_hz;
  bool observed = false;  // the samples are those of a controller that observes its velocities

  [[nodiscard]] double cutoff_hz() const;  // of the pole
};

[[nodiscard]] MonitorFilter monitor_filter(const RobotDescription& robot, const Log& log);

/// "samples as recorded, the monitor's own filter 1.592 Hz by alpha_per_s", with a word on derived
/// velocities.
[[nodiscard]] std::string words_of(const MonitorFilter& filter);
/// {cutoff_hz, cutoff_from: "alpha_per_s", alpha_per_s, velocity_cutoff_hz (null: recorded, or
/// observed), observed}
[[nodiscard]] nlohmann::ordered_json to_json(const MonitorFilter& filter);

}  // namespace offnominal::desk
