#include "analysis/before_after.hpp"

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

}  // namespace offnominal::tools
