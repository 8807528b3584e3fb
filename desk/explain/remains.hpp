#pragma once

#include <string>

#include "explain/explain.hpp"

// What is left of a joint's error beside what was found, and what is said of it.

namespace offnominal::desk {

// What is left stands above the noise floor, and is worth a word.
bool stands_out(const JointErrors& joint);

// The joint where what is left stands furthest above the noise floor, and is worth a name; null
// where none does.
const JointErrors* above_noise(const Explanation& e);

const JointErrors& errors_of(const Explanation& e, Eigen::Index joint);

Remains remains_of(const Explanation& e, const JointErrors& joint);

// "in recording 1 from 3.2 to 4.1 s"; the first few.
std::string words_of_times(const std::vector<LoudSpan>& when);

std::string words_of(const Remains& left, const std::string& unit);

// "a torque over position of a shape that no known effect has; joint_stiffness is 60 % of it".
std::string words_of(const OverVariable& shape);

}  // namespace offnominal::desk
