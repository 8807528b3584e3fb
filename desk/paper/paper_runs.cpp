#include "paper/paper_runs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace offnominal::desk::paper {
namespace {

std::string seconds(const std::optional<double>& time_s) {
  return time_s ? fmt::format("{:.3f} s", *time_s) : "not detected";
}

bool near(const std::optional<double>& value, double target, double tolerance) {
  return value && std::abs(*value - target) <= tolerance + 1e-9;
}

Comparison accommodation(const std::string& fault, const ExperimentResult& without,
                         const ExperimentResult& with) {
  const double ratio = with.tracking_rms_rad / without.tracking_rms_rad;
  return {fault + ": tracking error, accommodated", "considerably reduced",
          fmt::format("{:.4f} to {:.4f} rad rms ({:.0f} %)", without.tracking_rms_rad,
                      with.tracking_rms_rad, 100.0 * ratio),
          ratio <= 0.5};
}

Comparison estimate(const std::string& fault, const ExperimentResult& run) {
  return {
      fault + ": error of the fault estimate", "a good approximation",
      fmt::format("{:.0f} % of the fault", 100.0 * run.fault_estimate_relative_error.value_or(NAN)),
      std::nullopt};
}

bool detected_at(const SweepResult& sweep, double loss) {
  return std::any_of(sweep.probes.begin(), sweep.probes.end(), [loss](const SweepProbe& probe) {
    return std::abs(probe.mass_loss - loss) < 1e-6 && probe.detection_time_s;
  });
}

}  // namespace

PaperRuns run_everything(const RobotDescription& robot, const Experiment& base,
                         const OnPart& on_part) {
  const auto run = [&](sim::FaultKind fault, bool accommodate) {
    if (on_part) on_part(name_of(fault) + (accommodate ? ", accommodated" : ""));
    Experiment experiment = base;
    experiment.fault.kind = fault;
    experiment.accommodate = accommodate;
    experiment.record = true;
    return run_experiment(robot, experiment);
  };
  PaperRuns runs;
  runs.healthy = run(sim::FaultKind::kNone, false);
  runs.mass_loss = run(sim::FaultKind::kMassLoss, false);
  runs.nonlinear = run(sim::FaultKind::kNonlinear, false);
  runs.mass_loss_accommodated = run(sim::FaultKind::kMassLoss, true);
  runs.nonlinear_accommodated = run(sim::FaultKind::kNonlinear, true);
  Experiment sweep = base;
  sweep.accommodate = false;
  runs.sweep = sweep_mass_loss(robot, sweep, 0.005, [&](const SweepProbe& probe) {
    if (on_part) on_part(fmt::format("sweep, mass loss {:.1f} %", 100.0 * probe.mass_loss));
  });
  return runs;
}

std::vector<Comparison> compare_with_paper(const PaperRuns& runs) {
  const auto& [healthy, mass, nonlinear, mass_acc, nonlinear_acc, sweep] = runs;
  const auto largest = [&runs](auto member) {
    return std::max({runs.healthy.*member, runs.mass_loss.*member, runs.nonlinear.*member});
  };
  const double psi_hat = largest(&ExperimentResult::max_abs_psi_hat_before_fault);
  const double ratio = largest(&ExperimentResult::max_error_to_threshold_before_fault);
  const double weights = largest(&ExperimentResult::max_weight_norm);
  return {
      {"no fault: alarm", "none",
       healthy.detection_time_s ? seconds(healthy.detection_time_s) : "none",
       !healthy.detection_time_s},
      {"before the fault: network output", "0", fmt::format("{:g} rad/s^2", psi_hat),
       psi_hat == 0.0},
      {"before the fault: |e| / mu", "below 1", fmt::format("at most {:.3f}", ratio), ratio < 1.0},
      {"mass loss: detected at", "10.6 s", seconds(mass.detection_time_s),
       near(mass.detection_time_s, 10.6, 0.1)},
      {"nonlinear fault: detected at", "11.0 s", seconds(nonlinear.detection_time_s),
       near(nonlinear.detection_time_s, 11.0, 0.2)},
      {"smallest mass loss that is detected", "10 %",
       sweep.smallest_detected ? fmt::format("{:.1f} %", 100.0 * *sweep.smallest_detected) : "none",
       !detected_at(sweep, 0.075) && detected_at(sweep, 0.1)},
      estimate("mass loss", mass),
      estimate("nonlinear fault", nonlinear),
      accommodation("mass loss", mass, mass_acc),
      accommodation("nonlinear fault", nonlinear, nonlinear_acc),
      {"largest |theta|", "at most 10", fmt::format("{:.2f}", weights), weights <= 10.0},
  };
}

std::string verdict_of(const std::vector<Comparison>& lines, bool paper_settings) {
  std::string differing;
  int agreeing = 0;
  for (const Comparison& line : lines) {
    if (line.agrees.value_or(true)) {
      agreeing += line.agrees ? 1 : 0;
      continue;
    }
    differing += (differing.empty() ? "" : "; ") +
                 fmt::format("{}: {} here, {} in the paper", line.what, line.here, line.paper);
  }
  if (differing.empty()) {
    return fmt::format("All {} results that can be measured against the paper agree with it.",
                       agreeing);
  }
  const std::string words = "Differs from the paper in " + differing + ".";
  return paper_settings ? words : words + " The settings are not the paper's.";
}

}  // namespace offnominal::desk::paper
