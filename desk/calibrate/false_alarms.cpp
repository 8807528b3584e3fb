#include "calibrate/false_alarms.hpp"

#include <algorithm>
#include <boost/math/distributions/poisson.hpp>
#include <boost/math/special_functions/gamma.hpp>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace offnominal::desk {
namespace {

struct LMoments {
  double mean = 0;
  double scale = 0;  // half the mean distance of two values
  double skewness = 0;
};

LMoments l_moments_of(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const auto n = static_cast<double>(values.size());
  double b0 = 0;
  double b1 = 0;
  double b2 = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto before = static_cast<double>(i);
    b0 += values[i] / n;
    b1 += values[i] * before / (n * (n - 1));
    b2 += values[i] * before * (before - 1) / (n * (n - 1) * (n - 2));
  }
  const double scale = 2 * b1 - b0;
  const double third = 6 * b2 - 6 * b1 + b0;
  return {b0, scale, scale > 0 ? third / scale : 0};
}

}  // namespace

ExtremeLaw extreme_law_of(std::vector<double> maxima) {
  if (maxima.size() < static_cast<std::size_t>(kFewestBlocks)) {
    throw std::invalid_argument("too few blocks for a law of their maxima");
  }
  const LMoments moments = l_moments_of(std::move(maxima));
  // Hosking's approximation of the shape, good to 9e-4,.
  const double c = 2 / (3 + moments.skewness) - std::numbers::ln2 / std::log(3.0);
  const double shape = 7.8590 * c + 2.9554 * c * c;
  if (!(shape < 0) || !(moments.scale > 0)) {
    const double scale = moments.scale / std::numbers::ln2;
    return {moments.mean - std::numbers::egamma * scale, scale, 0};
  }
  const double gamma = boost::math::tgamma(1 + shape);
  const double scale = moments.scale * shape / ((1 - std::pow(2.0, -shape)) * gamma);
  return {moments.mean - scale * (1 - gamma) / shape, scale, shape};
}

double exceeded_with(const ExtremeLaw& law, double probability) {
  const double reduced = -std::log(-std::log1p(-probability));
  if (law.shape == 0) return law.location + law.scale * reduced;
  return law.location - law.scale * std::expm1(-law.shape * reduced) / law.shape;
}

std::vector<double> block_maxima(const Eigen::Ref<const Eigen::VectorXd>& values,
                                 std::int64_t length) {
  std::vector<double> maxima;
  const Eigen::Index blocks = values.size() / length;
  for (Eigen::Index block = 0; block < blocks; ++block) {
    const Eigen::Index begin = block * length;
    const Eigen::Index end = block + 1 == blocks ? values.size() : begin + length;
    maxima.push_back(values.segment(begin, end - begin).maxCoeff());
  }
  return maxima;
}

double highest_rate(std::int64_t count, double seconds) {
  // The Poisson mean under which `count` or fewer have a probability of 5 %.
  return boost::math::gamma_q_inv(static_cast<double>(count) + 1, 0.05) / seconds;
}

double probability_of_as_many(std::int64_t count, double expected) {
  if (count <= 0) return 1;
  if (!(expected > 0)) return 0;
  const boost::math::poisson_distribution<double> law(expected);
  return boost::math::cdf(boost::math::complement(law, static_cast<double>(count - 1)));
}

}  // namespace offnominal::desk
