#pragma once

#include <string>

#include "explain/explain.hpp"

// What to do about an answer: each appends to the advice of an explanation. What changes has its
// own (change_words.hpp).

namespace offnominal::desk {

inline constexpr const char* kMorePositions =
    "hold it at more positions, approached from both sides";

// "coulomb_friction on joint 2".
std::string words_of_place(const EffectAt& one);

// Which motion would tell what these recordings do not tell apart.
void advise_on_classes(Explanation& e);

// What the motion of a joint lacks of which nothing else is said.
void advise_on_motion(Explanation& e);

// How far the links were let off the file, where the recordings said so, or why they were not.
void advise_on_links(Explanation& e);

// A file without any friction on a joint, in one sentence.
void advise_on_friction(Explanation& e);

// What a motor's own friction does shows on all joints that it moves, and is not looked for.
void advise_on_motors(Explanation& e);

// A torque over a variable that no other effect describes can be in the model as a curve.
void advise_on_shapes(Explanation& e);

// What is left beside what was found.
void advise_on_rest(Explanation& e);

}  // namespace offnominal::desk
