// What can be hidden in a robot, one row for each effect: whoever names, lists or draws hidden
// effects reads it here. In what is drawn, "share" is the root mean square of the effect's torque
// over that of its joint's torque, on the rich motion of the rigid, frictionless arm; "level" is a
// torque over that root mean square. Both are before the request's effect_size.
//
// In closed loop (20 seeds, 30 s) that is 3 to 15 % of the joint's torque, but 1 to 3 % for
// time_delay, up to 20 % for torque_scale and up to 28 % for link_mass; backlash is 6 % below 20
// Hz, under impacts of several times that. The tests print it.
#pragma once

#include <string_view>
#include <vector>

#include "offnominal/sim/hidden/draws.hpp"
#include "offnominal/sim/hidden/joint_effects.hpp"

namespace offnominal::sim::hidden {

struct HidingPlace;

/// A number of Truth.
struct ParameterName {
  std::string_view name;  ///< as in robot files where there is such an effect
  std::string_view unit;
};

/// Changes the robot, and its owner's knowledge where what is hidden must be missing there, by
/// numbers that it draws from within the row's. Gives the values of the row's parameters, in their
/// order; NaN for one that this robot does not have.
using Hide = std::vector<double> (*)(const HidingPlace&, const std::vector<DrawnNumber>&);

struct HiddenEffectRow {
  HiddenEffect effect;
  std::string_view name;  ///< as in robot files: "coulomb_friction"
  std::vector<DrawnNumber> drawn;
  std::string_view note;  ///< what else is drawn, in words
  std::vector<ParameterName> parameters;
  Hide hide;
};

struct OutsideEffectRow {
  OutsideEffect effect;
  std::string_view name;
  /// What its torque is a function of: "position", "position and velocity", "velocity", "load" or
  /// "time"; "" for kNone.
  std::string_view variable;
  std::vector<DrawnNumber> drawn;
  std::string_view note;
  std::vector<ParameterName> parameters;
  Hide hide;
};

/// One row for each of the enumeration, in its order.
const std::vector<HiddenEffectRow>& hidden_effect_table();
const std::vector<OutsideEffectRow>& outside_effect_table();

/// Its row of the table.
const HiddenEffectRow& row_of(HiddenEffect effect);
const OutsideEffectRow& row_of(OutsideEffect effect);

inline std::string_view name(HiddenEffect effect) { return row_of(effect).name; }
inline std::string_view name(OutsideEffect effect) { return row_of(effect).name; }

/// Those of the tables, but for kNone.
std::vector<HiddenEffect> all_hidden_effects();
std::vector<OutsideEffect> all_outside_effects();

}  // namespace offnominal::sim::hidden
