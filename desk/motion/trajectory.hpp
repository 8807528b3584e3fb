#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "compare/motion.hpp"

// The family of motions that a design is chosen from. Every joint starts and ends at rest at its
// home. First it oscillates: a sum of sinusoids (J. Swevers et al., "Optimal robot excitation and
// identification", IEEE Trans. Robotics and Automation 13(5), 1997), which swells and fades, so
// that fast phases alternate with slow ones. Then it visits poses one after the other at constant
// speeds: what friction at low speed, load and offsets show themselves by. It never rests in
// between: what friction holds a joint at rest with is anybody's guess, so that a rest adds error
// and no knowledge. Position, velocity and acceleration are continuous.

namespace offnominal::desk::motion {

inline constexpr std::size_t kSines = 6;
inline constexpr std::size_t kPoses = 5;

// A motion of one joint, free of its limits: lengths are shares of half of the joint's range.
struct JointPlan {
  double home = 0;   // -1 .. 1, of half the range, from its middle
  double reach = 1;  // share of what the limits leave room for that is used, 0 .. 1
  struct Sine {
    double speed = 0;  // amplitude times angular frequency, relative to the other sines
    double frequency_hz = 0;
    double phase_rad = 0;
  };
  std::vector<Sine> sines;
  double swell_depth = 1;  // 0: steady, 1: down to standstill
  double swell_hz = 0.09;
  double swell_phase_rad = 0;
  std::vector<double> poses;  // -1 .. 1, of half the range, from its middle
};

struct MotionPlan {
  double slow_share = 0.3;  // of the time, visiting poses
  std::vector<JointPlan> joints;
};

// The two parts of a plan's motion apart, sampled evenly from 0 to the duration, as distances from
// home. Columns: joints.
struct PlanParts {
  Motion oscillation;        // of no particular size
  Motion poses;              // rad or m
  Eigen::Index slow_at = 0;  // the first row of the poses' stretch
};
PlanParts parts_of(const MotionPlan& plan, const std::vector<double>& half_range, double duration_s,
                   double rate_hz);

// How large a joint's parts are played, and where.
struct JointScale {
  double home = 0;         // rad or m
  double oscillation = 0;  // rad or m per unit of the sum of sines
  double poses = 1;        // factor on the poses' distance from home
};
Motion combined(const PlanParts& parts, const std::vector<JointScale>& scale);

}  // namespace offnominal::desk::motion
