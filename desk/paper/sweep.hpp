// The smallest loss of mass that the monitor detects.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "paper/experiment.hpp"

namespace offnominal::desk::paper {

struct SweepProbe {
  double mass_loss = 0.0;                  // share of mass 1
  std::optional<double> detection_time_s;  // none: not detected
};

struct SweepResult {
  double resolution = 0.005;
  std::vector<SweepProbe> probes;            // ascending
  std::optional<double> smallest_detected;   // none: no loss was detected
  std::optional<double> largest_undetected;  // none: every loss was detected
  // Of the first run with an alarm before its fault. Such a run detects nothing.
  std::optional<double> false_alarm_s;
};

/// Every loss from `resolution` upwards in steps of `resolution` up to twice the first one that is
/// detected, then in steps of 0.05 up to 0.95. The fine steps leave nothing out below the first
/// detection, so that it is the smallest one on the grid without the assumption that larger losses
/// are seen more easily; the steps above it put that assumption to the test (largest_undetected).
/// `base` gives everything but the loss. `on_probe` is called after each run. Throws as
/// run_experiment(), and InputError for a resolution outside 0.001 to 0.1.
[[nodiscard]] SweepResult sweep_mass_loss(
    const RobotDescription& robot, const Experiment& base, double resolution = 0.005,
    const std::function<void(const SweepProbe&)>& on_probe = {});

}  // namespace offnominal::desk::paper
