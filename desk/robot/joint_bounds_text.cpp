#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include "common/nearest.hpp"
#include "common/number.hpp"
#include "robot/bound_names.hpp"
#include "robot/bound_text.hpp"

namespace offnominal::desk {
namespace {

std::string bracketed(const std::vector<double>& values) {
  return "[" + list_of(values, shortest_real) + "]";
}

template <typename Of>
std::vector<double> per_joint(const std::vector<JointBoundSettings>& joints, const Of& of) {
  std::vector<double> values;
  for (const JointBoundSettings& joint : joints) values.push_back(of(joint));
  return values;
}

// The tables over one variable; empty: no joint has one.
std::string tables_over(BoundVariable variable, const std::vector<JointBoundSettings>& joints) {
  std::string tables;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const JointBoundSettings& joint = joints[i];
    if (joint.at.empty() || joint.variable != variable) continue;
    tables += (tables.empty() ? "{joint = " : ", {joint = ") + std::to_string(i + 1) +
              ", at = " + bracketed(joint.at) + ", value = " + bracketed(joint.value) + "}";
  }
  return tables;
}

// "key = value" of the bounds of one filter, but for what both have.
std::vector<std::string> keys_of(const std::vector<JointBoundSettings>& joints) {
  std::vector<std::string> keys;
  keys.push_back("value = " + bracketed(per_joint(joints, [](const auto& joint) {
                   return joint.at.empty() ? joint.value[0] : 0;
                 })));
  for (const BoundVariable variable :
       {BoundVariable::kPosition, BoundVariable::kSpeed, BoundVariable::kTorque}) {
    const std::string tables = tables_over(variable, joints);
    if (!tables.empty()) {
      keys.push_back(key_of_tables(variable) + " = [" + tables + "]");
    }
  }
  const auto ratios = per_joint(joints, [](const auto& joint) { return joint.act_ratio; });
  if (*std::max_element(ratios.begin(), ratios.end()) > 1) {
    keys.push_back("act_ratio = " + bracketed(ratios));
  }
  return keys;
}

}  // namespace

std::string joint_bounds_text(const BoundSettings& bound) {
  std::string text = "kind = \"per_joint\"";
  for (const std::string& key : keys_of(bound.joints)) text += "\n" + key;
  const auto errors =
      per_joint(bound.joints, [](const auto& joint) { return joint.momentum_error; });
  if (*std::max_element(errors.begin(), errors.end()) > 0) {
    text += "\nmomentum_error = " + bracketed(errors);
  }
  if (bound.fast.empty()) return text;
  return text + "\nfast = {" + list_of(keys_of(bound.fast)) + "}";
}

}  // namespace offnominal::desk
