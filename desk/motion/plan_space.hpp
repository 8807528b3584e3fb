#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "motion/trajectory.hpp"

namespace offnominal::desk::motion {

// The family's motions as points of the unit cube, for an optimiser.
class PlanSpace {
 public:
  PlanSpace(std::size_t joints, double duration_s) : joints_(joints), duration_s_(duration_s) {}

  [[nodiscard]] std::size_t dimension() const;
  [[nodiscard]] MotionPlan plan_at(const std::vector<double>& point) const;
  // Uniformly distributed; the same on every machine.
  [[nodiscard]] std::vector<double> random_point(std::uint64_t seed) const;

 private:
  std::size_t joints_;
  double duration_s_;
};

// One slow sine per joint, to and fro at the same time: what does not tell much apart.
MotionPlan plain_plan(std::size_t joints, double duration_s);

}  // namespace offnominal::desk::motion
