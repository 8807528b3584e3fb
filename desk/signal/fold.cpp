#include "signal/fold.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "signal/quantile.hpp"

namespace offnominal::desk {

using Eigen::Index;
using Eigen::VectorXd;

std::vector<Index> folds_of(const Eigen::Ref<const VectorXd>& x, double range) {
  // What rounding of a range that is printed adds to it.
  constexpr double kSpan = 1.01;
  // Between these shares of the range lie neither folds nor the motion between two samples.
  constexpr double kLargestStep = 0.25;
  constexpr double kSmallestFold = 0.75;
  // What a fold may differ from the range by.
  constexpr double kOfRange = 0.03;
  constexpr double kOfSteps = 3;
  constexpr double kNearlyAll = 0.95;
  std::vector<Index> folds;
  const Index steps = x.size() - 1;
  if (steps < 1 || !(range > 0)) return folds;
  const double span = x.maxCoeff() - x.minCoeff();
  if (span > kSpan * range || span < kSmallestFold * range) return folds;
  const VectorXd change = (x.tail(steps) - x.head(steps)).cwiseAbs();
  // The motion alone, however often it passes the fold.
  const VectorXd motion = change.cwiseMin((range - change.array()).abs().matrix());
  if (motion.maxCoeff() > kLargestStep * range) return folds;
  const double most = std::max(kOfRange * range, kOfSteps * quantile(motion, kNearlyAll));
  for (Index i = 0; i < steps; ++i) {
    if (change[i] > kSmallestFold * range && motion[i] <= most) folds.push_back(i);
  }
  return folds;
}

KnownFold known_fold_of(const Eigen::Ref<const VectorXd>& x) {
  constexpr double kTurn = 2 * std::numbers::pi;
  constexpr double kMit = 25;
  constexpr double kFilled = 0.95;
  constexpr double kRounding = 1e-3;  // rad
  if (x.size() == 0) return {};
  const double low = x.minCoeff();
  const double high = x.maxCoeff();
  KnownFold fold{kTurn, (low + high - kTurn) / 2, folds_of(x, kTurn)};
  if (!fold.folds.empty()) return fold;
  const bool is_filled =
      high <= kMit / 2 + kRounding && low >= -kMit / 2 - kRounding && high - low > kFilled * kMit;
  if (is_filled) fold = {kMit, -kMit / 2, folds_of(x, kMit)};
  return fold;
}

KnownFold known_fold_in_any_unit(const Eigen::Ref<const VectorXd>& x) {
  constexpr double kTurnInDegrees = 360;
  KnownFold fold = known_fold_of(x);
  if (!fold.folds.empty() || x.size() == 0) return fold;
  return {kTurnInDegrees, (x.minCoeff() + x.maxCoeff() - kTurnInDegrees) / 2,
          folds_of(x, kTurnInDegrees)};
}

void unfold(Eigen::Ref<VectorXd> x, double range, const std::vector<Index>& folds) {
  std::vector<double> turns;
  turns.reserve(folds.size());
  for (const Index fold : folds) turns.push_back(std::copysign(range, x[fold] - x[fold + 1]));
  double sum = 0;
  std::size_t next = 0;
  for (Index i = 0; i < x.size(); ++i) {
    x[i] += sum;
    if (next < folds.size() && folds[next] == i) sum += turns[next++];
  }
}

}  // namespace offnominal::desk
