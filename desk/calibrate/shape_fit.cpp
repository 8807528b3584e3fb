#include "calibrate/shape_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "calibrate/tightest.hpp"

namespace offnominal::desk {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// The rows of one fold, as a linear programme asks for them.
struct FoldRows {
  ThresholdRows rows;          // the run's own demand first, then those of starts
  std::vector<Demand> starts;  // held against the result alone
  // What is only held against the result; the run's own rows of it from apart_begin to apart_end
  // - 1.
  std::vector<Demand> apart;
  Index apart_begin = 0;
  Index apart_end = 0;
};

// What stands in these samples is no longer asked for, whether a run starts or is judged there.
void take_apart(const SampleRange& fold, const SampleRange& apart, FoldRows& of_fold) {
  if (apart.recording != fold.recording) return;
  const Index begin = std::max(apart.begin, fold.begin);
  const Index end = std::min(apart.end, fold.end);
  if (begin < end) {
    of_fold.apart_begin = begin - fold.begin;
    of_fold.apart_end = end - fold.begin;
  }
  for (std::vector<Demand>* demands : {&of_fold.rows.demands, &of_fold.starts}) {
    for (Demand& demand : *demands) {
      const Index last = std::min(apart.end + demand.start.ticks, fold.end);
      if (begin >= last) continue;
      const Index from = begin - fold.begin;
      Demand& kept = of_fold.apart.emplace_back(demand);
      kept.error.head(from).setZero();
      kept.error.tail(fold.end - last).setZero();
      demand.error.segment(from, last - begin).setZero();
    }
  }
}

// A velocity error that is given is no unknown: its 2 v is taken off the error that is left to
// cover. A run may start at any sample. The threshold of |e| is nothing then but 2 v, which has to
// be found: its first tick is asked for, on which the velocity's own error weighs most. That of one
// joint is at its largest then, and all its first ticks are only held against it.
FoldRows fold_rows(const MatrixXd& basis, const std::vector<StartBefore>& starts,
                   const RecordedError& recording, const SampleRange& fold,
                   const std::optional<double>& velocity_error) {
  const Index rows = fold.end - fold.begin;
  const double allowance = 2 * velocity_error.value_or(0);
  const auto demand_of = [&](const StartBefore& start, const VectorXd& error) {
    return Demand{start, (error.array() - allowance).max(0.0)};
  };
  FoldRows result;
  result.rows.history = std::min(fold.begin, starts.back().ticks);
  result.rows.filtered =
      basis.middleRows(fold.begin - result.rows.history, rows + result.rows.history);
  result.rows.constant = velocity_error ? 0 : 2 * recording.scale;
  result.rows.starts_at_largest = recording.of_one_joint;
  VectorXd along = recording.error_norm.segment(fold.begin, rows);
  if (recording.of_one_joint) {
    // The recording's own start is one of them.
    along.head(std::clamp<Index>(starts.back().ticks - fold.begin, 0, rows)).setZero();
    for (const StartBefore& start : starts) {
      result.starts.push_back(
          demand_of(start, recording.error_norm_after(start, fold.begin, fold.end)));
    }
  }
  result.rows.demands.push_back(demand_of({}, along));
  if (!recording.of_one_joint) {
    result.rows.demands.push_back(demand_of(
        starts.front(), recording.error_norm_after(starts.front(), fold.begin, fold.end)));
  }
  return result;
}

// 0 where nothing is asked: there may be no threshold.
VectorXd over(const VectorXd& error, const VectorXd& threshold) {
  return (error.array() > 0).select(error.array() / threshold.array(), 0.0);
}

// The largest of what is demanded over the threshold.
double demanded_of_threshold(const ThresholdRows& rows, const std::vector<Demand>& demands,
                             const VectorXd& c) {
  const VectorXd along = rows.along(c);
  double largest = 0;
  for (const auto& [start, error] : demands) {
    const VectorXd threshold = rows.threshold(start, along, c);
    largest = std::max(largest, over(error, threshold).maxCoeff());
  }
  return largest;
}

constexpr double kPriceOfVelocityError = 2;
// Which folds are unseen together: every kMostTurns-th, so that many recordings cost no more than
// few.
constexpr std::size_t kMostTurns = 5;
struct Turn {
  std::size_t judged = 0;  // the folds from here on are never unseen
  std::size_t number = 0;

  [[nodiscard]] bool leaves_out(std::size_t fold) const {
    return fold < judged && fold % kMostTurns == number;
  }
};

// Of the unknown numbers.
struct Limits {
  VectorXd lowest;
  VectorXd price;
  std::optional<VectorXd> highest;
  Index points = 0;  // of a table
};

Limits limits_of(const BoundShape& shape, const CoefficientRange& range, Index unknowns,
                 bool finds_velocity_error) {
  Limits limits{VectorXd::Constant(unknowns, range.lowest), VectorXd::Ones(unknowns), {}};
  if (shape.settings.kind == BoundSettings::Kind::kTable) limits.points = shape.size;
  if (shape.settings.kind == BoundSettings::Kind::kTable && range.highest > 0) {
    limits.highest = VectorXd::Constant(unknowns, range.highest);
  }
  if (!finds_velocity_error) return limits;
  // Once the filter has forgotten its start, 2 v and a constant part of the bound are the same: v
  // is to be only what the first ticks ask for.
  limits.lowest[unknowns - 1] = 0;
  limits.price[unknowns - 1] = kPriceOfVelocityError;
  if (limits.highest) (*limits.highest)[unknowns - 1] = std::numeric_limits<double>::infinity();
  return limits;
}

// A table that is lower at one point than at both of its neighbours says that a joint is quieter in
// a narrow band of speeds. So do quick passes through it: the residual has no time to become what
// it is where the joint stays there. What the point alone would make of the threshold, the filter's
// answer to it, tells how long it stayed: without such a stay the neighbours' number counts.
// `points`: of the table, which the unknown numbers begin with.
void fill_dips(const ThresholdParts& parts, Index points, VectorXd& c) {
  constexpr double kStayed = 0.7;  // of what the filter comes to in the end
  for (Index k = 1; k + 1 < points; ++k) {
    const bool stayed = std::any_of(parts.begin(), parts.end(), [k](const ThresholdRows& part) {
      return part.filtered.col(k).tail(part.size()).maxCoeff() >= kStayed;
    });
    if (!stayed) c[k] = std::max(c[k], std::min(c[k - 1], c[k + 1]));
  }
}

VectorXd tightest_without(const std::vector<FoldRows>& folds, const Turn& turn,
                          const Limits& limits) {
  ThresholdParts parts;
  for (std::size_t i = 0; i < folds.size(); ++i) {
    if (!turn.leaves_out(i)) parts.emplace_back(folds[i].rows);
  }
  VectorXd c = tightest(parts, limits.lowest, limits.price, limits.highest);
  fill_dips(parts, limits.points, c);
  return c;
}

// Row 0 of a recording is the start of its run, where there is no error and may be no threshold.
VectorXd ratio_of(const FoldRows& fold, const VectorXd& c) {
  const VectorXd& error = fold.rows.demands.front().error;
  const VectorXd threshold = fold.rows.threshold({}, fold.rows.along(c), c);
  VectorXd ratio = over(error, threshold);
  ratio.segment(fold.apart_begin, fold.apart_end - fold.apart_begin).setConstant(ShapeFit::kApart);
  return ratio;
}

}  // namespace

BoundSettings ShapeFit::widened(const BoundShape& shape, double widening,
                                const std::optional<double>& velocity_error) const {
  return bound_with(shape, widening * coefficients.head(shape.size),
                    velocity_error ? *velocity_error : widening * coefficients[shape.size]);
}

ShapeFit fit_shape(const RobotDescription& robot, const BoundShape& shape,
                   const std::vector<RecordedError>& recordings, const Split& split,
                   const CoefficientRange& range, const std::optional<double>& velocity_error,
                   const std::optional<SampleRange>& apart) {
  std::vector<SampleRange> folds = split.folds;
  folds.insert(folds.end(), split.always.begin(), split.always.end());
  std::vector<FoldRows> rows;
  {
    MatrixXd basis;
    std::vector<StartBefore> starts;
    std::optional<std::size_t> held;
    for (const SampleRange& fold : folds) {
      const RecordedError& recording = recordings[fold.recording];
      if (fold.recording != held) {
        basis = filtered_basis(robot, shape, recording);
        starts = starts_before(recording.filter());
      }
      held = fold.recording;
      rows.push_back(fold_rows(basis, starts, recording, fold, velocity_error));
      if (apart) take_apart(fold, *apart, rows.back());
    }
  }
  const Index unknowns = rows.front().rows.unknowns();
  const Limits limits = limits_of(shape, range, unknowns, !velocity_error);
  ShapeFit fit;
  const VectorXd all = tightest_without(rows, {}, limits);
  const std::size_t judged = split.folds.size();
  std::vector<VectorXd> of_turn;
  for (std::size_t turn = 0; turn < std::min(judged, kMostTurns); ++turn) {
    of_turn.push_back(tightest_without(rows, {judged, turn}, limits));
  }
  for (std::size_t i = 0; i < judged; ++i) {
    const VectorXd& unseeing = of_turn[i % kMostTurns];
    fit.unseen_ratio.push_back(ratio_of(rows[i], unseeing));
    fit.unseen_start_ratio = std::max(
        fit.unseen_start_ratio, demanded_of_threshold(rows[i].rows, rows[i].starts, unseeing));
  }
  double sum = 0;
  double sum_of_logarithms = 0;
  Index count = 0;
  Index above_nothing = 0;
  for (std::size_t i = 0; i < folds.size(); ++i) {
    const ThresholdRows& of_fold = rows[i].rows;
    fit.apart_ratio = std::max(fit.apart_ratio, demanded_of_threshold(of_fold, rows[i].apart, all));
    const VectorXd threshold = of_fold.threshold({}, of_fold.along(all), all);
    sum += threshold.sum();
    count += of_fold.size();
    // A run of |e| starts at no threshold.
    sum_of_logarithms += (threshold.array() > 0).select(threshold.array().log(), 0.0).sum();
    above_nothing += (threshold.array() > 0).count();
  }
  fit.mean_threshold = sum / static_cast<double>(count);
  fit.typical_threshold =
      std::exp(sum_of_logarithms / static_cast<double>(std::max<Index>(above_nothing, 1)));
  fit.coefficients.resize(shape.size + 1);
  fit.coefficients.head(shape.size) = all.head(shape.size);
  fit.coefficients[shape.size] = velocity_error ? *velocity_error : all[unknowns - 1];
  return fit;
}

}  // namespace offnominal::desk
