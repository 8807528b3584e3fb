#pragma once

#include <span>
#include <vector>

#include "identify/data.hpp"
#include "identify/regression.hpp"

namespace offnominal::desk {

// Two models tell apart where the mean difference of their blocks' squared errors is at least so
// many of its standard errors.
inline constexpr double kTellApart = 3;

// Whether a model with another effect explains every block of time of every joint about as well as
// the chosen one: the difference of the blocks' squared errors is within three of its standard
// errors, blocks that are correlated counted once, and within what the chosen effect's formula
// simplifies, but no more than twice what the chosen one leaves; and what the other one leaves is
// not worth so many samples that the chosen one could take this much of it by chance. `energy`: of
// the chosen effect's torque or of the other's, weighted as the chosen fit (questions.hpp).
bool as_good(const Data& data, const ModelFit& chosen, const ModelFit& alternative, double energy);

// Whether all columns of `inner` lie in the span of those of `outer` beside what `baseline` fits:
// then the larger group cannot but explain as much.
bool is_nested(const Data& data, const ModelFit& baseline, const Term& inner, const Term& outer);

// Ripples of so many periods over the range that a joint moves over, of every candidate that has a
// spectrum over the position.
std::vector<Term> ripples_of(const Data& data, Eigen::Index joint, std::span<const double> periods);

// Candidates of a spectrum over the position are searched from two periods per range on: what
// repeats over more than the range of a joint is a curve, and looks like an offset or a spring.
std::vector<Term> slow_ripples(const Data& data, Eigen::Index joint);

}  // namespace offnominal::desk
