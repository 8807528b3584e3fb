#include "compare/before_after.hpp"

#include <fmt/format.h>

#include "common/text_table.hpp"

namespace offnominal::desk {

bool rises(double before, double after, double torque) {
  constexpr double kNegligible = 0.005;  // of the torque
  return after > (1 + kWorthAnEffect) * before && after - before > kNegligible * torque;
}

bool BeforeAfter::rises() const { return desk::rises(before_percent, after_percent, 100); }

std::vector<BeforeAfter> before_after(const std::vector<JointComparison>& before,
                                      const std::vector<JointComparison>& after) {
  std::vector<BeforeAfter> result;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const JointComparison& old_one = before[i];
    const JointComparison& new_one = after[i];
    result.push_back({old_one.joint, old_one.unit, old_one.relative_error_percent,
                      new_one.relative_error_percent, old_one.rms_error, new_one.rms_error});
  }
  return result;
}

std::vector<BeforeAfter> before_after(const Comparison& before, const Comparison& after) {
  return before_after(before.joints, after.joints);
}

std::string text_of(const std::vector<BeforeAfter>& joints) {
  const TextTable table({{"joint", -6}, {"error before", 26}, {"error after", 26}, {"fall", 10}});
  std::string text = table.heading();
  for (const BeforeAfter& error : joints) {
    const auto both = [&](double percent, double rms) {
      return fmt::format("{:.2f} % ({:.4g} {})", percent, rms, error.unit);
    };
    text += table.row(error.joint + 1, both(error.before_percent, error.before_rms),
                      both(error.after_percent, error.after_rms),
                      fmt::format("{:.1f} %", 100 * error.fall()));
  }
  return text;
}

}  // namespace offnominal::desk
