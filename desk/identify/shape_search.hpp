#pragma once

#include <vector>

#include "identify/on_progress.hpp"
#include "identify/regression.hpp"

namespace offnominal::desk {

// Where a term whose grid is a spectrum may be: the highest peaks of what a model leaves.
std::vector<ShapePoint> spectral_peaks(const Data& data, const Term& term, const Remainder& at);

// Moves the shapes of all terms to where the model fits best (variable projection, G. H. Golub, V.
// Pereyra, SIAM J. Numer. Anal. 10(2), 1973): each over its whole grid, spectra at their peaks,
// then between the grid's points; one after the other until none moves. A term without a shape yet
// counts from when it has been its turn.
void fit_shapes(const Regression& regression, std::vector<Term>& terms,
                const OnProgress& on_progress = {});

// The same of terms that have been fitted to nearly the same recordings: a spectrum as a whole,
// other shapes from where they are.
void fit_shapes_again(const Regression& regression, std::vector<Term>& terms);

}  // namespace offnominal::desk
