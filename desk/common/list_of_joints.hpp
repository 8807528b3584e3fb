#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

namespace offnominal::desk {

// "joint 3"; it counts from 0.
inline std::string at_joint(Eigen::Index joint) { return "joint " + std::to_string(joint + 1); }

// "joint 3", "joints 1, 2"; they count from 0.
inline std::string list_of_joints(const std::vector<Eigen::Index>& joints) {
  std::string words = joints.size() == 1 ? "joint " : "joints ";
  for (std::size_t i = 0; i < joints.size(); ++i) {
    words += (i == 0 ? "" : ", ") + std::to_string(joints[i] + 1);
  }
  return words;
}

}  // namespace offnominal::desk
