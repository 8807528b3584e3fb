#pragma once

#include <vector>

#include "explain/search.hpp"

namespace offnominal::desk {

// Every drive has friction. Where the model of a joint has no Coulomb or no viscous friction, what
// may stand for either, or for both at once, is compared with them first: the family of one, of the
// other and of both, each with and without a constant torque, every shape refitted. Puts the
// members of the family that the model lacks among a joint's proposals and takes out whatever
// larger member does not beat the best of them, and a drift where there is no friction yet that
// could drift. `open`: per joint, whether it is searched; `proposals`: per joint, ranked, and again
// after it.
void put_friction_first(const Search& search, const Regression& regression,
                        const std::vector<Term>& terms, const std::vector<char>& open,
                        std::vector<std::vector<Proposal>>& proposals);

// Whether `other`, in the place of Coulomb or viscous friction, is a larger member of their family
// that does not make the recordings more likely: then the simpler one has the name. So has a
// heavier last link beside a payload somewhere on it.
bool is_refuted_by_simpler(const Data& data, const Term& simpler, const ModelFit& with_simpler,
                           const Term& other, const ModelFit& with_other);

// Whether the robot file has such an effect that acts on a joint: a motor's acts on all joints that
// it moves.
bool file_has(const Data& data, EffectKind kind, Eigen::Index joint);

// An effect on a joint, its shape at the first point of its grid.
Term first_on_grid(const Data& data, EffectKind kind, Eigen::Index joint);

// What of Coulomb and viscous friction the file lacks on joints that move.
std::vector<Term> standard_friction(const Data& data);

// Moves a term's shape to where the model fits best over the whole of its grid, the other terms as
// they are: refine() stays near the point where it is.
void refine_over_range(const Regression& regression, std::vector<Term>& terms, std::size_t which);

}  // namespace offnominal::desk
