#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include "common/nearest.hpp"
#include "common/number.hpp"
#include "robot/bound_text.hpp"

namespace offnominal::desk {

std::string joint_bounds_text(const std::vector<JointBoundSettings>& joints) {
  const auto list = [](const std::vector<double>& values) {
    return "[" + list_of(values, shortest_real) + "]";
  };
  std::vector<double> values;
  std::vector<double> errors;
  std::string tables;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const JointBoundSettings& joint = joints[i];
    values.push_back(joint.at.empty() ? joint.value[0] : 0);
    errors.push_back(joint.momentum_error);
    if (joint.at.empty()) continue;
    tables += (tables.empty() ? "{joint = " : ", {joint = ") + std::to_string(i + 1) +
              ", at = " + list(joint.at) + ", value = " + list(joint.value) + "}";
  }
  std::string text = "kind = \"per_joint\"\nvalue = " + list(values);
  if (!tables.empty()) text += "\nover_speed = [" + tables + "]";
  if (*std::max_element(errors.begin(), errors.end()) > 0) {
    text += "\nmomentum_error = " + list(errors);
  }
  return text;
}

}  // namespace offnominal::desk
