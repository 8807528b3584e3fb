#include "paper/experiment.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <type_traits>

#include "common/error.hpp"
#include "paper/closed_loop.hpp"
#include "robot/monitor_config_of.hpp"

namespace offnominal::tools::paper {
namespace {

[[noreturn]] void refuse(const std::string& place, const std::string& found,
                         const std::string& allowed) {
  throw InputError(
      {.file = "paper", .place = place, .found = found, .allowed = allowed, .mend = ""});
}

void check(const RobotDescription& robot, const Experiment& experiment) {
  const double period = robot.estimator.period_s;
  if (robot.joint_count() != 2) {
    refuse("robot", std::to_string(robot.joint_count()) + " joint(s)", "2, as the paper's arm has");
  }
  if (!robot.bound) refuse("robot", "no uncertainty bound", "a [bound]");
  if (!(period >= kMinPeriod && period <= kMaxPeriod)) {
    refuse("step", std::to_string(period) + " s", "1e-5 to 0.02 s");
  }
  const int hidden = robot.estimator.hidden_units;
  if (hidden < 1 || hidden > kMaxHiddenUnits) {
    refuse("hidden units", std::to_string(hidden), "1 to " + std::to_string(kMaxHiddenUnits));
  }
  if (!(experiment.duration_s >= period && experiment.duration_s <= 1e5)) {
    refuse("duration", std::to_string(experiment.duration_s) + " s", "one step to 1e5 s");
  }
  if (!(std::abs(experiment.motion_start_s) <= 1e5)) {
    refuse("start", std::to_string(experiment.motion_start_s) + " s", "-1e5 to 1e5 s");
  }
}

// Sums of squares over the window in which the paper's figures have settled.
struct WindowSums {
  double tracking = 0.0, psi = 0.0, mismatch = 0.0;
  std::int64_t ticks = 0;
};

// Gathers the numbers and, where asked for, the time series of a run.
class Observer {
 public:
  Observer(const Experiment& experiment, double alpha, double period_s)
      : experiment_(experiment),
        decay_(std::exp(-alpha * period_s)),
        input_gain_(-std::expm1(-alpha * period_s) / alpha),
        healthy_until_(experiment.fault.kind == sim::FaultKind::kNone ? experiment.duration_s
                                                                      : experiment.fault.time_s),
        window_start_(0.75 * experiment.duration_s),
        tolerance_(1e-6 * period_s) {}

  void operator()(const TickRecord& tick) {
    // W_alpha over one tick, its input taken at the tick's mean value.
    eta_ = decay_ * eta_ + input_gain_ * 0.5 * (last_psi_ + tick.psi);
    last_psi_ = tick.psi;
    judge(tick);
    if (tick.time_s >= window_start_ - tolerance_) add_to_window(tick);
    if (experiment_.record) keep(tick);
  }

  [[nodiscard]] ExperimentResult finish() {
    const auto ticks = static_cast<double>(window_.ticks);
    result_.tracking_rms_rad = std::sqrt(window_.tracking / ticks);
    if (window_.psi > 0.0) {
      result_.fault_estimate_relative_error = std::sqrt(window_.mismatch / window_.psi);
    }
    return std::move(result_);
  }

 private:
  void judge(const TickRecord& tick) {
    result_.steps = tick.tick;
    result_.max_weight_norm = std::max(result_.max_weight_norm, tick.weight_norm);
    if (tick.detected && !result_.detection_time_s) result_.detection_time_s = tick.time_s;
    if (eta_.norm() > 2.0 * tick.threshold && !result_.guaranteed_time_s) {
      result_.guaranteed_time_s = tick.time_s;
    }
    if (tick.time_s <= healthy_until_ + tolerance_) {
      double& ratio = result_.max_error_to_threshold_before_fault;
      ratio = std::max(ratio, tick.error_norm / tick.threshold);
      double& largest = result_.max_abs_psi_hat_before_fault;
      largest = std::max(largest, tick.psi_hat.lpNorm<Eigen::Infinity>());
    }
  }

  void add_to_window(const TickRecord& tick) {
    ++window_.ticks;
    window_.tracking += (tick.q_desired - tick.state.q).squaredNorm();
    window_.psi += tick.psi.squaredNorm();
    window_.mismatch += (tick.psi - tick.psi_hat).squaredNorm();
  }

  void keep(const TickRecord& tick) {
    TimeSeries& series = result_.series;
    series.time_s.push_back(tick.time_s);
    for (int i = 0; i < 2; ++i) {
      series.q[i].push_back(tick.state.q[i]);
      series.dq[i].push_back(tick.state.dq[i]);
      series.tau[i].push_back(tick.tau[i]);
      series.q_desired[i].push_back(tick.q_desired[i]);
      series.psi[i].push_back(tick.psi[i]);
      series.psi_hat[i].push_back(tick.psi_hat[i]);
    }
    series.error_norm.push_back(tick.error_norm);
    series.threshold.push_back(tick.threshold);
    series.filtered_fault.push_back(eta_.norm());
  }

  const Experiment& experiment_;
  double decay_, input_gain_, healthy_until_, window_start_, tolerance_;
  Eigen::Vector2d eta_ = Eigen::Vector2d::Zero();
  Eigen::Vector2d last_psi_ = Eigen::Vector2d::Zero();
  WindowSums window_;
  ExperimentResult result_;
};

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

sim::TwoLinkPlant plant_of(const Experiment& experiment) {
  try {
    return sim::TwoLinkPlant({}, experiment.fault, experiment.uncertainty);
  } catch (const std::invalid_argument& error) {
    throw InputError(
        {.file = "paper", .place = error.what(), .found = "", .allowed = "", .mend = ""});
  }
}

}  // namespace

sim::DesiredMotion Experiment::desired_at(double time_s) const {
  const double at_s = motion_start_s + time_s;
  return motion ? motion->at(at_s) : sim::paper_trajectory(at_s);
}

ExperimentResult run_experiment(const RobotDescription& robot, const Experiment& experiment) {
  check(robot, experiment);
  const sim::TwoLinkPlant plant = plant_of(experiment);
  const double period = robot.estimator.period_s;
  const LoopTiming timing{period, std::llround(experiment.duration_s / period),
                          experiment.plant_substeps};
  Observer observer(experiment, robot.estimator.alpha_per_s, period);
  const auto observe = [&observer](const TickRecord& tick) { observer(tick); };
  if (experiment.precision == Precision::kFloat) {
    run_with<float>(robot, experiment, plant, timing, observe);
  } else {
    run_with<double>(robot, experiment, plant, timing, observe);
  }
  ExperimentResult result = observer.finish();
  result.fault = experiment.fault.kind;
  result.accommodate = experiment.accommodate;
  result.precision = experiment.precision;
  result.seed = robot.estimator.seed;
  if (result.fault != sim::FaultKind::kNone) result.fault_time_s = experiment.fault.time_s;
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
  }
  return "unknown";
}

std::string name_of(Precision precision) {
  return precision == Precision::kFloat ? "float" : "double";
}

}  // namespace offnominal::tools::paper
