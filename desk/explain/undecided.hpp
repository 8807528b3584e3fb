#pragma once

#include <vector>

#include "explain/excitation.hpp"
#include "explain/explain.hpp"
#include "explain/find_model.hpp"
#include "explain/search.hpp"

namespace offnominal::desk {

// What could be missing on joints whose recordings show something that they do not tell from the
// model's own numbers, and whose error stands above their noise: per such joint every effect that
// explains a good part of what the best one does, best first, a wave in time only where nothing
// else does; one alone where that or the model's own numbers are all that is possible; the joint
// that stands out most first. Empty where no joint shows anything, or where no effect explains it.
// Joints on which something was found have their answer: `found` is asked of the others.
std::vector<std::vector<EffectAt>> undecided(const Search& search, const Regression& regression,
                                             const FoundModel& found,
                                             const std::vector<Excitation>& excitation);

}  // namespace offnominal::desk
