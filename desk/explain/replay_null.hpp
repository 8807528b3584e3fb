#pragma once

#include <cstdint>
#include <vector>

#include "explain/search.hpp"

namespace offnominal::desk {

// p-value of a term by playing the model that lacks it along the measured motion: each of `replays`
// torques is that model's, with the noise that the full model leaves, its blocks of time put in
// another order and sign (the spectrum within a block stays). How often does the term's family of
// shapes then gain as much as it did? At least 1 / (1 + replays).
// `fit`: of the model without the term; `noise`: residual of the full model, stacked.
double replay_p(const Data& data, const ModelFit& fit, const Eigen::VectorXd& noise,
                const Term& term, int replays, std::uint64_t seed, int threads);

}  // namespace offnominal::desk
