#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "compare/compare.hpp"

namespace offnominal::desk {

// What an error has to fall by to be worth an effect, and may rise by elsewhere: share of itself.
inline constexpr double kWorthAnEffect = 0.05;

// Error of one joint with the old model and with the new one, on the same samples.
struct BeforeAfter {
  std::size_t joint = 0;
  std::string unit;
  double before_percent = 0;  // 100 |tau - tau_m| / |tau|
  double after_percent = 0;
  double before_rms = 0;  // N m or N
  double after_rms = 0;

  // Share of the rms error that is gone: 1 all of it, below 0 where the error has grown.
  [[nodiscard]] double fall() const { return 1 - after_rms / before_rms; }
  // Of the joint's torque, N m or N; NaN where both errors are 0.
  [[nodiscard]] double rms_torque() const {
    return 100 * (before_rms + after_rms) / (before_percent + after_percent);
  }
  // rises() of it.
  [[nodiscard]] bool rises() const;
};

// Whether an error on data that no fit has seen rises so much that it speaks against a new model:
// by more than a twentieth of itself, and by more than is next to nothing of the torque (rms, N m
// or N).
bool rises(double before, double after, double torque);

// Joint by joint, of two models on the same samples.
std::vector<BeforeAfter> before_after(const std::vector<JointComparison>& before,
                                      const std::vector<JointComparison>& after);
// Of two models on one recording.
std::vector<BeforeAfter> before_after(const Comparison& before, const Comparison& after);

// A table of them, a line per joint: relative and rms error before and after, and the fall.
std::string text_of(const std::vector<BeforeAfter>& joints);

}  // namespace offnominal::desk
