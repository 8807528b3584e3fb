#include "signal/resample.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace offnominal::desk {
namespace {

using Eigen::Index;
using Points = Eigen::Ref<const Eigen::VectorXd>;

void check(const Points& at, const Points& value) {
  if (at.size() < 3 || at.size() != value.size()) {
    throw std::invalid_argument("interpolation needs at least 3 points with one value each");
  }
  for (Index i = 1; i < at.size(); ++i) {
    if (!(at[i] > at[i - 1])) throw std::invalid_argument("interpolation points must ascend");
  }
}

void check_within(const Points& at, const Points& wanted) {
  for (const double x : wanted) {
    if (!(x >= at[0] && x <= at[at.size() - 1])) {
      throw std::invalid_argument("interpolation outside of the points given");
    }
  }
}

// Finds the interval that holds x, from where the last one was: wanted points mostly ascend.
class IntervalSearch {
 public:
  explicit IntervalSearch(const Points& at) : at_(at.data(), at.size()) {}

  Index of(double x) {
    constexpr int kNear = 8;
    const Index last = at_.size() - 2;
    if (x < at_[near_]) return anywhere(x);
    for (int step = 0; step < kNear; ++step) {
      if (near_ == last || x < at_[near_ + 1]) return near_;
      ++near_;
    }
    return anywhere(x);
  }

 private:
  Index anywhere(double x) {
    const double* const end = at_.data() + at_.size();
    const auto above = std::upper_bound(at_.data(), end, x) - at_.data();
    near_ = std::clamp<Index>(above - 1, 0, at_.size() - 2);
    return near_;
  }

  Eigen::Map<const Eigen::VectorXd> at_;
  Index near_ = 0;
};

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

Spline::Spline(Eigen::VectorXd at, Eigen::VectorXd value)
    : at_(std::move(at)), value_(std::move(value)) {
  check(at_, value_);
  bend_ = second_derivatives(at_, value_);
}

Eigen::VectorXd Spline::at(const Points& wanted) const {
  check_within(at_, wanted);
  IntervalSearch interval(at_);
  Eigen::VectorXd result(wanted.size());
  for (Index i = 0; i < wanted.size(); ++i) {
    const Index k = interval.of(wanted[i]);
    const double width = at_[k + 1] - at_[k];
    const double right = (wanted[i] - at_[k]) / width;
    const double left = 1 - right;
    const double bend =
        (left * left * left - left) * bend_[k] + (right * right * right - right) * bend_[k + 1];
    result[i] = left * value_[k] + right * value_[k + 1] + bend * width * width / 6;
  }
  return result;
}

Eigen::VectorXd spline_at(const Points& at, const Points& value, const Points& wanted) {
  return Spline(at, value).at(wanted);
}

Eigen::VectorXd linear_at(const Points& at, const Points& value, const Points& wanted) {
  check(at, value);
  check_within(at, wanted);
  IntervalSearch interval(at);
  Eigen::VectorXd result(wanted.size());
  for (Index i = 0; i < wanted.size(); ++i) {
    const Index k = interval.of(wanted[i]);
    const double right = (wanted[i] - at[k]) / (at[k + 1] - at[k]);
    result[i] = (1 - right) * value[k] + right * value[k + 1];
  }
  return result;
}

}  // namespace offnominal::desk
