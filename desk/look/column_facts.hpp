#pragma once

#include <Eigen/Core>

namespace offnominal::desk {

// What a column of numbers looks like, in its own unit.
struct ColumnFacts {
  Eigen::Index values = 0;
  Eigen::Index not_finite = 0;  // of them; the rest of this is about the others
  double low = 0;               // NaN, as `high`: no value is finite
  double high = 0;
  // Every change is a multiple of it, as an encoder's are; 0: none, as of floats, or of a column
  // that hardly changes.
  double step = 0;
  // The step is that of printed digits, a power of ten.
  bool is_printed = false;
  bool is_constant = false;
  // Of the samples: within stretches of kRestSamples that stay within two steps, or within a
  // thousandth of the range.
  double resting_share = 0;
  // Of the samples: at the highest or lowest value for kHeldSamples or more.
  double held_at_high = 0;
  double held_at_low = 0;

  [[nodiscard]] bool has_numbers() const { return values > not_finite; }
};

inline constexpr Eigen::Index kRestSamples = 50;
inline constexpr Eigen::Index kHeldSamples = 5;

[[nodiscard]] ColumnFacts facts_of(const Eigen::VectorXd& column);

}  // namespace offnominal::desk
