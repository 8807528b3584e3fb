#include "paper/sweep.hpp"

#include <string>

#include "common/error.hpp"

namespace offnominal::desk::paper {
namespace {

constexpr double kCoarseStep = 0.05;
constexpr double kLargestLoss = 0.95;

}  // namespace

SweepResult sweep_mass_loss(const RobotDescription& robot, const Experiment& base,
                            double resolution,
                            const std::function<void(const SweepProbe&)>& on_probe) {
  if (!(resolution >= 0.001 && resolution <= 0.1)) {
    throw InputError({.file = "offnominal paper",
                      .place = "sweep resolution",
                      .found = std::to_string(resolution),
                      .allowed = "0.001 to 0.1",
                      .mend = ""});
  }
  SweepResult result;
  result.resolution = resolution;
  const auto probe = [&](double loss) {
    Experiment experiment = base;
    experiment.fault.kind = sim::FaultKind::kMassLoss;
    experiment.fault.mass_loss = loss;
    experiment.record = false;
    SweepProbe found{loss, run_experiment(robot, experiment).detection_time_s};
    if (found.detection_time_s && *found.detection_time_s <= experiment.fault.time_s) {
      if (!result.false_alarm_s) result.false_alarm_s = found.detection_time_s;
      found.detection_time_s.reset();
    }
    result.probes.push_back(found);
    if (!found.detection_time_s) {
      result.largest_undetected = loss;
    } else if (!result.smallest_detected) {
      result.smallest_detected = loss;
    }
    if (on_probe) on_probe(found);
  };

  const double tolerance = 0.01 * resolution;
  double last = 0.0;
  for (int i = 1; i * resolution <= kLargestLoss + tolerance; ++i) {
    const double loss = i * resolution;
    if (result.smallest_detected && loss > 2.0 * *result.smallest_detected + tolerance) break;
    probe(loss);
    last = loss;
  }
  for (int i = 1; i * kCoarseStep <= kLargestLoss + tolerance; ++i) {
    if (i * kCoarseStep > last + tolerance) probe(i * kCoarseStep);
  }
  return result;
}

}  // namespace offnominal::desk::paper
