#pragma once

#include "explain/excitation.hpp"
#include "identify/data.hpp"
#include "identify/regression.hpp"

namespace offnominal::desk {

// Two models tell apart where the mean difference of their blocks' squared errors is at least so
// many of its standard errors.
inline constexpr double kTellApart = 3;

// Whether a model with another effect explains every block of time about as well as the chosen one:
// the mean difference of the blocks' squared errors is within three of its standard errors.
bool as_good(const Data& data, const ModelFit& chosen, const ModelFit& alternative);

// Whether all columns of `inner` lie in the span of those of `outer` beside what `baseline` fits:
// then the larger group cannot but explain as much.
bool is_nested(const Data& data, const ModelFit& baseline, const Term& inner, const Term& outer);

// Whether the motion of its joint shows this effect apart from others: where that motion is poor,
// but over a good part of the joint's range, an effect may still be like nothing else in it.
bool shows(const Data& data, const Excitation& motion, const Term& term);

}  // namespace offnominal::desk
