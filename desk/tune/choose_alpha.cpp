#include "tune/choose_alpha.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "common/error.hpp"

namespace offnominal::desk {
namespace {

constexpr std::array kPoles = {2.0, 5.0, 10.0, 20.0, 30.0, 50.0, 80.0, 120.0};  // 1/s
// Of a pole times the tick: beyond it a tick is no small part of the filter's time constant.
constexpr double kMostPerTick = 0.3;
// A slower pole that is so nearly as good is taken: its residual is the calmer one.
constexpr double kAsGoodAPole = 1.2;

double longest_tick_s(const RobotDescription& robot, const std::vector<Log>& logs) {
  double longest = robot.estimator.period_s;
  for (const Log& log : logs) longest = std::max(longest, log.period_s);
  return longest;
}

double geometric_mean(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += std::log(value);
  return std::exp(sum / static_cast<double>(values.size()));
}

// Of the poles that were tried, the slowest that sees soon what the best of them does.
void choose_fast(const AlphaTrial& slow, std::vector<AlphaTrial>& trials) {
  const auto is_faster = [&](const AlphaTrial& trial) {
    // In less than a tick no filter sees anything.
    return trial.why_none.empty() && trial.alpha_per_s >= kFaster * slow.alpha_per_s &&
           std::isfinite(trial.mean_soon);
  };
  double best = slow.mean_soon / kAsGoodAPole;
  for (const AlphaTrial& trial : trials) {
    if (is_faster(trial)) best = std::min(best, trial.mean_soon);
  }
  for (AlphaTrial& trial : trials) {
    const bool is_worth_it = kAsGoodAPole * trial.mean_soon <= slow.mean_soon;
    if (!is_faster(trial) || !is_worth_it || trial.mean_soon > kAsGoodAPole * best) continue;
    trial.chosen_fast = true;
    return;
  }
}

}  // namespace

AlphaChoice choose_alpha(const RobotDescription& robot, const TuneRequest& request,
                         const std::vector<Log>& logs, const std::vector<Log>& holdout,
                         const std::function<void()>& on_step) {
  const double tick_s = longest_tick_s(robot, logs);
  CalibrateRequest calibration;
  calibration.alarms_per_hour = request.alarms_per_hour;
  calibration.fault_window_s = request.within_s;
  calibration.soon_window_s = kSoonShare * request.within_s;
  AlphaChoice choice;
  std::optional<InputError> refusal;
  double best = std::numeric_limits<double>::infinity();
  std::vector<std::optional<JointsCalibration>> calibrations;
  for (const double alpha : kPoles) {
    AlphaTrial& trial = choice.trials.emplace_back();
    calibrations.emplace_back();
    trial.alpha_per_s = alpha;
    if (alpha * tick_s > kMostPerTick) {
      trial.why_none = fmt::format("too fast for a tick of {:g} s", tick_s);
      continue;
    }
    RobotDescription tried = robot;
    tried.estimator.alpha = alpha;
    tried.estimator.fast_alpha = 0;
    if (tried.bound) tried.bound->fast.clear();
    try {
      calibrations.back() = calibrate_joints(tried, calibration, logs, holdout, on_step);
    } catch (const InputError& error) {
      refusal = error;
      trial.why_none = error.what();
      continue;
    }
    std::vector<double> soon;
    for (const JointCalibration& joint : calibrations.back()->joints) {
      trial.seen_from.push_back(joint.fault.usual);
      soon.push_back(joint.fault.soon);
    }
    trial.mean = geometric_mean(trial.seen_from);
    trial.mean_soon = geometric_mean(soon);
    best = std::min(best, trial.mean);
  }
  for (std::size_t i = 0; i < choice.trials.size(); ++i) {
    AlphaTrial& trial = choice.trials[i];
    if (!trial.why_none.empty() || trial.mean > kAsGoodAPole * best) continue;
    trial.chosen = true;
    choose_fast(AlphaTrial(trial), choice.trials);
    choice.calibration = std::move(*calibrations[i]);
    return choice;
  }
  if (refusal) throw InputError(*refusal);
  throw InputError({.file = logs.front().file,
                    .place = "time between two samples",
                    .found = fmt::format("{:g} s, or a tick of {:g} s in the robot file",
                                         logs.front().period_s, robot.estimator.period_s),
                    .allowed = fmt::format("at most {:g} s", kMostPerTick / kPoles.front()),
                    .mend = "record faster: a monitor that looks so rarely sees nothing in time"});
}

}  // namespace offnominal::desk
