#include "tune/tune.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <offnominal/diagnosis/network.hpp>
#include <utility>

#include "common/amount.hpp"
#include "common/nearest.hpp"
#include "common/number.hpp"
#include "robot/text_lines.hpp"
#include "robot/text_with_bound.hpp"
#include "tune/choose_alpha.hpp"
#include "tune/learning_trials.hpp"

namespace offnominal::desk {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr std::array kRates = {0.25, 0.5,   1.0,   2.5,   5.0,    10.0,  25.0,
                               50.0, 100.0, 250.0, 500.0, 1000.0, 2500.0};
constexpr std::array kSizes = {8, 16, 24, 35, 48, 64};
constexpr std::array kTimesBase = {1.0, 2.5, 6.0};
constexpr std::array kRatesOfRanges = {2.5, 25.0, 250.0};
constexpr int kSizeOfRates = 35;
// In the loop, of so many units: a rate of 25 was well, 250 made frictions of a seven-joint arm
// worse (docs/diagnosis.md).
constexpr double kFastInTheLoop = 100;
// A lower rate, or a smaller network, that misses no more than this beyond the best is taken.
constexpr double kAsWellLearnt = 0.02;
// The radius that trials have is beyond any that they come to.
constexpr double kNoRadius = 1e6;
// Trials ask for this share of a joint's largest torque; a radius is to hold all of it.
constexpr double kShareOfTorque = 0.3;
constexpr double kTimesSeen = 5;

double rounded(double value) { return std::stod(significant(value, 2)); }

std::string unit_of(const RobotJoint& joint) {
  return joint.joint.type == JointType::kPrismatic ? "N" : "N m";
}

// What trials let appear on each joint: one that is seen for sure, and one of that share of its
// largest torque, or seen for sure too.
std::vector<VectorXd> trial_torques(const JointsCalibration& calibration,
                                    const std::vector<Log>& logs) {
  const auto joints = static_cast<Index>(calibration.joints.size());
  VectorXd small(joints);
  VectorXd large(joints);
  for (Index i = 0; i < joints; ++i) {
    double largest = 0;
    for (const Log& log : logs) largest = std::max(largest, log.tau.col(i).cwiseAbs().maxCoeff());
    small[i] = rounded(kTimesSeen * calibration.joints[static_cast<std::size_t>(i)].fault.usual);
    large[i] = rounded(std::max(2 * small[i], kShareOfTorque * largest));
  }
  return {small, large};
}

// The first that is as good as the best.
LearningTrial& choose(std::vector<LearningTrial>& trials) {
  double best = 1;
  for (const LearningTrial& trial : trials) best = std::min(best, trial.missed);
  for (LearningTrial& trial : trials) {
    if (!(trial.missed <= best + kAsWellLearnt)) continue;
    trial.chosen = true;
    return trial;
  }
  trials.front().chosen = true;
  return trials.front();
}

// Of which one is.
template <typename Trial>
const Trial& chosen_of(const std::vector<Trial>& trials) {
  return *std::find_if(trials.begin(), trials.end(), [](const Trial& one) { return one.chosen; });
}

// How large the initial weights are, at a few rates: the best of all of them.
double choose_range(const LearningTrials& trials, EstimatorSettings settings, Tuned& tuned) {
  const double base = trials.weight_range();
  for (const double times : kTimesBase) {
    settings.initial_weight_range = rounded(times * base);
    for (const double rate : kRatesOfRanges) {
      settings.learning_rate = rate;
      tuned.ranges.push_back(trials.run(settings));
    }
  }
  const auto best = std::min_element(
      tuned.ranges.begin(), tuned.ranges.end(),
      [](const LearningTrial& a, const LearningTrial& b) { return a.missed < b.missed; });
  best->chosen = true;
  return best->initial_weight_range;
}

// What holds a fault of all of a joint's largest torque.
double radius_for(const EstimatorSettings& settings, int joints, double weight_norm) {
  const double initial = std::sqrt(initial_squared_norm<kRuntimeJoints, kMaxHiddenUnits, double>(
      settings.seed, settings.hidden_units, settings.initial_weight_range, joints));
  const double output = std::sqrt(std::max(0.0, weight_norm * weight_norm - initial * initial));
  return rounded(1.05 * std::max(2 * initial, initial + output / kShareOfTorque));
}

void learn(const LearningTrials& trials, EstimatorSettings settings, Tuned& tuned) {
  settings.weight_radius = kNoRadius;
  tuned.before = trials.run(settings);
  const EstimatorSettings own = settings;
  settings.hidden_units = kSizeOfRates;
  settings.initial_weight_range = choose_range(trials, settings, tuned);
  for (const double rate : kRates) {
    settings.learning_rate = rate;
    tuned.rates.push_back(trials.run(settings));
  }
  const double rate = choose(tuned.rates).learning_rate;
  // The network follows as fast as the product of both says.
  for (const int size : kSizes) {
    settings.hidden_units = size;
    settings.learning_rate = rounded(rate * kSizeOfRates / size);
    tuned.sizes.push_back(trials.run(settings));
  }
  const LearningTrial& best = choose(tuned.sizes);
  tuned.before.chosen = tuned.before.missed <= best.missed + kAsWellLearnt;
  if (tuned.before.chosen) settings = own;
  const LearningTrial& taken = tuned.before.chosen ? tuned.before : best;
  settings.hidden_units = taken.hidden_units;
  settings.learning_rate = taken.learning_rate;
  settings.weight_radius = radius_for(settings, tuned.robot.joint_count(), taken.weight_norm);
  settings.isolation = true;
  tuned.robot.estimator = settings;
}

std::string reasons_of_alpha(const Tuned& tuned, const TuneRequest& request) {
  std::string others;
  for (const AlphaTrial& trial : tuned.alphas) {
    if (trial.chosen || !trial.why_none.empty()) continue;
    others += fmt::format("{}{:g}: {}", others.empty() ? "" : ", ", trial.alpha_per_s,
                          significant(trial.mean, 3));
  }
  return fmt::format(
      "sees lasting torques from {} {} on within {:g} s, geometric mean of the joints; {}",
      significant(chosen_of(tuned.alphas).mean, 3), tuned.units.front(), request.within_s,
      others.empty() ? "no other could be tried" : others);
}

// Nothing where one filter does.
const AlphaTrial* fast_of(const std::vector<AlphaTrial>& trials) {
  const auto found = std::find_if(trials.begin(), trials.end(),
                                  [](const AlphaTrial& trial) { return trial.chosen_fast; });
  return found == trials.end() ? nullptr : &*found;
}

std::string reasons_of_fast(const AlphaTrial& fast, const Tuned& tuned,
                            const TuneRequest& request) {
  return fmt::format(
      "a second filter: within {:g} s it sees lasting torques from {} {} on, geometric mean of the "
      "joints, the other one from {}",
      kSoonShare * request.within_s, significant(fast.mean_soon, 3), tuned.units.front(),
      significant(chosen_of(tuned.alphas).mean_soon, 3));
}

std::vector<EstimatorLine> lines_of(const Tuned& tuned, const TuneRequest& request) {
  const EstimatorSettings& settings = tuned.robot.estimator;
  const auto missed = [](const LearningTrial& trial) {
    return fmt::format("{:.0f} %", 100 * trial.missed);
  };
  const LearningTrial& range = chosen_of(tuned.ranges);
  const LearningTrial& rate = chosen_of(tuned.rates);
  const LearningTrial& size = chosen_of(tuned.sizes);
  const LearningTrial& taken = tuned.before.chosen ? tuned.before : size;
  const std::string kept = fmt::format("as it was: it misses {}, the best that was tried {}",
                                       missed(tuned.before), missed(size));
  const auto reason = [&](const std::string& words) { return tuned.before.chosen ? kept : words; };
  std::vector<EstimatorLine> lines;
  lines.push_back({"space", "\"torque\"", "joint by joint"});
  lines.push_back({"isolation", "true",
                   "the controller says which fault it is, and compensates only for what that is "
                   "right for"});
  lines.push_back({"alpha_per_s", shortest_real(settings.alpha), reasons_of_alpha(tuned, request)});
  if (const AlphaTrial* fast = fast_of(tuned.alphas)) {
    lines.push_back({"fast_alpha_per_s", shortest_real(settings.fast_alpha),
                     reasons_of_fast(*fast, tuned, request)});
  } else if (settings.fast_alpha > 0) {
    lines.push_back({"fast_alpha_per_s", shortest_real(settings.fast_alpha),
                     "no pole sees faults sooner by a fifth, and the file has a second filter: its "
                     "own pole, or "
                     "twice alpha_per_s; leave it out, and one filter does"});
  }
  lines.push_back(
      {"hidden_units", std::to_string(settings.hidden_units),
       reason(fmt::format("misses {} of a torque that it has to learn; {}", missed(size),
                          list_of(tuned.sizes, [&](const LearningTrial& trial) {
                            return fmt::format("{}: {}", trial.hidden_units, missed(trial));
                          })))});
  lines.push_back({"learning_rate", shortest_real(settings.learning_rate),
                   reason(fmt::format("as {:g} for {} units, which miss {}; {}", rate.learning_rate,
                                      rate.hidden_units, missed(rate),
                                      list_of(tuned.rates, [&](const LearningTrial& trial) {
                                        return fmt::format("{:g}: {}", trial.learning_rate,
                                                           missed(trial));
                                      })))});
  lines.push_back({"weight_radius", shortest_real(settings.weight_radius),
                   fmt::format("trials with {:.0f} % of each joint's largest torque came to {}; "
                               "this holds all of it",
                               100 * kShareOfTorque, significant(taken.weight_norm, 3))});
  lines.push_back(
      {"initial_weight_range", shortest_real(settings.initial_weight_range),
       reason(fmt::format("missed {} at the rate {:g}, the least of {}", missed(range),
                          range.learning_rate, counted(tuned.ranges.size(), "trial")))});
  return lines;
}

// A filter that the file has is not taken away.
double fast_alpha_of(const RobotDescription& given, const Tuned& tuned) {
  if (const AlphaTrial* fast = fast_of(tuned.alphas)) return fast->alpha_per_s;
  const double own = given.estimator.fast_alpha;
  return own > 0 ? std::max(own, kFaster * tuned.robot.estimator.alpha) : 0;
}

// The file's own text with the new lines and without its bound, where it can be cut; otherwise the
// comments are lost.
void write_into_text(const RobotDescription& given, Tuned& tuned) {
  if (given.file_text == nullptr) return;
  RobotDescription unbound = given;
  unbound.bound.reset();
  auto text = text_with_bound(without_returns(*given.file_text), unbound);
  if (text) text = text_with_estimator(*text, tuned.lines);
  if (!text) return;
  if (has_returns(*given.file_text)) text = with_returns(*text);
  tuned.robot.file_text = std::make_shared<const std::string>(std::move(*text));
}

}  // namespace

Tuned tune(const RobotDescription& given, const TuneRequest& request, const std::vector<Log>& logs,
           const std::vector<Log>& holdout, const std::function<void()>& on_step) {
  RobotDescription robot = given;
  robot.estimator.space = EstimatorSpace::kTorque;
  if (given.bound && given.estimator.space != EstimatorSpace::kTorque) robot.bound.reset();
  Tuned tuned;
  for (const RobotJoint& joint : robot.joints) tuned.units.push_back(unit_of(joint));
  AlphaChoice choice = choose_alpha(robot, request, logs, holdout, on_step);
  tuned.alphas = std::move(choice.trials);
  tuned.objections = choice.calibration.objections;
  tuned.robot = robot;
  RobotDescription bounded = choice.calibration.robot;
  const std::vector<VectorXd> torques = trial_torques(choice.calibration, logs);
  for (const VectorXd& of_joints : torques) {
    tuned.trial_torques.emplace_back(of_joints.begin(), of_joints.end());
  }
  const LearningTrials trials(bounded, logs, torques, on_step);
  tuned.trial_s = trials.seconds();
  learn(trials, bounded.estimator, tuned);
  tuned.robot.estimator.fast_alpha = fast_alpha_of(given, tuned);
  tuned.robot.bound.reset();
  tuned.lines = lines_of(tuned, request);
  if (given.bound) {
    tuned.notes.emplace_back(
        "The robot file's bound belonged to its old settings and is taken out: `offnominal "
        "calibrate` finds the new one.");
  }
  const EstimatorSettings& settings = tuned.robot.estimator;
  const double like_35_units = settings.learning_rate * settings.hidden_units / kSizeOfRates;
  if (like_35_units >= kFastInTheLoop) {
    tuned.notes.push_back(fmt::format(
        "The rate {:g} is for what is reported. Where the controller compensates (--accommodate) "
        "by "
        "so fast a network an arm may oscillate, and friction of some was made worse: try it in a "
        "campaign with accommodates = true first, or take a hundredth of it.",
        settings.learning_rate));
  }
  write_into_text(given, tuned);
  return tuned;
}

}  // namespace offnominal::desk
