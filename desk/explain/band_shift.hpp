#pragma once

#include <Eigen/Core>
#include <vector>

#include "identify/relinearise.hpp"

namespace offnominal::desk {

// How far a term moves at most when the same model is fitted to the same recordings in two narrower
// bands.
struct BandShift {
  std::vector<double> numbers;          // in the order of EffectCandidate::parameters()
  std::vector<Eigen::VectorXd> linear;  // per band, of linear_numbers()
};

// Of every term. The numbers of a right model do not depend on the band but for noise; those of one
// that simplifies (a gear without rebound, a sign in place of a bristle) do, because what it leaves
// out lies higher in frequency than what it says. J. A. Hausman, Econometrica 46(6), 1978, tests
// models by such a difference; here it is the measure of what a covariance of noise cannot hold.
std::vector<BandShift> shifts_in_narrower_bands(const Relinearised& fitted);

}  // namespace offnominal::desk
