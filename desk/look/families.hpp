#pragma once

#include <string>
#include <vector>

#include "look/roles.hpp"

namespace offnominal::desk {

struct FamilyMember {
  int number = -1;    // of the joint, -1: it has none
  std::string joint;  // its words in small letters, where the family goes by names
  std::string column;
  bool is_constant = false;
};

// Columns of one quantity, one for each joint.
struct Family {
  std::string name;  // with '#' for the number, or '*' for the joint's name
  Role role = Role::kNone;
  bool of_motor = false;
  // What was asked for, what acts from outside, what a model says: of the role that it would have.
  bool is_measured = true;
  std::vector<FamilyMember> members;
};

// By the last number of their names, in its order.
[[nodiscard]] std::vector<Family> numbered_families(const std::vector<NamedColumn>& columns);

// By what stands beside the word of the quantity, in the columns' order; a column may be of
// several.
[[nodiscard]] std::vector<Family> families_by_name(const std::vector<NamedColumn>& columns);

// The family with the members that bear the names of joints, in the joints' order; no members where
// a joint is missing, or has two columns. "joint", "link" and "axis" beside a name do not count.
[[nodiscard]] Family in_order_of(const Family& family, const std::vector<std::string>& joints);

// The words of a name but those of quantities and numbers.
[[nodiscard]] std::vector<std::string> other_words(const std::string& name);

// Takes from `families` those that are not measured: by their words, or by a letter that the name
// of another one of their role lacks ("q_d_1" beside "q_1", "tau_c_1" beside "tau_1"). Alone, such
// a letter may be anything.
[[nodiscard]] std::vector<Family> take_not_measured(std::vector<Family>& families);

// Whether the name of a numbered family has such a letter, alone as it may be.
[[nodiscard]] bool may_be_asked_for(const Family& family);

}  // namespace offnominal::desk
