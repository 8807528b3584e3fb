#pragma once

#include "explain/explain.hpp"

// What is said of each joint by itself.

namespace offnominal::desk {

// Whether the new robot file has all that was found of a joint.
bool is_all_written(const Explanation& e, Eigen::Index joint);

// Sets the answers, those that matter most first: by the share of their torque that was missing.
void judge_joints(Explanation& e);

}  // namespace offnominal::desk
