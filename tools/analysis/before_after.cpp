#include "analysis/before_after.hpp"

#include <fmt/format.h>

namespace offnominal::tools {

std::vector<BeforeAfter> before_after(const Comparison& before, const Comparison& after) {
  std::vector<BeforeAfter> result;
  for (std::size_t i = 0; i < before.joints.size(); ++i) {
    const JointComparison& old_one = before.joints[i];
    const JointComparison& new_one = after.joints[i];
    result.push_back({old_one.joint, old_one.unit, old_one.relative_error_percent,
                      new_one.relative_error_percent, old_one.rms_error, new_one.rms_error});
  }
  return result;
}

std::string text_of(const std::vector<BeforeAfter>& joints) {
  std::string text =
      fmt::format("{:<6} {:>26} {:>26} {:>10}\n", "joint", "error before", "error after", "fall");
  for (const BeforeAfter& error : joints) {
    const auto both = [&](double percent, double rms) {
      return fmt::format("{:.2f} % ({:.4g} {})", percent, rms, error.unit);
    };
    text += fmt::format("{:<6} {:>26} {:>26} {:>8.1f} %\n", error.joint + 1,
                        both(error.before_percent, error.before_rms),
                        both(error.after_percent, error.after_rms), 100 * error.fall());
  }
  return text;
}

}  // namespace offnominal::tools
