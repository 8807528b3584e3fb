#include "first_motion.hpp"

#include <cmath>
#include <numbers>

#include "offnominal/sim/hidden/draws.hpp"

namespace offnominal::bench {

using Eigen::Index;
using sim::hidden::Draws;
using sim::hidden::Nominal;
using sim::hidden::Stream;

namespace {

constexpr double kTurn = 2 * std::numbers::pi;
constexpr double kRateHz = 100;
// Apart from the indices that the simulator itself uses in this stream.
constexpr std::uint64_t kFirstIndex = 1000;

Draws draws_for(std::uint64_t seed, int attempt) {
  return {seed, Stream::kMotion, kFirstIndex + static_cast<std::uint64_t>(attempt)};
}

DesiredPositions at_rest(const Nominal& nominal, double duration_s) {
  const auto rows = static_cast<Index>(duration_s * kRateHz) + 1;
  DesiredPositions still{
      Eigen::VectorXd::LinSpaced(rows, 0, static_cast<double>(rows - 1) / kRateHz),
      Eigen::MatrixXd(rows, 2)};
  for (std::size_t j = 0; j < 2; ++j) {
    const auto& joint = nominal.joints[j];
    still.q.col(static_cast<Index>(j))
        .setConstant((joint.position_min_rad + joint.position_max_rad) / 2);
  }
  return still;
}

struct Range {
  double low;
  double high;
};

void add_sine(DesiredPositions& to, Index joint, Range amplitude_rad, Range hz, Draws& draws) {
  const double turns = kTurn * draws.uniform(hz.low, hz.high);
  const double amplitude = draws.uniform(amplitude_rad.low, amplitude_rad.high);
  const double phase = draws.uniform(0, kTurn);
  to.q.col(joint).array() += amplitude * (turns * to.t_s.array() + phase).sin();
}

// A triangle whose corners are rounded over a twentieth of its period.
void add_one_speed(DesiredPositions& to, Index joint, Draws& draws) {
  constexpr double kRound = 0.97;
  const double speed_rad_s = draws.uniform(0.1, 0.4);
  const double amplitude_rad = draws.uniform(0.2, 0.5);
  const double hz = speed_rad_s / (4 * amplitude_rad);
  to.q.col(joint).array() +=
      amplitude_rad / std::asin(kRound) * (kRound * (kTurn * hz * to.t_s.array()).sin()).asin();
}

}  // namespace

DesiredPositions poor_positions(const Nominal& nominal, std::uint64_t seed, int attempt) {
  Draws draws = draws_for(seed, attempt);
  DesiredPositions motion = at_rest(nominal, 30);
  switch (draws.below(4)) {
    case 0:  // one speed
      for (Index j = 0; j < 2; ++j) {
        add_one_speed(motion, j, draws);
      }
      break;
    case 1:  // a small range
      for (Index j = 0; j < 2; ++j) {
        add_sine(motion, j, {0.02, 0.05}, {0.3, 0.8}, draws);
      }
      break;
    case 2:  // one slow sinusoid
      for (Index j = 0; j < 2; ++j) {
        add_sine(motion, j, {0.2, 0.5}, {0.08, 0.2}, draws);
      }
      break;
    default:  // one load
      motion.q.col(0).array() += draws.either_sign(0.3, 1.0);
      add_sine(motion, 1, {0.05, 0.2}, {0.1, 0.4}, draws);
      break;
  }
  return motion;
}

DesiredPositions short_positions(const Nominal& nominal, std::uint64_t seed, int attempt) {
  Draws draws = draws_for(seed, attempt);
  DesiredPositions motion = at_rest(nominal, draws.uniform(7, 11));
  for (Index j = 0; j < 2; ++j) {
    add_sine(motion, j, {0.4, 0.8}, {0.12, 0.3}, draws);
    add_sine(motion, j, {0.1, 0.3}, {0.5, 1.0}, draws);
  }
  return motion;
}

}  // namespace offnominal::bench
