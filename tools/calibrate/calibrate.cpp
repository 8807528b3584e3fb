#include "calibrate/calibrate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "calibrate/recorded_error.hpp"
#include "calibrate/shape_fit.hpp"
#include "calibrate/split.hpp"
#include "common/error.hpp"
#include "common/number.hpp"

namespace offnominal::tools {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

// Blocks long enough for the filter to have forgotten the one before, and a second at least.
constexpr double kBlockTimeConstants = 10;
constexpr double kShortestBlock = 1;  // s
// A simpler kind is kept unless another one's threshold is lower by this share: numbers beyond what
// the machine's physics asks for fit the recordings and not the next motion.
constexpr double kWorthwhile = 0.15;
// No c_k falls below this share of the constant bound: where the recordings say little, a table
// would otherwise fall to nothing.
constexpr double kLowestShare = 0.1;
// An unseen part whose |e| is so much above what all the others ask for is not like them.
constexpr double kStrayRatio = 2.5;
constexpr double kUnlikely = 0.01;

struct Data {
  std::vector<RecordedError> recordings;
  Split split;
  double block_s = 0;

  [[nodiscard]] std::int64_t block_samples(const RecordedError& recording) const {
    return std::max<std::int64_t>(1, std::llround(block_s / recording.period_s));
  }
};

Data data_of(const RobotDescription& robot, const std::vector<Log>& logs,
             const std::vector<Log>& holdout) {
  Data data;
  for (const auto* group : {&logs, &holdout}) {
    for (const Log& log : *group) data.recordings.push_back(recorded_error(robot, log));
  }
  data.block_s = std::max(kShortestBlock, kBlockTimeConstants / robot.estimator.alpha_per_s);
  data.split = split(data.recordings, logs.size(), 0.5 * data.block_s);
  std::int64_t blocks = 0;
  double largest = 0;
  for (const Stretch& fold : data.split.folds) {
    const RecordedError& recording = data.recordings[fold.recording];
    blocks += (fold.end - fold.begin) / data.block_samples(recording);
    largest = std::max(largest,
                       recording.error_norm.segment(fold.begin, fold.end - fold.begin).maxCoeff());
  }
  if (blocks < kFewestBlocks) {
    throw InputError(
        {.file = data.recordings.front().file,
         .place = "length of the recordings",
         .found = fmt::format("{} block(s) of {:g} s to calibrate on", blocks, data.block_s),
         .allowed = fmt::format("at least {}", kFewestBlocks),
         .mend = "take longer recordings, or more of them"});
  }
  if (!(largest > 0)) {
    throw InputError({.file = data.recordings.front().file,
                      .place = "|e|",
                      .found = "no error at all",
                      .allowed = "recordings of a machine",
                      .mend = "check that the recordings are not the model's own output"});
  }
  return data;
}

struct Tried {
  BoundShape shape;
  ShapeFit fit;
  std::vector<double> maxima;  // of the unseen ratio, per block
  ExtremeLaw law;
  double largest = 0;
  double widening = 1;
  double mean_threshold = 0;
};

Tried judged(const BoundShape& shape, ShapeFit fit, const Data& data,
             const CalibrateRequest& request) {
  Tried tried{shape, std::move(fit), {}, {}, 0, 1, 0};
  for (std::size_t i = 0; i < data.split.folds.size(); ++i) {
    const RecordedError& recording = data.recordings[data.split.folds[i].recording];
    const auto maxima = block_maxima(tried.fit.unseen_ratio[i], data.block_samples(recording));
    tried.maxima.insert(tried.maxima.end(), maxima.begin(), maxima.end());
    tried.largest = std::max(tried.largest, tried.fit.unseen_ratio[i].maxCoeff());
  }
  tried.law = extreme_law_of(tried.maxima);
  const double per_block = -std::expm1(-request.alarms_per_hour / 3600 * data.block_s);
  tried.widening = std::max({1.0, tried.largest, exceeded_with(tried.law, per_block)});
  tried.mean_threshold =
      tried.widening * tried.fit.mean_threshold + 2 * request.velocity_error.value_or(0);
  return tried;
}

std::vector<Tried> try_shapes(const RobotDescription& robot, const Data& data,
                              const CalibrateRequest& request,
                              const std::function<void()>& on_step) {
  std::vector<RecordedError> fitted;
  for (std::size_t i = 0; i <= data.split.folds.back().recording; ++i) {
    fitted.push_back(data.recordings[i]);
  }
  std::vector<Tried> tried;
  double lowest = 0;
  for (const BoundShape& shape : bound_shapes(robot, fitted)) {
    ShapeFit fit =
        fit_shape(robot, shape, data.recordings, data.split, lowest, request.velocity_error);
    if (shape.settings.kind == BoundSettings::Kind::kConstant) {
      lowest = kLowestShare * fit.coefficients[0];
    }
    tried.push_back(judged(shape, std::move(fit), data, request));
    if (on_step) on_step();
  }
  return tried;
}

// The best of each kind in turn, from the simplest on: constant, scaled_norm, table.
std::size_t choice_among(const std::vector<Tried>& tried) {
  const auto kind_of = [&](std::size_t i) { return tried[i].shape.settings.kind; };
  std::size_t choice = 0;
  for (const auto kind : {BoundSettings::Kind::kScaledNorm, BoundSettings::Kind::kTable}) {
    double best = (1 - kWorthwhile) * tried[choice].mean_threshold;
    for (std::size_t i = 0; i < tried.size(); ++i) {
      if (kind_of(i) != kind || tried[i].mean_threshold >= best) continue;
      best = tried[i].mean_threshold;
      choice = i;
    }
  }
  return choice;
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
std::vector<Stretch> joined_stretches(const std::vector<Stretch>& folds) {
  std::vector<Stretch> whole;
  for (const Stretch& fold : folds) {
    const bool continues = !whole.empty() && whole.back().recording == fold.recording;
    if (continues) {
      whole.back().end = fold.end;
    } else {
      whole.push_back(fold);
    }
  }
  return whole;
}

// The core itself runs over every recording again, with the new bound.
void judge_all(const Data& data, const std::vector<Log>& logs, const std::vector<Log>& holdout,
               Calibration& result) {
  const auto log_of = [&](std::size_t i) -> const Log& {
    return i < logs.size() ? logs[i] : holdout[i - logs.size()];
  };
  const auto add = [&](const std::vector<Stretch>& stretches, bool held_out) {
    for (const Stretch& stretch : stretches) {
      const VectorXd threshold =
          recorded_error(result.robot, log_of(stretch.recording)).old_threshold;
      result.stretches.push_back(judged_stretch(data.recordings[stretch.recording], threshold,
                                                stretch.begin, stretch.end, held_out));
    }
  };
  std::vector<Stretch> calibrated = data.split.always;
  calibrated.insert(calibrated.end(), data.split.folds.begin(), data.split.folds.end());
  add(joined_stretches(calibrated), false);
  add(data.split.held_out, true);
}

void count_held_out(Calibration& result) {
  FalseAlarmLevel& level = result.level;
  std::string where;
  for (const JudgedStretch& stretch : result.stretches) {
    if (!stretch.held_out) continue;
    level.held_out_s += stretch.end_s - stretch.begin_s;
    level.held_out_alarms += stretch.alarms_after;
    if (!stretch.first_alarm_s) continue;
    where += fmt::format("{}{} from {:.3f} s on, |e| up to {:.3g} mu", where.empty() ? "" : "; ",
                         stretch.file, *stretch.first_alarm_s, stretch.max_ratio_after);
  }
  level.highest_per_hour = 3600 * highest_rate(level.held_out_alarms, level.held_out_s);
  const double expected = level.alarms_per_hour / 3600 * level.held_out_s;
  if (probability_of_as_many(level.held_out_alarms, expected) >= kUnlikely) return;
  result.objections.push_back(fmt::format(
      "{} alarm(s) in {:g} s of hold-out data, where {:.2g} were expected ({}): the bound does not "
      "keep its level. Calibrate on more recordings, of all the motions that the robot makes.",
      level.held_out_alarms, level.held_out_s, expected, where));
}

void look_for_strays(const Data& data, const Tried& constant, Calibration& result) {
  for (std::size_t i = 0; i < data.split.folds.size(); ++i) {
    const Stretch& fold = data.split.folds[i];
    const RecordedError& recording = data.recordings[fold.recording];
    Index at = 0;
    const double ratio = constant.fit.unseen_ratio[i].maxCoeff(&at);
    if (ratio <= kStrayRatio) continue;
    result.objections.push_back(fmt::format(
        "{}: at {:.3f} s |e| is {:.2g} times the largest that all other parts ask for. A fault "
        "there, or a motion that no other part has: leave the recording out, or add recordings "
        "like it.",
        recording.file, recording.t_s[fold.begin + at], ratio));
  }
}

void note_what_matters(const Data& data, Calibration& result) {
  for (const JudgedStretch& stretch : result.stretches) {
    if (stretch.alarms_before == 0) continue;
    result.notes.push_back(fmt::format(
        "{}: the old bound raises {} alarm(s) in it. If that was a fault, the new bound hides it.",
        stretch.file, stretch.alarms_before));
  }
  for (const RobotEffect& effect : result.robot.effects) {
    if (effect.kind != EffectKind::kPeriodicDisturbance) continue;
    result.notes.emplace_back(
        "The model knows a disturbance that is periodic in time: the bound holds where the monitor "
        "starts in the same phase of it as these recordings do.");
    break;
  }
  if (data.recordings.size() == 1) {
    result.notes.emplace_back(
        "One recording only: starts of a run, and motions, that differ from it have not been "
        "seen.");
  }
}

std::string source_of(const CalibrateRequest& request, const FalseAlarmLevel& level) {
  return fmt::format(
      "{} {:g} false alarms per hour by extrapolation of {} block maxima of {:g} s; on hold-out "
      "data {} alarm(s) in {:g} s.",
      request.source, level.alarms_per_hour, level.blocks, level.block_s, level.held_out_alarms,
      level.held_out_s);
}

}  // namespace

Calibration calibrate(const RobotDescription& robot, const CalibrateRequest& request,
                      const std::vector<Log>& logs, const std::vector<Log>& holdout,
                      const std::function<void()>& on_step) {
  const Data data = data_of(robot, logs, holdout);
  const std::vector<Tried> tried = try_shapes(robot, data, request, on_step);
  const std::size_t chosen = choice_among(tried);
  const Tried& best = tried[chosen];

  Calibration result;
  result.unit = data.recordings.front().unit;
  result.old_bound = robot.bound;
  for (std::size_t i = 0; i < tried.size(); ++i) {
    result.shapes.push_back({tried[i].shape.words, tried[i].largest, tried[i].widening,
                             tried[i].mean_threshold, i == chosen});
  }
  result.unseen_maxima = best.maxima;
  result.level.alarms_per_hour = request.alarms_per_hour;
  result.level.block_s = data.block_s;
  result.level.blocks = static_cast<std::int64_t>(best.maxima.size());
  result.level.law = best.law;
  result.robot = robot;
  result.robot.bound = best.fit.widened(best.shape, best.widening, request.velocity_error);
  judge_all(data, logs, holdout, result);
  count_held_out(result);
  look_for_strays(data, tried.front(), result);
  note_what_matters(data, result);
  result.robot.bound->source = source_of(request, result.level);
  return result;
}

}  // namespace offnominal::tools
