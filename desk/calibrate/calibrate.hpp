#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "calibrate/false_alarms.hpp"
#include "log/log.hpp"
#include "robot/robot.hpp"

// The uncertainty bound of a robot file from recordings of the healthy robot, judged after the
// filter (docs/theory.md, erratum 6): the smallest threshold mu = W_alpha[mu_bar] + 2 v that |e|
// stays below, widened to a stated rate of false alarms.

namespace offnominal::desk {

struct CalibrateRequest {
  double alarms_per_hour = 0.1;          // the rate to aim at, > 0
  std::optional<double> velocity_error;  // given, rad/s or m/s; none: found with the bound
  std::string source;                    // what the written bound says beside its level
  // What was left out of the recordings, in words, for where the rest is too short; empty: nothing.
  std::string left_out = {};
  // Within which a fault has to be seen, for SmallestFault; none: five time constants of the
  // filter.
  std::optional<double> fault_window_s = {};
  // A shorter one beside it, for SmallestFault::soon; none: half of it.
  std::optional<double> soon_window_s = {};
  // Of the second level, at which somebody acts: a lower rate. None: both levels are one. Of joints
  // that are judged one by one.
  std::optional<double> act_alarms_per_hour = {};
};

/// How the error and its threshold are called: |e| and mu, or those of one joint.
struct ErrorWords {
  std::string name = "|e|";
  std::string subject = "|e|";
  std::string ratio = "|e| / mu";
  std::string of_threshold = "mu";
  bool of_one_joint = false;
};
[[nodiscard]] ErrorWords words_of_joint();

// A stretch of one recording that is judged as a whole.
struct JudgedStretch {
  std::string file;
  double begin_s = 0;  // as recorded
  double end_s = 0;
  bool held_out = false;  // the new bound has not seen it
  std::int64_t samples = 0;
  std::optional<double> mean_threshold_before;  // rad/s or m/s; none: there was no bound
  double mean_threshold_after = 0;
  std::optional<double> max_ratio_before;  // of |e| / mu
  double max_ratio_after = 0;
  std::int64_t alarms_before = 0;  // stretches with |e| > mu
  std::int64_t alarms_after = 0;
  std::optional<double> first_alarm_s;  // of the new bound, as recorded

  Eigen::VectorXd t_s;
  Eigen::VectorXd error_norm;
  Eigen::VectorXd threshold_before;  // empty: there was no bound
  Eigen::VectorXd threshold_after;
};

// One shape of bound that was tried.
struct ShapeScore {
  std::string words;
  double largest_unseen_ratio = 0;  // of |e| to the tightest threshold, on parts it had not seen
  double widening = 1;              // by which the tightest bound is raised to keep the level
  double mean_threshold = 0;        // rad/s or m/s, after widening
  bool chosen = false;
};

// What the stated rate rests on.
struct FalseAlarmLevel {
  double alarms_per_hour = 0;  // aimed at
  double block_s = 0;
  std::int64_t blocks = 0;  // whose maxima the law was fitted to
  ExtremeLaw law;           // of the largest |e| / mu of a block, before widening
  double held_out_s = 0;    // counted on
  std::int64_t held_out_alarms = 0;
  double highest_per_hour = 0;  // compatible with that count at 95 % confidence
};

// One event, of a second or so in one recording, that would have decided the bound alone: the bound
// covers it, and is not widened for what it would make of the tail of the law.
struct Transient {
  std::string file;
  double time_s = 0;  // of its largest |e|, as recorded
  int joint = 0;      // from 0; that errs most then
  double error_norm = 0;
  double ratio = 0;  // of it to the tightest constant threshold of everything else
  // Mean threshold of a constant bound, had it been taken for a sample of the law like any other,
  // and as it is; rad/s or m/s.
  double mean_threshold_with = 0;
  double mean_threshold_without = 0;
};

struct Calibration {
  RobotDescription robot;  // with the new bound
  std::optional<BoundSettings> old_bound;
  std::string unit;  // of |e| and mu
  ErrorWords words;
  std::vector<ShapeScore> shapes;
  FalseAlarmLevel level;
  double act_ratio = 1;  // of the second level's threshold to this one
  std::optional<Transient> transient;
  std::vector<double> unseen_maxima;  // block maxima of |e| / tightest mu, the chosen shape's
  std::vector<JudgedStretch> stretches;
  std::vector<std::string> notes;       // what a reader of the numbers has to know
  std::vector<std::string> objections;  // why the result must not be used; empty: it may
};

/// How the new bound stands to the old one and to what the recordings reach, over all of them.
struct BoundMargin {
  std::optional<double> mean_before;  // mean threshold, rad/s or m/s; none: there was no bound
  double mean_after = 0;
  std::optional<double> new_to_old;            // of the mean thresholds
  std::optional<double> largest_ratio_before;  // of |e| / mu
  double largest_ratio_after = 0;

  /// Much wider than the old bound, or hardly felt by the recordings: worth a word.
  [[nodiscard]] bool is_much_wider() const { return new_to_old && *new_to_old > kMuchWider; }
  [[nodiscard]] bool is_remarkable() const {
    return is_much_wider() || largest_ratio_after < kHardlyReached;
  }
  static constexpr double kMuchWider = 2;
  static constexpr double kHardlyReached = 0.2;
};
[[nodiscard]] BoundMargin margin_of(const Calibration& calibration);

/// Calibrates on `logs` and counts the alarms on `holdout`. Without hold-out recordings the last of
/// several logs is held out, or the last fifth of a single one. Within the rest, whole recordings
/// (or fifths of a single one) take turns at being unseen; that chooses the shape of the bound and
/// its widening. Throws InputError where the recordings cannot be used: as recorded_error(), or too
/// short. `on_step` is called now and then.
[[nodiscard]] Calibration calibrate(const RobotDescription& robot, const CalibrateRequest& request,
                                    const std::vector<Log>& logs, const std::vector<Log>& holdout,
                                    const std::function<void()>& on_step = {});

}  // namespace offnominal::desk
