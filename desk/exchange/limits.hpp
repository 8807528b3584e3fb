#pragma once

#include <offnominal/model/chain.hpp>

namespace offnominal::desk::exchange {

/// A limit of velocity or torque that is not known.
inline constexpr double kUnlimited = Joint<double>{}.max_torque;

/// A range has both ends, or none.
[[nodiscard]] inline bool has_range(const Joint<double>& joint) {
  return joint.max_position != Joint<double>{}.max_position ||
         joint.min_position != Joint<double>{}.min_position;
}

}  // namespace offnominal::desk::exchange
