#include "paper/experiment.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <type_traits>

#include "common/error.hpp"
#include "common/number.hpp"
#include "paper/closed_loop.hpp"
#include "paper/run_observer.hpp"
#include "robot/monitor_config_of.hpp"
#include "robot/robot_file.hpp"

namespace offnominal::desk::paper {
namespace {

template <typename Scalar>
void run_with(const RobotDescription& robot, const Experiment& experiment,
              const sim::TwoLinkPlant& plant, const LoopTiming& timing,
              const TickObserver& observe) {
  ControllerSetup<Scalar> setup{monitor_config_of<2, Scalar>(robot), gains_of<2, Scalar>(robot)};
  if (!experiment.accommodate) setup.monitor.max_compensation = {};
  with_capacity(robot.estimator.hidden_units, [&](auto capacity) {
    run_closed_loop<capacity(), Scalar>(
        setup, plant, timing, [&](double time_s) { return experiment.desired_at(time_s); },
        observe);
  });
}

}  // namespace

sim::DesiredMotion Experiment::desired_at(double time_s) const {
  const double at_s = motion_start_s + time_s;
  return motion ? motion->at(at_s) : sim::paper_trajectory(at_s);
}

namespace {

[[noreturn]] void refuse(const std::string& verb, const std::string& place,
                         const std::string& found, const std::string& allowed) {
  throw InputError({.file = "offnominal " + verb,
                    .place = place,
                    .found = found,
                    .allowed = allowed,
                    .mend = ""});
}

}  // namespace

void check_run(const RobotDescription& robot, const RunSettings& settings,
               const std::string& verb) {
  const double period = robot.estimator.period_s;
  require_bound(robot, "robot " + robot.name);
  if (!(period >= kMinPeriod && period <= kMaxPeriod)) {
    refuse(verb, "step", shortest(period) + " s", "1e-5 to 0.02 s");
  }
  const int hidden = robot.estimator.hidden_units;
  if (hidden < 1 || hidden > kMaxHiddenUnits) {
    refuse(verb, "hidden units", std::to_string(hidden), "1 to " + std::to_string(kMaxHiddenUnits));
  }
  if (!(settings.duration_s >= period && settings.duration_s <= kLongestRunS)) {
    refuse(verb, "--duration", shortest(settings.duration_s) + " s",
           "one step to " + shortest(kLongestRunS) + " s");
  }
}

void require_acceleration_space(const RobotDescription& robot, const std::string& file) {
  if (robot.estimator.space == EstimatorSpace::kAcceleration) return;
  throw InputError({.file = file,
                    .place = "estimator.space",
                    .found = "\"torque\"",
                    .allowed = "\"acceleration\": the paper's experiment has the paper's monitor",
                    .mend = "`offnominal sil` runs the same arm and faults joint by joint"});
}

void check_experiment(const RobotDescription& robot, const Experiment& experiment,
                      const std::string& verb) {
  require_acceleration_space(robot, "robot " + robot.name);
  if (robot.joint_count() != 2) {
    refuse(verb, "--robot", std::to_string(robot.joint_count()) + " joint(s)",
           "2, as the paper's arm has");
  }
  check_run(robot, experiment, verb);
  if (experiment.fault.kind != sim::FaultKind::kNone &&
      !(experiment.fault.time_s < experiment.duration_s)) {
    refuse(verb, "--duration", shortest(experiment.duration_s) + " s",
           "more than " + shortest(experiment.fault.time_s) + " s, when the fault begins");
  }
  if (!(std::abs(experiment.motion_start_s) <= 1e5)) {
    refuse(verb, "--start", shortest(experiment.motion_start_s) + " s", "-1e5 to 1e5 s");
  }
}

sim::TwoLinkPlant plant_of(const Experiment& experiment) {
  try {
    return sim::TwoLinkPlant({}, experiment.fault, experiment.uncertainty);
  } catch (const std::invalid_argument& error) {
    throw InputError(
        {.file = "arm", .place = error.what(), .found = "", .allowed = "", .mend = ""});
  }
}

ExperimentResult run_experiment(const RobotDescription& robot, const Experiment& experiment) {
  check_experiment(robot, experiment, "paper");
  const sim::TwoLinkPlant plant = plant_of(experiment);
  const double period = robot.estimator.period_s;
  const LoopTiming timing{period, std::llround(experiment.duration_s / period),
                          experiment.plant_substeps};
  const bool healthy = experiment.fault.kind == sim::FaultKind::kNone;
  RunObserver observer(robot, experiment,
                       healthy ? experiment.duration_s : experiment.fault.time_s);
  const auto observe = [&observer](const TickRecord& tick) { observer(tick); };
  if (experiment.precision == Precision::kFloat) {
    run_with<float>(robot, experiment, plant, timing, observe);
  } else {
    run_with<double>(robot, experiment, plant, timing, observe);
  }
  ExperimentResult result = observer.finish();
  result.fault = experiment.fault.kind;
  if (!healthy) result.fault_time_s = experiment.fault.time_s;
  return result;
}

std::string name_of(sim::FaultKind fault) {
  switch (fault) {
    case sim::FaultKind::kNone:
      return "none";
    case sim::FaultKind::kMassLoss:
      return "mass_loss";
    case sim::FaultKind::kNonlinear:
      return "nonlinear";
    case sim::FaultKind::kPayload:
      return "payload";
  }
  return "unknown";
}

}  // namespace offnominal::desk::paper
