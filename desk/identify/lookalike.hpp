#pragma once

#include <string>
#include <vector>

#include "identify/regression.hpp"

namespace offnominal::desk {

// A number of an effect that the model does not have, which would have explained the same torque.
struct Lookalike {
  const EffectCandidate* effect = nullptr;
  std::string parameter;
};

// Lookalikes of coefficient `c` of term `i` among the effects of the same joint that need no shape
// to be found. Two columns look alike where, once all other fitted columns are taken out of both,
// the sine of the angle between them is below 0.07.
std::vector<Lookalike> lookalikes(const Regression& regression, const std::vector<Term>& terms,
                                  std::size_t i, std::size_t c);

}  // namespace offnominal::desk
