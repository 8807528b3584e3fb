#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

// How often a threshold that is right on average is crossed all the same.

namespace offnominal::desk {

/// Law of the largest |e| / mu of a block of time: P(maximum <= x) =
/// exp(-(1 - shape (x - location) / scale)^(1 / shape)), the generalised extreme-value law in
/// Hosking's sign: shape 0 is Gumbel's, below 0 the tail is heavier, above 0 it has an end.
struct ExtremeLaw {
  double location = 0;
  double scale = 0;
  double shape = 0;
};

inline constexpr int kFewestBlocks = 10;

/// The law whose tail is that of the largest 15 % of the maxima of at least kFewestBlocks blocks: a
/// generalised Pareto law by L-moments (Hosking and Wallis, Technometrics 29(3), 1987), its shape
/// drawn towards an exponential tail as far as so few leave it open. A tail with an end is not
/// believed: a motion that repeats makes blocks alike, which looks like an end and is none for the
/// next motion. It is taken for exponential.
[[nodiscard]] ExtremeLaw extreme_law_of(std::vector<double> maxima);

/// The value that a block's maximum exceeds with this probability, 0 < p < 1.
[[nodiscard]] double exceeded_with(const ExtremeLaw& law, double probability);

/// Largest value of each whole block of `length` entries; what is left over joins the last one.
[[nodiscard]] std::vector<double> block_maxima(const Eigen::Ref<const Eigen::VectorXd>& values,
                                               std::int64_t length);

/// The highest rate, per s, that is compatible with `count` alarms in `seconds` at 95 % confidence
/// (one-sided, Poisson): 3 / seconds for none.
[[nodiscard]] double highest_rate(std::int64_t count, double seconds);

/// Probability of `count` or more alarms where `expected` are expected (Poisson).
[[nodiscard]] double probability_of_as_many(std::int64_t count, double expected);

}  // namespace offnominal::desk
