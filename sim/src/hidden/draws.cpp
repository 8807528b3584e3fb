#include "offnominal/sim/hidden/draws.hpp"

#include <cmath>
#include <numbers>

namespace offnominal::sim::hidden {
namespace {

// SplitMix64: spreads neighbouring numbers over all 64 bits.
std::uint64_t spread(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15U;
  x = (x ^ (x >> 30U)) * 0xbf58476d1ce4e5b9U;
  x = (x ^ (x >> 27U)) * 0x94d049bb133111ebU;
  return x ^ (x >> 31U);
}

}  // namespace

Draws::Draws(std::uint64_t seed, Stream stream, std::uint64_t index)
    : generator_(spread(spread(spread(seed) + static_cast<std::uint64_t>(stream)) + index)) {}

double Draws::uniform(double low, double high) {
  const double unit = static_cast<double>(generator_() >> 11U) * 0x1p-53;
  return low + (high - low) * unit;
}

double Draws::log_uniform(double low, double high) {
  return std::exp(uniform(std::log(low), std::log(high)));
}

double Draws::from(const DrawnNumber& number) {
  return number.per_octave ? log_uniform(number.low, number.high)
                           : uniform(number.low, number.high);
}

double Draws::sign() { return (generator_() >> 63U) != 0U ? 1.0 : -1.0; }

double Draws::either_sign(double low, double high) {
  const double side = sign();
  return side * uniform(low, high);
}

int Draws::below(int count) { return static_cast<int>(uniform(0.0, static_cast<double>(count))); }

double Draws::gaussian() {
  const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform(0.0, 1.0)));
  return radius * std::cos(2.0 * std::numbers::pi * uniform(0.0, 1.0));
}

}  // namespace offnominal::sim::hidden
