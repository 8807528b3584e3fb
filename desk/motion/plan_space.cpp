#include "motion/plan_space.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace offnominal::desk::motion {
namespace {

// The sines' frequencies, one per band of equal width on a logarithmic scale. Industrial joints
// follow 2 Hz; the slowest still goes to and fro twice.
constexpr double kSlowestHz = 0.08;
constexpr double kFastestHz = 2.0;
constexpr std::size_t kPerJoint = 2 + 3 * kSines + 3 + kPoses;

// `pose`, or one that is far enough from where the joint comes from: a move that is hardly one
// would be a rest.
double away_from(double from, double pose) {
  constexpr double kLeast = 0.3;
  if (std::abs(pose - from) >= kLeast) return pose;
  const double side = pose >= from ? kLeast : -kLeast;
  return std::abs(from + side) <= 1 ? from + side : from - side;
}

// Takes the coordinates of a point one after the other.
class Reader {
 public:
  explicit Reader(const std::vector<double>& point) : point_(point) {}
  double between(double low, double high) { return low + (high - low) * point_[next_++]; }
  double turn() { return between(0, 2 * std::numbers::pi); }

 private:
  const std::vector<double>& point_;
  std::size_t next_ = 0;
};

}  // namespace

std::size_t PlanSpace::dimension() const { return 1 + kPerJoint * joints_; }

MotionPlan PlanSpace::plan_at(const std::vector<double>& point) const {
  Reader read(point);
  MotionPlan plan;
  plan.slow_share = read.between(0.15, 0.45);
  const double slowest = std::max(kSlowestHz, 2 / (duration_s_ * (1 - plan.slow_share)));
  const double octaves = std::max(1.0, std::log2(kFastestHz / slowest));
  for (std::size_t j = 0; j < joints_; ++j) {
    JointPlan joint;
    joint.home = read.between(-0.5, 0.5);
    joint.reach = read.between(0.4, 1);
    for (std::size_t i = 0; i < kSines; ++i) {
      JointPlan::Sine one;
      one.speed = read.between(0.1, 1);
      const double part = static_cast<double>(i) + read.between(0, 1);
      one.frequency_hz = slowest * std::exp2(octaves * part / kSines);
      one.phase_rad = read.turn();
      joint.sines.push_back(one);
    }
    joint.swell_depth = read.between(0.3, 0.9);
    joint.swell_hz = read.between(0.06, 0.12);
    joint.swell_phase_rad = read.turn();
    for (std::size_t i = 0; i < kPoses; ++i) {
      const double from = i == 0 ? joint.home : joint.poses.back();
      joint.poses.push_back(away_from(from, read.between(-1, 1)));
    }
    plan.joints.push_back(std::move(joint));
  }
  return plan;
}

std::vector<double> PlanSpace::random_point(std::uint64_t seed) const {
  std::mt19937_64 generator(seed);
  std::vector<double> point(dimension());
  for (double& x : point) x = std::ldexp(static_cast<double>(generator() >> 11U), -53);
  return point;
}

MotionPlan plain_plan(std::size_t joints, double duration_s) {
  MotionPlan plan;
  plan.slow_share = 0;
  JointPlan joint;
  joint.reach = 0.5;
  joint.sines = {{1, std::max(0.1, 2 / duration_s), 0}};
  joint.swell_depth = 0;
  plan.joints.assign(joints, joint);
  return plan;
}

}  // namespace offnominal::desk::motion
