// Random draws that are the same with every standard library: the distributions of <random> are
// not specified bit by bit, its engines are.
#pragma once

#include <cstdint>
#include <random>
#include <string_view>

namespace offnominal::sim::hidden {

/// What a sequence of draws is for. Each has a generator of its own, so that another effect or
/// another noise level leaves the arm and its motion as they were.
enum class Stream : std::uint64_t {
  kArm = 1,
  kKnowledge,
  kEffects,
  kOutside,
  kMotion,
  kHoldoutMotion,
  kNoise,
  kContact,
  kDataFault,
};

/// A number that the seed draws: uniformly, or with equal chances per octave.
struct DrawnNumber {
  std::string_view of;
  double low = 0.0;
  double high = 0.0;
  std::string_view unit = "";
  bool per_octave = false;
};

/// Two draws in one expression come in an order that the compiler chooses: each wants a statement,
/// or a place in braces.
class Draws {
 public:
  /// `index` tells draws for the same purpose apart: the effect, or the run.
  Draws(std::uint64_t seed, Stream stream, std::uint64_t index = 0);

  double uniform(double low, double high);
  /// Equal chances per octave; 0 < low < high.
  double log_uniform(double low, double high);
  double from(const DrawnNumber& number);
  /// -1 or 1.
  double sign();
  /// Of that size, with either sign.
  double either_sign(double low, double high);
  /// 0 to count - 1; count > 0.
  int below(int count);
  /// Mean 0, standard deviation 1 (Box-Muller).
  double gaussian();

 private:
  std::mt19937_64 generator_;
};

}  // namespace offnominal::sim::hidden
