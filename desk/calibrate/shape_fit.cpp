#include "calibrate/shape_fit.hpp"

#include <algorithm>

#include "calibrate/tightest.hpp"

namespace offnominal::desk {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// The rows of one fold, as a linear programme asks for them.
struct FoldRows {
  MatrixXd along;
  MatrixXd first_tick;
  VectorXd error;             // |e| that the unknown numbers have to reach
  VectorXd first_tick_error;  // the same after a first tick
  // Rows from apart_begin to apart_end - 1 are only held against the result: their errors.
  Index apart_begin = 0;
  Index apart_end = 0;
  VectorXd apart_error;
  VectorXd apart_first_tick_error;
};

// What stands in these rows is no longer asked for.
void take_apart(const SampleRange& fold, const SampleRange& apart, FoldRows& rows) {
  if (apart.recording != fold.recording) return;
  const Index begin = std::max(apart.begin, fold.begin);
  const Index end = std::min(apart.end, fold.end);
  if (begin >= end) return;
  rows.apart_begin = begin - fold.begin;
  rows.apart_end = end - fold.begin;
  const Index count = end - begin;
  rows.apart_error = rows.error.segment(rows.apart_begin, count);
  rows.apart_first_tick_error = rows.first_tick_error.segment(rows.apart_begin, count);
  rows.error.segment(rows.apart_begin, count).setZero();
  rows.first_tick_error.segment(rows.apart_begin, count).setZero();
}

double largest_apart(const FoldRows& fold, const VectorXd& c) {
  const Index count = fold.apart_end - fold.apart_begin;
  if (count == 0) return 0;
  const auto largest = [&](const MatrixXd& rows, const VectorXd& error) {
    const VectorXd threshold = rows.middleRows(fold.apart_begin, count) * c;
    return (error.array() > 0).select(error.array() / threshold.array(), 0.0).maxCoeff();
  };
  return std::max(largest(fold.along, fold.apart_error),
                  largest(fold.first_tick, fold.apart_first_tick_error));
}

// A velocity error that is given is no unknown: its 2 v is taken off the error that is left to
// cover.
FoldRows fold_rows(const FilteredBasis& basis, const RecordedError& recording,
                   const SampleRange& fold, const std::optional<double>& velocity_error) {
  const Index rows = fold.end - fold.begin;
  const Index columns = basis.along.cols() - (velocity_error ? 1 : 0);
  const double allowance = 2 * velocity_error.value_or(0);
  FoldRows result;
  result.along = basis.along.block(fold.begin, 0, rows, columns);
  result.first_tick = basis.first_tick.block(fold.begin, 0, rows, columns);
  result.error = (recording.error_norm.segment(fold.begin, rows).array() - allowance).max(0.0);
  result.first_tick_error =
      (recording.first_tick.segment(fold.begin, rows).array() - allowance).max(0.0);
  return result;
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

VectorXd tightest_without(const std::vector<FoldRows>& folds, const Turn& turn,
                          const VectorXd& lowest, const VectorXd& price) {
  std::vector<ThresholdRows> parts;
  for (std::size_t i = 0; i < folds.size(); ++i) {
    if (turn.leaves_out(i)) continue;
    parts.push_back({folds[i].along, folds[i].error, true});
    // A run may start at any sample: its first tick has to hold, on which the velocity's own error
    // weighs most.
    parts.push_back({folds[i].first_tick, folds[i].first_tick_error, false});
  }
  return tightest(parts, lowest, price);
}

// Row 0 of a recording is the start of its run, where there is no error and may be no threshold.
VectorXd ratio_of(const FoldRows& fold, const VectorXd& c) {
  const VectorXd threshold = fold.along * c;
  VectorXd ratio = (fold.error.array() > 0).select(fold.error.array() / threshold.array(), 0.0);
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
                   const std::vector<RecordedError>& recordings, const Split& split, double lowest,
                   const std::optional<double>& velocity_error,
                   const std::optional<SampleRange>& apart) {
  std::vector<SampleRange> folds = split.folds;
  folds.insert(folds.end(), split.always.begin(), split.always.end());
  std::vector<FoldRows> rows;
  {
    FilteredBasis basis;
    std::optional<std::size_t> held;
    for (const SampleRange& fold : folds) {
      const RecordedError& recording = recordings[fold.recording];
      if (fold.recording != held) basis = filtered_basis(robot, shape, recording);
      held = fold.recording;
      rows.push_back(fold_rows(basis, recording, fold, velocity_error));
      if (apart) take_apart(fold, *apart, rows.back());
    }
  }
  const Index unknowns = rows.front().along.cols();
  VectorXd least = VectorXd::Constant(unknowns, lowest);
  if (!velocity_error) least[unknowns - 1] = 0;
  // Once the filter has forgotten its start, 2 v and a constant part of the bound are the same: v
  // is to be only what the first ticks ask for.
  VectorXd price = VectorXd::Ones(unknowns);
  if (!velocity_error) price[unknowns - 1] = kPriceOfVelocityError;

  ShapeFit fit;
  const VectorXd all = tightest_without(rows, {}, least, price);
  const std::size_t judged = split.folds.size();
  std::vector<VectorXd> of_turn;
  for (std::size_t turn = 0; turn < std::min(judged, kMostTurns); ++turn) {
    of_turn.push_back(tightest_without(rows, {judged, turn}, least, price));
  }
  for (std::size_t i = 0; i < judged; ++i) {
    fit.unseen_ratio.push_back(ratio_of(rows[i], of_turn[i % kMostTurns]));
  }
  double sum = 0;
  Index count = 0;
  for (std::size_t i = 0; i < folds.size(); ++i) {
    fit.apart_ratio = std::max(fit.apart_ratio, largest_apart(rows[i], all));
    sum += (rows[i].along * all).sum();
    count += rows[i].along.rows();
  }
  fit.mean_threshold = sum / static_cast<double>(count);
  fit.coefficients.resize(shape.size + 1);
  fit.coefficients.head(shape.size) = all.head(shape.size);
  fit.coefficients[shape.size] = velocity_error ? *velocity_error : all[unknowns - 1];
  return fit;
}

}  // namespace offnominal::desk
