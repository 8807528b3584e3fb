#include "explain/replay_null.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <span>

#include "common/parallel.hpp"

namespace offnominal::desk {

using Eigen::Index;
using Eigen::VectorXd;

namespace {

constexpr double kBlockS = 0.5;

// The noise with its blocks shuffled and their signs drawn, alike for all joints.
VectorXd shuffled(const RowLayout& layout, const VectorXd& noise, std::mt19937_64& generator) {
  VectorXd played(noise.size());
  for (std::size_t r = 0; r < layout.recording_count(); ++r) {
    const Index n = layout.samples(r);
    const auto length = std::max<Index>(1, std::lround(kBlockS / layout.period_s(r)));
    std::vector<Index> source(static_cast<std::size_t>(n / length));
    std::iota(source.begin(), source.end(), 0);
    for (std::size_t i = source.size(); i > 1; --i) {
      std::swap(source[i - 1], source[generator() % i]);
    }
    for (Index i = 0; i < n; ++i) {
      const auto block = static_cast<std::size_t>(i / length);
      const Index from = block < source.size() ? source[block] * length + i % length : i;
      for (Index joint = 0; joint < layout.joint_count(); ++joint) {
        played[layout.begin(r, joint) + i] = noise[layout.begin(r, joint) + from];
      }
    }
    for (Index start = 0; start < n; start += length) {
      if ((generator() & 1U) == 0) continue;
      for (Index i = start; i < std::min(n, start + length); ++i) {
        for (Index joint = 0; joint < layout.joint_count(); ++joint) {
          played[layout.begin(r, joint) + i] *= -1;
        }
      }
    }
  }
  return played;
}

double best_gain(const Judge& judge, std::span<const ActingColumns> columns) {
  double best = 0;
  for (const ActingColumns& one : columns) best = std::max(best, judge.joint_gain(one));
  return best;
}

}  // namespace

double replay_p(const Data& data, const ModelFit& fit, const VectorXd& noise, const Term& term,
                int replays, std::uint64_t seed, int threads) {
  const std::vector<ShapePoint> points = Search::grid_of(term);
  std::vector<ActingColumns> columns(points.size() + 1);
  parallel_for(columns.size(), threads, [&](std::size_t i) {
    Term at = term;
    if (i < points.size()) at.shape = points[i];
    columns[i] = ActingColumns(data.layout, columns_of(data, at));
  });
  const Judge judge(fit.remainder);
  const double measured = best_gain(judge, std::span(columns).last(1));
  std::vector<char> reached(static_cast<std::size_t>(replays));
  parallel_for(reached.size(), threads, [&](std::size_t i) {
    std::mt19937_64 generator(seed + 7919 * (i + 1));
    Remainder played = fit.remainder;
    played.residual = played.beside_basis(played.weighted(shuffled(data.layout, noise, generator)));
    played.energy = data.layout.energy(played.residual);
    reached[i] = static_cast<char>(best_gain(Judge(played, judge), columns) >= measured);
  });
  const auto count = static_cast<double>(std::count(reached.begin(), reached.end(), 1));
  return (1 + count) / (1 + static_cast<double>(replays));
}

}  // namespace offnominal::desk
