#include "identify/shape_grid.hpp"

#include <cmath>
#include <numbers>

namespace offnominal::desk {

std::vector<double> logarithmic_grid(double from, double to, double per_decade) {
  std::vector<double> grid;
  if (!(from > 0) || !(to > from)) return grid;
  const auto steps = static_cast<int>(std::ceil(per_decade * std::log10(to / from)));
  for (int i = 0; i <= steps; ++i) {
    grid.push_back(from * std::pow(to / from, static_cast<double>(i) / steps));
  }
  return grid;
}

double first_order_period(JointType type) {
  return type == JointType::kRevolute ? 2 * std::numbers::pi : 1.0;
}

}  // namespace offnominal::desk
