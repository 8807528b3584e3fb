#include "look/column_facts.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace offnominal::desk {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

// Of all changes; 0 where they have none in common.
double common_step(const VectorXd& x) {
  constexpr Index kFewest = 20;        // changes
  constexpr double kNearlyAll = 0.95;  // of them lie near a multiple
  constexpr double kMostSteps = 1e6;   // of the range; beyond, rounding makes anything of it
  // How far a change may lie beside a multiple, in steps: what printing rounds away, and what the
  // step itself is not known to.
  constexpr double kBeside = 0.1;
  constexpr double kOfStep = 1e-4;
  const double rounding = 1e-12 * x.cwiseAbs().maxCoeff();
  const Index count = x.size() - 1;
  const VectorXd changes = (x.tail(count) - x.head(count)).cwiseAbs();
  double smallest = std::numeric_limits<double>::infinity();
  Index moved = 0;
  for (const double change : changes) {
    if (change <= rounding) continue;
    smallest = std::min(smallest, change);
    ++moved;
  }
  if (moved < kFewest || smallest * kMostSteps < x.maxCoeff() - x.minCoeff()) return 0;
  // The mean over small multiples says the step better than the smallest change alone.
  constexpr double kSmallMultiple = 20;
  double sum = 0;
  double steps = 0;
  for (const double change : changes) {
    if (change <= rounding || change > kSmallMultiple * smallest) continue;
    sum += change;
    steps += std::round(change / smallest);
  }
  const double step = sum / steps;
  Index near = 0;
  for (const double change : changes) {
    if (change <= rounding) continue;
    const double multiple = change / step;
    if (std::abs(multiple - std::round(multiple)) <= std::min(0.2, kBeside + kOfStep * multiple)) {
      ++near;
    }
  }
  return static_cast<double>(near) < kNearlyAll * static_cast<double>(moved) ? 0 : step;
}

bool is_power_of_ten(double value) {
  const double digits = std::log10(value);
  return std::abs(digits - std::round(digits)) < 1e-4;
}

double resting_share(const VectorXd& x, double step) {
  constexpr double kOfRange = 1e-3;
  const double most = std::max(2 * step, kOfRange * (x.maxCoeff() - x.minCoeff()));
  Index resting = 0;
  for (Index at = 0; at + kRestSamples <= x.size(); at += kRestSamples) {
    const auto part = x.segment(at, kRestSamples);
    if (part.maxCoeff() - part.minCoeff() <= most) resting += kRestSamples;
  }
  return static_cast<double>(resting) / static_cast<double>(x.size());
}

double held_share(const VectorXd& x, double value) {
  Index held = 0;
  Index run = 0;
  for (Index i = 0; i <= x.size(); ++i) {
    if (i < x.size() && x[i] == value) {
      ++run;
      continue;
    }
    if (run >= kHeldSamples) held += run;
    run = 0;
  }
  return static_cast<double>(held) / static_cast<double>(x.size());
}

}  // namespace

ColumnFacts facts_of(const VectorXd& column) {
  ColumnFacts facts;
  facts.values = column.size();
  facts.not_finite = column.size() - column.array().isFinite().count();
  VectorXd x = column;
  if (facts.not_finite > 0) {
    const auto end = std::remove_if(x.begin(), x.end(), [](double v) { return !std::isfinite(v); });
    x.conservativeResize(end - x.begin());
  }
  if (x.size() == 0) {
    facts.low = facts.high = std::numeric_limits<double>::quiet_NaN();
    return facts;
  }
  facts.low = x.minCoeff();
  facts.high = x.maxCoeff();
  facts.is_constant = facts.low == facts.high;
  if (facts.is_constant) {
    facts.resting_share = 1;
    return facts;
  }
  facts.step = common_step(x);
  facts.is_printed = facts.step > 0 && is_power_of_ten(facts.step);
  facts.resting_share = resting_share(x, facts.step);
  facts.held_at_high = held_share(x, facts.high);
  facts.held_at_low = held_share(x, facts.low);
  return facts;
}

}  // namespace offnominal::desk
