#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "log/named_columns.hpp"
#include "robot/robot.hpp"

// What the names of columns say of them. Nothing else does: two people call the same thing by other
// names, and what is guessed here is proposed and never used by itself.

namespace offnominal::desk {

enum class Role : std::uint8_t { kNone, kTime, kPosition, kVelocity, kTorque, kCurrent };

// "time", "position", "velocity", "torque", "current"; "" for kNone.
[[nodiscard]] const char* name_of(Role role);

struct NameGuess {
  Role role = Role::kNone;
  int number = -1;     // of the joint, as the name counts; -1: none
  std::string family;  // the name without that number: columns of one quantity share it
  std::string unit;    // "pos_deg", "t [ms]": as units.hpp has it; empty: none said
};

// Names of what was asked for (reference, desired, command) and of errors have no role.
[[nodiscard]] NameGuess guess_of(const std::string& name);

// Columns by role, by the families that have one for each of `joints` joints, or as many as most
// have where that is 0; the first in the file's order of each role.
struct Roles {
  std::optional<std::string> time;
  std::vector<std::string> position;
  std::vector<std::string> velocity;
  std::vector<std::string> torque;
  bool torque_is_current = false;
  std::vector<std::string> other_families;  // of the same roles, that would do as well
};
[[nodiscard]] Roles roles_of(const std::vector<std::string>& names, int joints);

}  // namespace offnominal::desk
