#pragma once

#include <string>
#include <vector>

#include "identify/add.hpp"

// What speaks against a fit that add() made: each function appends to the notes, objections or
// doubts of a result.

namespace offnominal::desk {

// "coulomb_friction.torque of joint 2"
std::string name_of(const AddResult& result, const FittedParameter& parameter);
// "-10 N m s/rad, 95 % between -10.2 and -9.8"
std::string value_words(const AddResult& result, const FittedParameter& parameter);

// Numbers that the recordings do not tell apart, and what was done of it.
void note_indistinct(AddResult& result);

// An effect of which no number can be told. `unknowns`: the linear numbers that were to be fitted.
void object_to_indistinct(const std::vector<Unknown>& unknowns, AddResult& result);

// On data that the fit has not seen: the joint that was asked for must gain, or where several have
// it one of them by more than what chance gives one of so many; at no other may the error rise.
void doubt_what_held_out_data_say(const AddRequest& request, AddResult& result);

// What is added may be nothing: every number that says how strong it is may be 0. Unless data that
// the fit has not seen say clearly that it is not.
void doubt_what_may_be_nothing(const AddRequest& request, AddResult& result);

}  // namespace offnominal::desk
