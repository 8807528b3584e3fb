#pragma once

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "log/log.hpp"
#include "robot/robot.hpp"
#include "robot/text_with_estimator.hpp"

// The settings of the on-board estimator, joint by joint (EstimatorSpace::kTorque), from fault-free
// recordings: each is what trials with these recordings say, never a rule of thumb.

namespace offnominal::desk {

struct TuneRequest {
  double within_s = 0.2;         // how soon a fault has to be seen, > 0
  double alarms_per_hour = 0.1;  // that the thresholds of the trials are calibrated to, > 0
};

/// One pole of the filter, with the bounds that calibrate() finds for it.
struct AlphaTrial {
  double alpha_per_s = 0;
  // Per joint, N m or N: the smallest lasting torque beside the model that is seen within within_s
  // in 95 of 100 beginnings, whichever its sign.
  std::vector<double> seen_from;
  double mean = 0;       // their geometric mean, by which poles are compared
  double mean_soon = 0;  // the same within a quarter of within_s, by which fast ones are
  std::string why_none;  // why it could not be tried; empty: it was
  bool chosen = false;
  bool chosen_fast = false;  // for the second filter
};

/// What a second filter is judged by, of within_s.
inline constexpr double kSoonShare = 0.25;

/// One setting of the network, on torques that appear in the recordings, joint after joint.
struct LearningTrial {
  double learning_rate = 0;
  int hidden_units = 0;
  double initial_weight_range = 0;
  // What psi_hat misses of the torque from a second after it appeared, rms over rms, mean over the
  // trials; 1: nothing is learnt.
  double missed = 1;
  double weight_norm = 0;  // the largest
  bool chosen = false;
};

struct Tuned {
  RobotDescription robot;  // with the new settings and without a bound, which calibrate finds anew
  std::vector<std::string> units;  // of each joint's torque
  std::vector<AlphaTrial> alphas;
  std::vector<std::vector<double>> trial_torques;  // small and large, per joint, N m or N
  double trial_s = 0;                              // of recording that each trial runs over
  std::vector<LearningTrial> ranges;               // of the initial weights, at a few rates
  std::vector<LearningTrial> rates;
  std::vector<LearningTrial> sizes;
  LearningTrial before;              // as the robot file has it, at the new pole; chosen: kept
  std::vector<EstimatorLine> lines;  // of [estimator], each with its reason
  std::vector<std::string> notes;
  std::vector<std::string> objections;  // why the result must not be used; empty: it may
};

/// Throws InputError where the recordings are too short for any pole, or as calibrate_joints().
[[nodiscard]] Tuned tune(const RobotDescription& robot, const TuneRequest& request,
                         const std::vector<Log>& logs, const std::vector<Log>& holdout,
                         const std::function<void()>& on_step = {});

[[nodiscard]] std::string text_of(const Tuned& tuned, const TuneRequest& request);
[[nodiscard]] nlohmann::ordered_json to_json(const Tuned& tuned, const TuneRequest& request);

}  // namespace offnominal::desk
