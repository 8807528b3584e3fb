#include "calibrate/false_alarms.hpp"

#include <algorithm>
#include <boost/math/distributions/poisson.hpp>
#include <boost/math/special_functions/gamma.hpp>
#include <cmath>
#include <functional>
#include <stdexcept>

namespace offnominal::desk {
namespace {

// So many of the largest maxima make the tail: what the rest is like says nothing of it.
constexpr double kShareOfTail = 0.15;
// Of the shape, before any maximum is seen: heavy and light tails are as likely, and what
// hydrologists allow (Martins and Stedinger, Water Resources Research 36(3), 2000) is as wide.
constexpr double kPriorOfShape = 0.12;

struct Tail {
  double above = 0;     // where it begins
  double share = 0;     // of the blocks whose maximum is beyond
  double mean = 0;      // of what they are beyond by
  double distance = 0;  // half the mean distance of two of these
  double count = 0;
};

Tail tail_of(std::vector<double> maxima) {
  std::sort(maxima.begin(), maxima.end(), std::greater<>());
  const auto n = static_cast<double>(maxima.size());
  const auto count = std::clamp<std::size_t>(static_cast<std::size_t>(kShareOfTail * n),
                                             kFewestBlocks - 1, maxima.size() - 1);
  Tail tail;
  tail.above = maxima[count];
  tail.count = static_cast<double>(count);
  tail.share = tail.count / n;
  double weighted = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double excess = maxima[i] - tail.above;
    tail.mean += excess / tail.count;
    weighted += excess * static_cast<double>(count - 1 - i) / (tail.count * (tail.count - 1));
  }
  tail.distance = 2 * weighted - tail.mean;
  return tail;
}

// Above 0: heavier than an exponential tail.
double heaviness_of(const Tail& tail) {
  if (!(tail.distance > 0)) return 0;
  const double found = std::max(0.0, 2 - tail.mean / tail.distance);
  const double variance = (1 + found) * (1 + found) / tail.count;
  constexpr double kPrior = kPriorOfShape * kPriorOfShape;
  return std::min(found * kPrior / (kPrior + variance), 0.9);
}

}  // namespace

ExtremeLaw extreme_law_of(std::vector<double> maxima) {
  if (maxima.size() < static_cast<std::size_t>(kFewestBlocks)) {
    throw std::invalid_argument("too few blocks for a law of their maxima");
  }
  const Tail tail = tail_of(std::move(maxima));
  const double heavy = heaviness_of(tail);
  const double scale_of_tail = (1 - heavy) * tail.mean;
  // The law of the maxima that has this tail: exp(-rate) is its share below where the tail begins.
  const double rate = -std::log1p(-tail.share);
  if (heavy == 0) return {tail.above + scale_of_tail * std::log(rate), scale_of_tail, 0};
  const double scale = scale_of_tail * std::pow(rate, heavy);
  return {tail.above + (scale - scale_of_tail) / heavy, scale, -heavy};
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
