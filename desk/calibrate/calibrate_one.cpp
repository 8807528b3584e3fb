#include "calibrate/calibrate_one.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/amount.hpp"
#include "common/error.hpp"
#include "common/number.hpp"

namespace offnominal::desk {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

// Blocks long enough for the filter to have forgotten the one before, and a second at least.
constexpr double kBlockTimeConstants = 10;
constexpr double kShortestBlock = 1;  // s
// An unseen part whose |e| is so much above what all the others ask for is not like them.
constexpr double kStrayRatio = 2.5;
constexpr double kUnlikely = 0.01;

void check_data(const CalibrationData& data, const std::string& left_out) {
  std::int64_t blocks = 0;
  double largest = 0;
  double longest_s = 0;
  for (const SampleRange& fold : data.split.folds) {
    const RecordedError& recording = data.recordings[fold.recording];
    blocks += (fold.end - fold.begin) / data.block_samples(recording);
    longest_s =
        std::max(longest_s, recording.period_s * static_cast<double>(fold.end - fold.begin));
    // Of no sample 0: a fifth of a few samples has none.
    largest = std::max(
        largest,
        recording.error_norm.segment(fold.begin, fold.end - fold.begin).lpNorm<Eigen::Infinity>());
  }
  if (blocks < kFewestBlocks) {
    const bool fifths = !data.split.always.empty();
    throw InputError(
        {.file = data.recordings.front().file,
         .place = "length of the recordings",
         .found =
             fmt::format("{} of {:g} s to calibrate on, in {} of {:.3g} s at most{}",
                         counted(static_cast<std::size_t>(blocks), "whole block"), data.block_s,
                         fifths ? "fifths of one stretch"
                                : counted(data.split.folds.size(), "stretch", "stretches"),
                         longest_s, left_out.empty() ? "" : "; " + left_out),
         .allowed = fmt::format("at least {}", kFewestBlocks),
         .mend = left_out.empty() ? "take longer recordings, or more of them"
                                  : "take longer recordings, or more of them, or say with --keep "
                                    "JOINT:REASON what is no fault"});
  }
  if (largest > 0) return;
  if (data.joint) {
    throw InputError(
        {.file = data.recordings.front().file,
         .place = fmt::format("joint {}", *data.joint + 1),
         .found = "no residual at all: it did not move, or has no torque, in these recordings",
         .allowed = "recordings in which every joint of the robot moves and is driven",
         .mend = "move it in them, or take it out of the robot file; check too that the recordings "
                 "are not the model's own output"});
  }
  throw InputError({.file = data.recordings.front().file,
                    .place = "|e|",
                    .found = "no error at all",
                    .allowed = "recordings of a machine",
                    .mend = "check that the recordings are not the model's own output"});
}

std::int64_t alarms_in(const VectorXd& error, const VectorXd& threshold) {
  std::int64_t alarms = 0;
  bool above = false;
  for (Index i = 0; i < error.size(); ++i) {
    const bool now = error[i] > threshold[i];
    alarms += now && !above ? 1 : 0;
    above = now;
  }
  return alarms;
}

double largest_ratio(const VectorXd& error, const VectorXd& threshold) {
  double largest = 0;
  for (Index i = 0; i < error.size(); ++i) {
    if (error[i] > 0) largest = std::max(largest, error[i] / threshold[i]);
  }
  return largest;
}

JudgedStretch judged_stretch(const RecordedError& recording, const VectorXd& threshold, Index begin,
                             Index end, bool held_out) {
  JudgedStretch judged;
  judged.file = recording.file;
  judged.held_out = held_out;
  judged.samples = end - begin;
  judged.t_s = recording.t_s.segment(begin, end - begin);
  judged.begin_s = judged.t_s[0];
  judged.end_s = judged.t_s[judged.t_s.size() - 1];
  judged.error_norm = recording.error_norm.segment(begin, end - begin);
  judged.threshold_after = threshold.segment(begin, end - begin);
  judged.mean_threshold_after = judged.threshold_after.mean();
  judged.max_ratio_after = largest_ratio(judged.error_norm, judged.threshold_after);
  judged.alarms_after = alarms_in(judged.error_norm, judged.threshold_after);
  for (Index i = 0; i < judged.t_s.size() && !judged.first_alarm_s; ++i) {
    if (judged.error_norm[i] > judged.threshold_after[i]) judged.first_alarm_s = judged.t_s[i];
  }
  if (recording.old_threshold.size() == 0) return judged;
  judged.threshold_before = recording.old_threshold.segment(begin, end - begin);
  judged.mean_threshold_before = judged.threshold_before.mean();
  judged.max_ratio_before = largest_ratio(judged.error_norm, judged.threshold_before);
  judged.alarms_before = alarms_in(judged.error_norm, judged.threshold_before);
  return judged;
}

// Neighbouring folds of one recording are shown as one stretch.
std::vector<SampleRange> joined_stretches(const std::vector<SampleRange>& folds) {
  std::vector<SampleRange> whole;
  for (const SampleRange& fold : folds) {
    const bool continues = !whole.empty() && whole.back().recording == fold.recording;
    if (continues) {
      whole.back().end = fold.end;
    } else {
      whole.push_back(fold);
    }
  }
  return whole;
}

void judge_all(const CalibrationData& data, const std::vector<VectorXd>& thresholds,
               Calibration& result) {
  const auto add = [&](const std::vector<SampleRange>& stretches, bool held_out) {
    for (const SampleRange& stretch : stretches) {
      result.stretches.push_back(judged_stretch(data.recordings[stretch.recording],
                                                thresholds[stretch.recording], stretch.begin,
                                                stretch.end, held_out));
    }
  };
  std::vector<SampleRange> calibrated = data.split.always;
  calibrated.insert(calibrated.end(), data.split.folds.begin(), data.split.folds.end());
  add(joined_stretches(calibrated), false);
  add(data.split.held_out, true);
}

void count_held_out(const CalibrationData& data, Calibration& result) {
  FalseAlarmLevel& level = result.level;
  std::string where;
  for (const JudgedStretch& stretch : result.stretches) {
    if (!stretch.held_out) continue;
    level.held_out_s += stretch.end_s - stretch.begin_s;
    level.held_out_alarms += stretch.alarms_after;
    if (!stretch.first_alarm_s) continue;
    where += fmt::format("{}{} from {:.3f} s on, {} up to {:.3g} {}", where.empty() ? "" : "; ",
                         stretch.file, *stretch.first_alarm_s, result.words.subject,
                         stretch.max_ratio_after, result.words.of_threshold);
  }
  level.highest_per_hour = 3600 * highest_rate(level.held_out_alarms, level.held_out_s);
  const double expected = level.alarms_per_hour / 3600 * level.held_out_s;
  if (probability_of_as_many(level.held_out_alarms, expected) >=
      kUnlikely / static_cast<double>(data.judged)) {
    return;
  }
  result.objections.push_back(fmt::format(
      "{} in {:g} s of hold-out data, where {:.2g} were expected ({}): the bound does not "
      "keep its level. Calibrate on more recordings, of all the motions that the robot makes.",
      counted(static_cast<std::size_t>(level.held_out_alarms), "alarm"), level.held_out_s, expected,
      where));
}

// Of all joints' errors, which has most of it; of one joint's there is nothing to say.
std::string most_on(const Calibration& result, int joint) {
  return result.words.of_one_joint ? "" : fmt::format(", most of it on joint {}", joint + 1);
}

void object_to_stray(const std::string& file, double time_s, int joint, double ratio,
                     Calibration& result) {
  if (ratio <= kStrayRatio) return;
  result.objections.push_back(fmt::format(
      "{}: at {:.3f} s {} is {} times the largest that all other parts ask for{}. A fault there, "
      "or "
      "a motion that no other part has: leave the recording out, or add recordings like it.",
      file, time_s, result.words.subject, significant(ratio, 2), most_on(result, joint)));
}

void look_for_strays(const CalibrationData& data, const Tried& constant, Calibration& result) {
  if (result.transient) {
    const Transient& one = *result.transient;
    object_to_stray(one.file, one.time_s, one.joint, one.ratio, result);
  }
  for (std::size_t i = 0; i < data.split.folds.size(); ++i) {
    const SampleRange& fold = data.split.folds[i];
    const RecordedError& recording = data.recordings[fold.recording];
    Index at = 0;
    const double ratio = constant.fit.unseen_ratio[i].maxCoeff(&at);
    at += fold.begin;
    object_to_stray(recording.file, recording.t_s[at], recording.loudest_joint[at], ratio, result);
  }
}

void note_transient(Calibration& result) {
  if (!result.transient || result.transient->ratio > kStrayRatio) return;
  const Transient& one = *result.transient;
  result.notes.push_back(fmt::format(
      "{}: one transient at {:.3f} s{}: {} is {} {}, {:.2g} times the "
      "largest that all other parts ask for. The bound covers it with 5 % to spare and is not "
      "widened beyond for "
      "it: one event says nothing of how large the next one is. Taken for one of many it would "
      "have made a constant bound {:.3g} times as wide. Record more starts and stops if the robot "
      "has them.",
      one.file, one.time_s, most_on(result, one.joint), result.words.subject,
      significant(one.error_norm, 3), result.unit, one.ratio,
      one.mean_threshold_with / one.mean_threshold_without));
}

// A bound that grew, or that nothing comes near: what made it so.
void note_width(const Tried& chosen, Calibration& result) {
  const BoundMargin margin = margin_of(result);
  if (!margin.is_remarkable()) return;
  std::string words =
      margin.is_much_wider()
          ? fmt::format("The new bound is {:.3g} times as wide as the old one", *margin.new_to_old)
          : std::string("The new bound is hardly felt");
  words += fmt::format(": the recordings reach {} of {:.3g} at most", result.words.ratio,
                       margin.largest_ratio_after);
  if (margin.largest_ratio_before) {
    words += fmt::format(" ({:.3g} with the old bound)", *margin.largest_ratio_before);
  }
  result.notes.push_back(
      words +
      fmt::format(". The tightest bound that covers them has a mean threshold of {} {}, and it "
                  "is widened {:.3g} times: their largest unseen {} asks for {:.3g}, the rest is "
                  "extrapolation of {} block maxima to {:g} false alarms per hour. Longer and "
                  "more recordings make that less.",
                  significant(chosen.fit.mean_threshold, 3), result.unit, chosen.widening,
                  result.words.name, std::max({1.0, chosen.largest, chosen.fit.apart_ratio}),
                  chosen.maxima.size(), result.level.alarms_per_hour));
}

void note_old_alarms(Calibration& result) {
  for (const JudgedStretch& stretch : result.stretches) {
    if (stretch.alarms_before == 0) continue;
    result.notes.push_back(fmt::format(
        "{}: the old bound raises {} in it. If that was a fault, the new bound hides it.",
        stretch.file, counted(static_cast<std::size_t>(stretch.alarms_before), "alarm")));
  }
}

std::string source_of(const CalibrateRequest& request, const FalseAlarmLevel& level) {
  return fmt::format(
      "{} {:g} false alarms per hour by extrapolation of {} block maxima of {:g} s; on hold-out "
      "data {} in {:g} s.",
      request.source, level.alarms_per_hour, level.blocks, level.block_s,
      counted(static_cast<std::size_t>(level.held_out_alarms), "alarm"), level.held_out_s);
}

}  // namespace

void note_what_matters(const RobotDescription& robot, std::size_t recordings,
                       std::vector<std::string>& notes) {
  for (const RobotEffect& effect : robot.effects) {
    if (!info_of(effect.kind)->is_periodic_in_time()) continue;
    notes.emplace_back(
        "The model knows a disturbance that is periodic in time: the bound holds where the monitor "
        "starts in the same phase of it as these recordings do.");
    break;
  }
  if (recordings == 1) {
    notes.emplace_back(
        "One recording only: starts of a run, and motions, that differ from it have not been "
        "seen.");
  }
}

bool have_velocities(const std::vector<Log>& logs, const std::vector<Log>& holdout) {
  const auto lacks_one = [](const Log& log) {
    return std::find(log.dq_derived.begin(), log.dq_derived.end(), true) != log.dq_derived.end();
  };
  return std::none_of(logs.begin(), logs.end(), lacks_one) &&
         std::none_of(holdout.begin(), holdout.end(), lacks_one);
}

CalibrationData data_of(std::vector<RecordedError> recordings, std::size_t given,
                        std::optional<int> joint, std::size_t judged, const std::string& left_out) {
  CalibrationData data;
  data.recordings = std::move(recordings);
  data.block_s =
      std::max(kShortestBlock, kBlockTimeConstants / data.recordings.front().alpha_per_s);
  data.joint = joint;
  data.judged = judged;
  data.split = split(data.recordings, given, 0.5 * data.block_s);
  check_data(data, left_out);
  return data;
}

Fitted fitted(const RobotDescription& robot, const CalibrateRequest& request,
              const CalibrationData& data, const std::function<void()>& on_step) {
  Fitted fit{try_shapes(robot, data, request, on_step), 0, {}};
  const std::vector<Tried>& tried = fit.tries.shapes;
  fit.chosen = choice_among(tried);
  const Tried& best = tried[fit.chosen];
  Calibration& result = fit.result;
  result.unit = data.recordings.front().unit;
  if (data.joint) result.words = words_of_joint();
  result.old_bound = robot.bound;
  for (std::size_t i = 0; i < tried.size(); ++i) {
    result.shapes.push_back({tried[i].shape.words, tried[i].largest, tried[i].widening,
                             tried[i].mean_threshold, i == fit.chosen});
  }
  result.transient = fit.tries.transient;
  result.act_ratio = best.act_ratio;
  result.unseen_maxima = best.maxima;
  result.level.alarms_per_hour = request.alarms_per_hour;
  result.level.block_s = data.block_s;
  result.level.blocks = static_cast<std::int64_t>(best.maxima.size());
  result.level.law = best.law;
  result.robot = robot;
  result.robot.bound = best.fit.widened(best.shape, best.widening, request.velocity_error);
  return fit;
}

Calibration judged_calibration(Fitted fit, const CalibrateRequest& request,
                               const CalibrationData& data,
                               const std::vector<Eigen::VectorXd>& thresholds) {
  Calibration& result = fit.result;
  judge_all(data, thresholds, result);
  count_held_out(data, result);
  look_for_strays(data, fit.tries.shapes.front(), result);
  note_transient(result);
  note_width(fit.tries.shapes[fit.chosen], result);
  note_old_alarms(result);
  result.robot.bound->source = source_of(request, result.level);
  return std::move(result);
}

}  // namespace offnominal::desk
