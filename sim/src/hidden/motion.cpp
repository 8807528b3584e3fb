#include "offnominal/sim/hidden/motion.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

namespace offnominal::sim::hidden {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double kTurn = 2.0 * std::numbers::pi;

struct Sine {
  double amplitude = 0.0, rate_rad_s = 1.0, phase_rad = 0.0;

  // Adds amplitude sin(rate t + phase) and its derivatives to one joint.
  void add(double t_s, Index joint, DesiredMotion& m) const {
    const double s = amplitude * std::sin(rate_rad_s * t_s + phase_rad);
    const double c = amplitude * std::cos(rate_rad_s * t_s + phase_rad);
    m.q[joint] += s;
    m.dq[joint] += rate_rad_s * c;
    m.ddq[joint] -= rate_rad_s * rate_rad_s * s;
  }
};

Sine drawn_sine(double amplitude, double low_hz, double high_hz, Draws& draws) {
  const double drawn = amplitude * draws.uniform(0.7, 1.2);
  const double rate = kTurn * draws.log_uniform(low_hz, high_hz);
  return {drawn, rate, draws.uniform(0.0, kTurn)};
}

// A sine whose amplitude swells and fades between 0 and twice the half: a carrier and two side
// bands, so that the derivatives need no product rule.
std::array<Sine, 3> swelling(const Sine& carrier, double swell_rad_s, double swell_phase_rad) {
  const double half = 0.5 * carrier.amplitude, quarter = 0.25 * carrier.amplitude;
  return {{{half, carrier.rate_rad_s, carrier.phase_rad},
           {quarter, carrier.rate_rad_s + swell_rad_s, carrier.phase_rad + swell_phase_rad},
           {quarter, carrier.rate_rad_s - swell_rad_s, carrier.phase_rad - swell_phase_rad}}};
}

std::vector<Sine> rich_joint(Draws& draws) {
  std::vector<Sine> sines = {drawn_sine(0.50, 0.10, 0.16, draws),
                             drawn_sine(0.32, 0.20, 0.30, draws)};
  const double swell = kTurn * draws.uniform(0.07, 0.11);
  const double swell_phase = draws.uniform(0.0, kTurn);
  constexpr double kAmplitude[4] = {0.26, 0.16, 0.11, 0.08};
  constexpr double kLowHz[4] = {0.36, 0.58, 0.85, 1.15};
  constexpr double kHighHz[4] = {0.50, 0.75, 1.05, 1.40};
  for (int i = 0; i < 4; ++i) {
    const Sine carrier = drawn_sine(kAmplitude[i], kLowHz[i], kHighHz[i], draws);
    for (const Sine& part : swelling(carrier, swell, swell_phase)) sines.push_back(part);
  }
  return sines;
}

Motion sum_of(const Eigen::Vector2d& centre_rad, const std::array<std::vector<Sine>, 2>& sines) {
  return [centre_rad, sines](double t_s) {
    DesiredMotion m{centre_rad, Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero()};
    for (std::size_t j = 0; j < 2; ++j) {
      for (const Sine& sine : sines[j]) sine.add(t_s, static_cast<Index>(j), m);
    }
    return m;
  };
}

// A triangle's Fourier series, ended after five terms: one speed to and fro with soft turns.
std::vector<Sine> to_and_fro(double amplitude_rad, double speed_rad_s) {
  const double rate = kTurn * speed_rad_s / (4.0 * amplitude_rad);
  std::vector<Sine> sines;
  for (int k = 1; k <= 9; k += 2) {
    const double sign = (k / 2) % 2 == 0 ? 1.0 : -1.0;
    const double share = sign * 8.0 / (std::numbers::pi * std::numbers::pi * k * k);
    sines.push_back({amplitude_rad * share, k * rate, 0.0});
  }
  return sines;
}

// Second derivatives of the natural cubic spline through (t, y).
VectorXd curvatures(const VectorXd& t, const VectorXd& y) {
  const Index n = t.size();
  VectorXd c = VectorXd::Zero(n), upper = VectorXd::Zero(n);
  for (Index i = 1; i + 1 < n; ++i) {
    const double before = t[i] - t[i - 1], after = t[i + 1] - t[i];
    const double slope = (y[i + 1] - y[i]) / after - (y[i] - y[i - 1]) / before;
    const double pivot = 2.0 * (before + after) - before * upper[i - 1];
    upper[i] = after / pivot;
    c[i] = (6.0 * slope - before * c[i - 1]) / pivot;
  }
  for (Index i = n - 2; i > 0; --i) c[i] -= upper[i] * c[i + 1];
  return c;
}

void require_motion(const VectorXd& t_s, const Eigen::MatrixXd& q_rad) {
  const std::string found = "given motion: found " + std::to_string(t_s.size()) + " times and " +
                            std::to_string(q_rad.rows()) + " x " + std::to_string(q_rad.cols()) +
                            " positions; ";
  if (t_s.size() < 2 || q_rad.rows() != t_s.size() || q_rad.cols() != 2) {
    throw std::invalid_argument(found + "allowed are n >= 2 times and n x 2 positions");
  }
  if (!t_s.allFinite() || !q_rad.allFinite()) {
    throw std::invalid_argument(found + "one of them is not a finite number");
  }
  if (t_s[0] != 0.0) throw std::invalid_argument(found + "the first time is not 0");
  for (Index i = 1; i < t_s.size(); ++i) {
    if (t_s[i] > t_s[i - 1]) continue;
    throw std::invalid_argument(found + "time " + std::to_string(i) + " does not rise");
  }
}

}  // namespace

Motion rich_motion(const Eigen::Vector2d& centre_rad, Draws& draws) {
  std::vector<Sine> first = rich_joint(draws);
  return sum_of(centre_rad, {std::move(first), rich_joint(draws)});
}

Motion poor_motion(const Eigen::Vector2d& centre_rad, Draws& draws) {
  std::array<std::vector<Sine>, 2> sines;
  const auto one = static_cast<std::size_t>(draws.below(2));
  switch (draws.below(3)) {
    case 0:  // one slow small sinusoid, the other joint at rest
      sines[one] = {drawn_sine(0.2, 0.1, 0.3, draws)};
      break;
    case 1: {  // one speed
      const double speed_rad_s = draws.uniform(0.1, 0.3);
      sines[one] = to_and_fro(draws.uniform(0.2, 0.4), speed_rad_s);
      break;
    }
    default:  // a tiny range
      for (auto& joint : sines) joint = {drawn_sine(0.035, 0.3, 0.8, draws)};
      break;
  }
  return sum_of(centre_rad, sines);
}

Motion given_motion(const VectorXd& t_s, const Eigen::MatrixXd& q_rad) {
  require_motion(t_s, q_rad);
  const std::array<VectorXd, 2> curvature = {curvatures(t_s, q_rad.col(0)),
                                             curvatures(t_s, q_rad.col(1))};
  return [t_s, q_rad, curvature](double t) {
    const Index n = t_s.size();
    DesiredMotion m{q_rad.row(n - 1).transpose(), Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero()};
    if (t > t_s[n - 1]) return m;
    const auto after = std::upper_bound(t_s.data(), t_s.data() + n - 1, t) - t_s.data();
    const Index i = std::clamp<Index>(after - 1, 0, n - 2);
    const double h = t_s[i + 1] - t_s[i], b = (t - t_s[i]) / h, a = 1.0 - b;
    for (Index j = 0; j < 2; ++j) {
      const double y0 = q_rad(i, j), y1 = q_rad(i + 1, j);
      const double c0 = curvature[static_cast<std::size_t>(j)][i];
      const double c1 = curvature[static_cast<std::size_t>(j)][i + 1];
      m.q[j] = a * y0 + b * y1 + ((a * a * a - a) * c0 + (b * b * b - b) * c1) * h * h / 6.0;
      m.dq[j] = (y1 - y0) / h + ((1.0 - 3.0 * a * a) * c0 + (3.0 * b * b - 1.0) * c1) * h / 6.0;
      m.ddq[j] = a * c0 + b * c1;
    }
    return m;
  };
}

}  // namespace offnominal::sim::hidden
