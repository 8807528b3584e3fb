#include "motion/trajectory.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace offnominal::desk::motion {

using Eigen::Index;
using Eigen::MatrixXd;

namespace {

constexpr double kTurn = 2 * std::numbers::pi;

// A value with its first two derivatives in time.
struct Jet {
  double value = 0;
  double first = 0;
  double second = 0;
};
Jet operator*(const Jet& a, const Jet& b) {
  return {a.value * b.value, a.first * b.value + a.value * b.first,
          a.second * b.value + 2 * a.first * b.first + a.value * b.second};
}
Jet operator*(double factor, const Jet& a) {
  return {factor * a.value, factor * a.first, factor * a.second};
}
Jet& operator+=(Jet& a, const Jet& b) {
  a = {a.value + b.value, a.first + b.first, a.second + b.second};
  return a;
}

Jet sine(double amplitude, double rate_rad_s, double phase_rad, double t_s) {
  const double s = amplitude * std::sin(rate_rad_s * t_s + phase_rad);
  const double c = amplitude * std::cos(rate_rad_s * t_s + phase_rad);
  return {s, rate_rad_s * c, -rate_rad_s * rate_rad_s * s};
}

// 0 before 0 and 1 after `rise_s`, with two continuous derivatives.
Jet step_up(double t_s, double rise_s) {
  if (t_s <= 0) return {};
  if (t_s >= rise_s) return {1, 0, 0};
  const double x = t_s / rise_s;
  return {x * x * x * (10 + x * (-15 + 6 * x)), 30 * x * x * (1 - x) * (1 - x) / rise_s,
          60 * x * (1 - x) * (1 - 2 * x) / (rise_s * rise_s)};
}

// 1 between 0 and `length_s`, smoothly to 0 at both ends and beyond.
Jet window(double t_s, double length_s) {
  const double rise_s = std::min(0.8, length_s / 4);
  const Jet down = step_up(t_s - (length_s - rise_s), rise_s);
  return step_up(t_s, rise_s) * Jet{1 - down.value, -down.first, -down.second};
}

// From 0 at time 0 to 1 at `length_s`: a constant speed between smooth starts and stops.
Jet ramp(double t_s, double length_s) {
  if (t_s <= 0) return {};
  if (t_s >= length_s) return {1, 0, 0};
  const double blend_s = 0.2 * length_s;
  const double speed = 1 / (length_s - blend_s);
  // Integral of step_up(): blend_s (2.5 x^4 - 3 x^5 + x^6).
  const auto begin = [&](double since_s) {
    const double x = since_s / blend_s;
    const Jet up = step_up(since_s, blend_s);
    return Jet{speed * blend_s * x * x * x * x * (2.5 + x * (-3 + x)), speed * up.value,
               speed * up.first};
  };
  if (t_s < blend_s) return begin(t_s);
  const double left_s = length_s - t_s;
  if (left_s < blend_s) {
    const Jet mirrored = begin(left_s);
    return {1 - mirrored.value, mirrored.first, -mirrored.second};
  }
  return {speed * (t_s - blend_s / 2), speed, 0};
}

Jet oscillation_at(const JointPlan& joint, double t_s, double length_s) {
  Jet sum;
  for (const JointPlan::Sine& one : joint.sines) {
    const double rate = kTurn * one.frequency_hz;
    sum += sine(one.speed / rate, rate, one.phase_rad, t_s);
  }
  Jet swell = sine(-joint.swell_depth / 2, kTurn * joint.swell_hz, joint.swell_phase_rad, t_s);
  swell.value += 1 - joint.swell_depth / 2;
  return window(t_s, length_s) * (swell * sum);
}

// Relative to home, of half the range.
Jet poses_at(const JointPlan& joint, double t_s, double length_s) {
  if (t_s <= 0 || t_s >= length_s || joint.poses.empty()) return {};
  const double slot_s = length_s / static_cast<double>(joint.poses.size() + 1);
  const auto slot = std::min(joint.poses.size(), static_cast<std::size_t>(t_s / slot_s));
  const double from = slot == 0 ? 0 : joint.poses[slot - 1] - joint.home;
  const double to = slot == joint.poses.size() ? 0 : joint.poses[slot] - joint.home;
  Jet at = (to - from) * ramp(t_s - static_cast<double>(slot) * slot_s, slot_s);
  at.value += from;
  return at;
}

Motion empty_motion(Index samples, Index joints, double rate_hz) {
  Motion motion;
  motion.t_s = Eigen::VectorXd::LinSpaced(samples, 0, static_cast<double>(samples - 1)) / rate_hz;
  for (MatrixXd* m : {&motion.q, &motion.dq, &motion.ddq}) m->setZero(samples, joints);
  return motion;
}

void put(const Jet& jet, Index row, Index joint, Motion& motion) {
  motion.q(row, joint) = jet.value;
  motion.dq(row, joint) = jet.first;
  motion.ddq(row, joint) = jet.second;
}

}  // namespace

PlanParts parts_of(const MotionPlan& plan, const std::vector<double>& half_range, double duration_s,
                   double rate_hz) {
  const auto joints = static_cast<Index>(plan.joints.size());
  const auto samples = static_cast<Index>(std::llround(duration_s * rate_hz)) + 1;
  PlanParts parts{empty_motion(samples, joints, rate_hz), empty_motion(samples, joints, rate_hz),
                  0};
  const double slow_s = plan.slow_share * duration_s;
  const double fast_s = duration_s - slow_s;
  parts.slow_at = std::min(samples, static_cast<Index>(std::ceil(fast_s * rate_hz)));
  for (Index joint = 0; joint < joints; ++joint) {
    const auto j = static_cast<std::size_t>(joint);
    for (Index row = 0; row < samples; ++row) {
      const double t_s = parts.poses.t_s[row];
      if (t_s < fast_s) {
        put(oscillation_at(plan.joints[j], t_s, fast_s), row, joint, parts.oscillation);
      }
      const Jet pose = half_range[j] * poses_at(plan.joints[j], t_s - fast_s, slow_s);
      put(pose, row, joint, parts.poses);
    }
  }
  return parts;
}

Motion combined(const PlanParts& parts, const std::vector<JointScale>& scale) {
  Motion motion = parts.poses;
  for (std::size_t j = 0; j < scale.size(); ++j) {
    const auto joint = static_cast<Index>(j);
    for (const auto part : {&Motion::q, &Motion::dq, &Motion::ddq}) {
      (motion.*part).col(joint) = scale[j].poses * (parts.poses.*part).col(joint) +
                                  scale[j].oscillation * (parts.oscillation.*part).col(joint);
    }
    motion.q.col(joint).array() += scale[j].home;
  }
  return motion;
}

}  // namespace offnominal::desk::motion
