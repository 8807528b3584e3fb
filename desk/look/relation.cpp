#include "look/relation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "signal/differentiate.hpp"
#include "signal/fold.hpp"
#include "signal/resample.hpp"
#include "signal/zero_phase.hpp"

namespace offnominal::desk {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

double median_step(const VectorXd& t_s) {
  VectorXd steps = t_s.tail(t_s.size() - 1) - t_s.head(t_s.size() - 1);
  double* const middle = steps.data() + steps.size() / 2;
  std::nth_element(steps.data(), middle, steps.data() + steps.size());
  return *middle;
}

}  // namespace

bool is_hardly_worse(double correlation, double best) {
  constexpr double kTimesWorse = 5;
  constexpr double kWorse = 0.005;
  return correlation > 0 && 1 - correlation <= kTimesWorse * (1 - best) + kWorse;
}

JudgedRows judged_rows(Index rows) {
  constexpr Index kMostJudged = 20'000;
  const Index count = std::min(kMostJudged, rows);
  return {(rows - count) / 2, count};
}

UnbrokenRows longest_stretch(const VectorXd& t_s, const Eigen::MatrixXd& columns) {
  UnbrokenRows longest;
  if (t_s.size() < 2) return longest;
  const double most = 2 * median_step(t_s);
  Index first = 0;
  const auto end_at = [&](Index row, Index next) {
    if (row - first > longest.count) {
      longest.first = first;
      longest.count = row - first;
    }
    first = next;
  };
  for (Index row = 0; row < t_s.size(); ++row) {
    if (!columns.row(row).allFinite()) {
      longest.has_not_finite = true;
      end_at(row, row + 1);
    } else if (row > 0 && t_s[row] - t_s[row - 1] > most) {
      longest.has_gap = true;
      end_at(row, row);
    }
  }
  end_at(t_s.size(), t_s.size());
  return longest;
}

Smoothed smoothed(const VectorXd& x, const VectorXd& t_s) {
  const Index count = x.size();
  const double period_s = (t_s[count - 1] - t_s[0]) / static_cast<double>(count - 1);
  // Ends a rounding error before the last stamp, or at it.
  const VectorXd even = VectorXd::LinSpaced(count, t_s[0], t_s[count - 1]).cwiseMin(t_s[count - 1]);
  const double rate_hz = 1 / period_s;
  Smoothed of;
  // A time that is not in s may make milliseconds of a whole motion.
  constexpr double kFewestPeriods = 100;  // of the cut-off, in the stretch
  const double cutoff_hz = std::max(100.0, kFewestPeriods / (t_s[count - 1] - t_s[0]));
  of.value =
      zero_phase_low_pass(linear_at(t_s, x, even), std::min(cutoff_hz, rate_hz / 10), rate_hz);
  of.slope = central_difference(of.value, period_s);
  return of;
}

Relation relation_of(const Smoothed& position, const Smoothed& velocity) {
  constexpr double kCorrelated = 0.9;
  Relation relation;
  const double product = position.slope.dot(velocity.value);
  const double squares = velocity.value.squaredNorm();
  const double size = std::sqrt(position.slope.squaredNorm() * squares);
  if (!(size > 0)) return relation;
  relation.correlation = product / size;
  if (std::abs(relation.correlation) < kCorrelated) return relation;
  relation.ratio = squares / product;
  return relation;
}

Relation relation_of(const VectorXd& position, const VectorXd& velocity, const VectorXd& t_s) {
  Relation relation;
  if (position.size() != t_s.size() || velocity.size() != t_s.size()) {
    relation.not_judged = "they have other numbers of samples than the time";
    return relation;
  }
  Eigen::MatrixXd both(t_s.size(), 2);
  both << position, velocity;
  const UnbrokenRows stretch = longest_stretch(t_s, both);
  if (stretch.count < kFewestJudged) {
    const char* const why = stretch.has_not_finite ? "values are missing (NaN): the longest stretch"
                            : stretch.has_gap      ? "time has gaps: the longest stretch"
                                                   : "the recording";
    relation.not_judged =
        fmt::format("{} has {} samples, {} are needed", why, stretch.count, kFewestJudged);
    return relation;
  }
  VectorXd q = position.segment(stretch.first, stretch.count);
  const VectorXd dq = velocity.segment(stretch.first, stretch.count);
  if (q.maxCoeff() == q.minCoeff() || dq.maxCoeff() == dq.minCoeff()) {
    relation.not_judged = "one of them never changes";
    return relation;
  }
  const KnownFold fold = known_fold_in_any_unit(q);
  if (!fold.folds.empty()) unfold(q, fold.range, fold.folds);
  const VectorXd t = t_s.segment(stretch.first, stretch.count);
  return relation_of(smoothed(q, t), smoothed(dq, t));
}

}  // namespace offnominal::desk
