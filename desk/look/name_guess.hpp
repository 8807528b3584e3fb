#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

// What the name of a column says of it. Two people call the same thing by other names, and what is
// guessed here is proposed and never used by itself.

namespace offnominal::desk {

// kVoltage: a drive's signal in volts that a scale makes a torque of.
enum class Role : std::uint8_t { kNone, kTime, kPosition, kVelocity, kTorque, kCurrent, kVoltage };

// "time", "position", "velocity", "torque", "current", "voltage"; "" for kNone.
[[nodiscard]] const char* name_of(Role role);

// A word or a number of a name, in small letters, and where it stands: "rec.actPos(2,:)" has rec,
// act, pos, 2.
struct NameWord {
  std::string text;
  std::size_t begin = 0;
  std::size_t end = 0;
};
[[nodiscard]] std::vector<NameWord> words_in(const std::string& name);

// The name but for a unit that is known, in brackets or behind an underscore: "tau# [mN m]" and
// "tau#_Nmm" are "tau#".
[[nodiscard]] std::string without_unit(const std::string& name);

// Of a position, a velocity, a torque or a current.
[[nodiscard]] bool says_quantity(const std::string& word);

struct NameGuess {
  Role role = Role::kNone;
  // What it would be of, had it been measured: of what was asked for, limited, estimated of the
  // world or computed, whose role is kNone.
  Role not_measured = Role::kNone;
  int number = -1;        // of the joint, as the name counts; -1: none
  std::string family;     // the name without that number: columns of one quantity share it
  std::string unit;       // "pos_deg", "t [ms]": as units.hpp has it; empty: none said
  bool of_motor = false;  // it has the word
};

// Names of what was asked for (reference, desired, command), of what acts from outside (external)
// and of errors have no role. A unit, in the name's brackets or said by the file, gives one to a
// name that says none.
[[nodiscard]] NameGuess guess_of(const std::string& name, const std::string& said_unit = {});

}  // namespace offnominal::desk
