#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "offnominal/sim/recorded/recording.hpp"

namespace offnominal::sim::recorded {
namespace {

using Eigen::Index;
using hidden::Draws;

// q, dq and ddq of one joint at one time, added to the row.
struct Point {
  double q = 0, dq = 0, ddq = 0;
};

void put(Motion& motion, Index row, Index joint, const Point& point) {
  motion.q(row, joint) += point.q;
  motion.dq(row, joint) += point.dq;
  motion.ddq(row, joint) += point.ddq;
}

void add_sines(Motion& motion, Index joint, double reach, Draws& draws) {
  constexpr int kSines = 4;
  for (int k = 0; k < kSines; ++k) {
    const double w = 2 * std::numbers::pi * draws.log_uniform(0.1, 1.0);
    const double a = reach / kSines * draws.uniform(0.4, 1.0) / std::max(1.0, w / 4);
    const double phase = draws.uniform(0, 2 * std::numbers::pi);
    for (Index i = 0; i < motion.t_s.size(); ++i) {
      const double x = w * motion.t_s[i] + phase;
      put(motion, i, joint, {a * std::sin(x), a * w * std::cos(x), -a * w * w * std::sin(x)});
    }
  }
}

// From 0 to 1 with velocity and acceleration zero at both ends.
Point quintic(double share, double duration_s) {
  const double s = std::clamp(share, 0.0, 1.0);
  const double s2 = s * s;
  return {s2 * s * (10 - 15 * s + 6 * s2), 30 * s2 * (1 - 2 * s + s2) / duration_s,
          60 * s * (1 - 3 * s + 2 * s2) / (duration_s * duration_s)};
}

void add_moves(Motion& motion, Index joint, double from_s, double reach, double rest_s,
               Draws& draws) {
  double at = 0;
  double begin = from_s + draws.uniform(0, rest_s);
  const double end_s = motion.t_s[motion.t_s.size() - 1];
  while (begin < end_s) {
    const double to = draws.uniform(-reach, reach);
    const double duration = draws.uniform(0.6, 1.6) * std::sqrt(std::abs(to - at) + 0.1);
    for (Index i = 0; i < motion.t_s.size(); ++i) {
      if (motion.t_s[i] < begin) continue;
      const Point p = quintic((motion.t_s[i] - begin) / duration, duration);
      put(motion, i, joint, {(to - at) * p.q, (to - at) * p.dq, (to - at) * p.ddq});
    }
    at = to;
    begin += duration + draws.uniform(0.1, rest_s);
  }
}

void add_sweep(Motion& motion, Index joint, double until_s, double reach, Draws& draws) {
  const double w0 = 2 * std::numbers::pi * draws.uniform(0.05, 0.2);
  const double rise = 2 * std::numbers::pi * draws.uniform(0.4, 1.0) / until_s;
  const double phase = draws.uniform(0, 2 * std::numbers::pi);
  for (Index i = 0; i < motion.t_s.size(); ++i) {
    const double t = motion.t_s[i];
    // Smaller as it gets faster, and over at until_s.
    const double s = std::clamp(1 - t / until_s, 0.0, 1.0);
    const double a = reach * 0.6 * s * s * s;
    const double da = -3 * reach * 0.6 * s * s / until_s;
    const double dda = 6 * reach * 0.6 * s / (until_s * until_s);
    const double x = phase + w0 * t + rise * t * t / 2;
    const double w = w0 + rise * t;
    put(motion, i, joint,
        {a * std::sin(x), da * std::sin(x) + a * w * std::cos(x),
         dda * std::sin(x) + 2 * da * w * std::cos(x) +
             a * (rise * std::cos(x) - w * w * std::sin(x))});
  }
}

}  // namespace

Motion draw_motion(const MotionRequest& request, Draws& draws) {
  const auto rows = static_cast<Index>(request.rate_hz * request.duration_s);
  const Index joints = request.middle.size();
  Motion motion;
  motion.t_s = Eigen::VectorXd::LinSpaced(rows, 0, static_cast<double>(rows - 1) / request.rate_hz);
  motion.q = request.middle.transpose().replicate(rows, 1);
  motion.dq = Eigen::MatrixXd::Zero(rows, joints);
  motion.ddq = motion.dq;
  for (Index joint = 0; joint < joints; ++joint) {
    if (request.locked[static_cast<std::size_t>(joint)] != 0) continue;
    const double reach = request.reach[joint];
    constexpr double kRestS = 1.5;
    switch (request.family) {
      case MotionFamily::kSines:
        add_sines(motion, joint, reach, draws);
        break;
      case MotionFamily::kMoves:
        add_moves(motion, joint, 0, reach, kRestS, draws);
        break;
      case MotionFamily::kSweeps: {
        const double until_s = request.duration_s * draws.uniform(0.5, 0.8);
        add_sweep(motion, joint, until_s, reach, draws);
        add_moves(motion, joint, until_s, reach / 2, kRestS / 3, draws);
        break;
      }
    }
  }
  return motion;
}

}  // namespace offnominal::sim::recorded
