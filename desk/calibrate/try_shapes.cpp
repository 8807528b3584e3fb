#include "calibrate/try_shapes.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace offnominal::desk {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

// A simpler kind is kept unless another one's threshold is lower by this share: numbers beyond what
// the machine's physics asks for fit the recordings and not the next motion.
constexpr double kWorthwhile = 0.15;
// No c_k falls below this share of the constant bound: where the recordings say little, a table
// would otherwise fall to nothing.
constexpr double kLowestShare = 0.1;
// Nor the constant bound, where it would fall to nothing because the allowance for the velocity's
// own error covers everything, below this share of the largest |e|: a bound has to be above 0.
constexpr double kLowestShareOfError = 1e-3;
// No number of one joint's table is above this many times its constant bound: where the recordings
// hardly ever are, any number would cost nothing, and a run starts at the largest.
constexpr double kHighestTimes = 3;
// What a transient that was taken out asks for, and a little more: the next one like it is no
// smaller. How much larger it may be, one event does not say.
constexpr double kAboveTransient = 1.05;
// Of what unseen parts ask for: a motion that repeats makes its parts alike, and the next one is
// not. A table follows the recordings more closely, and each joint's bound is its own: calibrated
// on six minutes, the most that hours of other motions came to was up to 1.6 times what the unseen
// ones of these had asked for (docs/campaigns.md).
constexpr double kAboveUnseen = 1.1;
constexpr double kAboveUnseenOfTable = 1.5;
// One event decides the bound where the bound without it is narrower by this factor.
constexpr double kDecides = 2;

double above_unseen(const CalibrationData& data, const BoundShape& shape) {
  const bool is_table = shape.settings.kind == BoundSettings::Kind::kTable;
  return data.joint || is_table ? kAboveUnseenOfTable : kAboveUnseen;
}

// Of the blocks that are judged whole.
std::vector<double> judged_maxima(const VectorXd& ratio, std::int64_t length) {
  const std::vector<double> largest = block_maxima(ratio, length);
  const std::vector<double> smallest = block_maxima(-ratio, length);
  std::vector<double> judged;
  for (std::size_t block = 0; block < largest.size(); ++block) {
    if (smallest[block] < -ShapeFit::kApart) judged.push_back(largest[block]);
  }
  return judged;
}

Tried judged(const BoundShape& shape, ShapeFit fit, const CalibrationData& data,
             const CalibrateRequest& request) {
  Tried tried{shape, std::move(fit), {}, {}, 0, 1, 1, 0, 0};
  for (std::size_t i = 0; i < data.split.folds.size(); ++i) {
    const RecordedError& recording = data.recordings[data.split.folds[i].recording];
    const auto maxima = judged_maxima(tried.fit.unseen_ratio[i], data.block_samples(recording));
    tried.maxima.insert(tried.maxima.end(), maxima.begin(), maxima.end());
    tried.largest = std::max(tried.largest, tried.fit.unseen_ratio[i].maxCoeff());
  }
  tried.law = extreme_law_of(tried.maxima);
  const auto exceeded_at = [&](double alarms_per_hour) {
    return exceeded_with(tried.law, -std::expm1(-alarms_per_hour / 3600 * data.block_s));
  };
  tried.widening =
      std::max({1.0, above_unseen(data, shape) * tried.largest, tried.fit.unseen_start_ratio,
                kAboveTransient * tried.fit.apart_ratio, exceeded_at(request.alarms_per_hour)});
  if (request.act_alarms_per_hour) {
    tried.act_ratio = std::max(1.0, exceeded_at(*request.act_alarms_per_hour) / tried.widening);
  }
  tried.mean_threshold =
      tried.widening * tried.fit.mean_threshold + 2 * request.velocity_error.value_or(0);
  tried.judged_threshold =
      data.joint ? tried.widening * tried.fit.typical_threshold : tried.mean_threshold;
  return tried;
}

// The largest unseen |e|, and a block on either side of it: there the filter still remembers it.
SampleRange loudest_event(const Tried& tried, const CalibrationData& data) {
  SampleRange event;
  double largest = ShapeFit::kApart;
  for (std::size_t i = 0; i < data.split.folds.size(); ++i) {
    const SampleRange& fold = data.split.folds[i];
    const RecordedError& recording = data.recordings[fold.recording];
    Index at = 0;
    const double of_fold = tried.fit.unseen_ratio[i].maxCoeff(&at);
    if (of_fold <= largest) continue;
    largest = of_fold;
    at += fold.begin;
    const Index length = data.block_samples(recording);
    event = {fold.recording, std::max<Index>(0, at - length),
             std::min(recording.samples(), at + length + 1)};
  }
  return event;
}

Transient transient_of(const CalibrationData& data, const SampleRange& event, const Tried& with,
                       const Tried& without) {
  const RecordedError& recording = data.recordings[event.recording];
  Index at = 0;
  Transient transient;
  transient.error_norm =
      recording.error_norm.segment(event.begin, event.end - event.begin).maxCoeff(&at);
  at += event.begin;
  transient.file = recording.file;
  transient.time_s = recording.t_s[at];
  transient.joint = recording.loudest_joint[at];
  transient.ratio = without.fit.apart_ratio;
  transient.mean_threshold_with = with.mean_threshold;
  transient.mean_threshold_without = without.mean_threshold;
  return transient;
}

// The constant bound whose threshold, once the filter has settled, is that share of the largest
// |e|.
double lowest_constant(const std::vector<RecordedError>& recordings) {
  double largest = 0;  // of |e|, in the bound's unit
  for (const RecordedError& recording : recordings) {
    largest = std::max(largest,
                       recording.error_norm.maxCoeff() * recording.alpha_per_s / recording.scale);
  }
  return kLowestShareOfError * largest;
}

// Every shape on the same data, with an event taken out or without.
class Trials {
 public:
  Trials(const RobotDescription& robot, const CalibrationData& data,
         const CalibrateRequest& request, const std::function<void()>& on_step)
      : robot_(robot), data_(data), request_(request), on_step_(on_step) {
    for (std::size_t i = 0; i <= data.split.folds.back().recording; ++i) {
      fitted_.push_back(data.recordings[i]);
    }
    shapes_ =
        data.joint ? joint_bound_shapes(robot, *data.joint, fitted_) : bound_shapes(robot, fitted_);
  }

  [[nodiscard]] Tried constant(const std::optional<SampleRange>& apart) const {
    Tried tried = attempt(shapes_.front(), {}, apart);
    if (tried.fit.coefficients[0] > 0) return tried;
    return attempt(shapes_.front(), {.lowest = lowest_constant(fitted_)}, apart);
  }

  [[nodiscard]] std::vector<Tried> all(Tried constant,
                                       const std::optional<SampleRange>& apart) const {
    CoefficientRange range{.lowest = kLowestShare * constant.fit.coefficients[0]};
    if (data_.joint) range.highest = kHighestTimes * constant.fit.coefficients[0];
    std::vector<Tried> tried{std::move(constant)};
    for (std::size_t i = 1; i < shapes_.size(); ++i) {
      tried.push_back(attempt(shapes_[i], range, apart));
    }
    return tried;
  }

 private:
  [[nodiscard]] Tried attempt(const BoundShape& shape, const CoefficientRange& range,
                              const std::optional<SampleRange>& apart) const {
    Tried tried = judged(shape,
                         fit_shape(robot_, shape, data_.recordings, data_.split, range,
                                   request_.velocity_error, apart),
                         data_, request_);
    if (on_step_) on_step_();
    return tried;
  }

  const RobotDescription& robot_;
  const CalibrationData& data_;
  const CalibrateRequest& request_;
  const std::function<void()>& on_step_;
  std::vector<RecordedError> fitted_;
  std::vector<BoundShape> shapes_;
};

double best_threshold(const std::vector<Tried>& tried) {
  return tried[choice_among(tried)].judged_threshold;
}

}  // namespace

// The constant bound first: it shows whether one event would decide everything. Of a joint, whose
// table can hold it where it happens, it does not where the best shape bears it.
Tries try_shapes(const RobotDescription& robot, const CalibrationData& data,
                 const CalibrateRequest& request, const std::function<void()>& on_step) {
  constexpr std::size_t kBlocksOfAnEvent = 3;
  const Trials trials(robot, data, request, on_step);
  Tried with = trials.constant({});
  if (with.maxima.size() < static_cast<std::size_t>(kFewestBlocks) + kBlocksOfAnEvent) {
    return {trials.all(std::move(with), {}), {}};
  }
  const SampleRange apart = loudest_event(with, data);
  Tried without = trials.constant(apart);
  if (!(with.mean_threshold > kDecides * without.mean_threshold)) {
    return {trials.all(std::move(with), {}), {}};
  }
  Tries tries{{}, transient_of(data, apart, with, without)};
  tries.shapes = trials.all(std::move(without), apart);
  if (!data.joint) return tries;
  std::vector<Tried> bearing = trials.all(std::move(with), {});
  if (best_threshold(bearing) > kDecides * best_threshold(tries.shapes)) return tries;
  return {std::move(bearing), {}};
}

std::size_t choice_among(const std::vector<Tried>& tried) {
  const auto kind_of = [&](std::size_t i) { return tried[i].shape.settings.kind; };
  std::size_t choice = 0;
  for (const auto kind : {BoundSettings::Kind::kScaledNorm, BoundSettings::Kind::kTable}) {
    double best = (1 - kWorthwhile) * tried[choice].judged_threshold;
    for (std::size_t i = 0; i < tried.size(); ++i) {
      if (kind_of(i) != kind || tried[i].judged_threshold >= best) continue;
      best = tried[i].judged_threshold;
      choice = i;
    }
  }
  return choice;
}

}  // namespace offnominal::desk
