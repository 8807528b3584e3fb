#include "signal/resample.hpp"

#include <algorithm>
#include <stdexcept>

namespace offnominal::desk {
namespace {

using Eigen::Index;
using Points = Eigen::Ref<const Eigen::VectorXd>;

void check(const Points& at, const Points& value, const Points& wanted) {
  if (at.size() < 3 || at.size() != value.size()) {
    throw std::invalid_argument("interpolation needs at least 3 points with one value each");
  }
  for (Index i = 1; i < at.size(); ++i) {
    if (!(at[i] > at[i - 1])) throw std::invalid_argument("interpolation points must ascend");
  }
  for (const double x : wanted) {
    if (!(x >= at[0] && x <= at[at.size() - 1])) {
      throw std::invalid_argument("interpolation outside of the points given");
    }
  }
}

// Index of the interval that holds x.
Index interval_of(const Points& at, double x) {
  const double* const end = at.data() + at.size();
  const auto above = std::upper_bound(at.data(), end, x) - at.data();
  return std::clamp<Index>(above - 1, 0, at.size() - 2);
}

// Second derivatives of the natural spline at its points: a tridiagonal system, solved from the
// first row to the last and back.
Eigen::VectorXd second_derivatives(const Points& at, const Points& value) {
  const Index n = at.size();
  Eigen::VectorXd upper = Eigen::VectorXd::Zero(n);
  Eigen::VectorXd m = Eigen::VectorXd::Zero(n);
  for (Index i = 1; i < n - 1; ++i) {
    const double before = at[i] - at[i - 1];
    const double after = at[i + 1] - at[i];
    const double slope_change =
        (value[i + 1] - value[i]) / after - (value[i] - value[i - 1]) / before;
    const double pivot = 2 * (before + after) - before * upper[i - 1];
    upper[i] = after / pivot;
    m[i] = (6 * slope_change - before * m[i - 1]) / pivot;
  }
  for (Index i = n - 2; i >= 1; --i) m[i] -= upper[i] * m[i + 1];
  return m;
}

}  // namespace

Eigen::VectorXd spline_at(const Points& at, const Points& value, const Points& wanted) {
  check(at, value, wanted);
  const Eigen::VectorXd m = second_derivatives(at, value);
  Eigen::VectorXd result(wanted.size());
  for (Index i = 0; i < wanted.size(); ++i) {
    const Index k = interval_of(at, wanted[i]);
    const double width = at[k + 1] - at[k];
    const double right = (wanted[i] - at[k]) / width;
    const double left = 1 - right;
    const double bend =
        (left * left * left - left) * m[k] + (right * right * right - right) * m[k + 1];
    result[i] = left * value[k] + right * value[k + 1] + bend * width * width / 6;
  }
  return result;
}

Eigen::VectorXd linear_at(const Points& at, const Points& value, const Points& wanted) {
  check(at, value, wanted);
  Eigen::VectorXd result(wanted.size());
  for (Index i = 0; i < wanted.size(); ++i) {
    const Index k = interval_of(at, wanted[i]);
    const double right = (wanted[i] - at[k]) / (at[k + 1] - at[k]);
    result[i] = (1 - right) * value[k] + right * value[k + 1];
  }
  return result;
}

}  // namespace offnominal::desk
