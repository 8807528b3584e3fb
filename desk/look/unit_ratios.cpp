#include "look/unit_ratios.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace offnominal::desk {
namespace {

constexpr double kSameRatio = 1.12;
constexpr double kPerDegree = 180 / std::numbers::pi;
constexpr std::array kRatios{
    UnitRatio{kPerDegree, "rad", "deg/s"},
    UnitRatio{30 / std::numbers::pi, "rad", "rpm"},
    UnitRatio{0.5 / std::numbers::pi, "rad", "turns/s"},
    UnitRatio{1 / kPerDegree, "deg", "rad/s"},
    UnitRatio{1.0 / 6, "deg", "rpm"},
    UnitRatio{1e3, "m", "mm/s"},
};

double distance(double ratio, double wanted) { return std::abs(std::log(ratio / wanted)); }

}  // namespace

bool is_near(double ratio, double wanted) {
  return ratio > 0 && distance(ratio, wanted) < std::log(kSameRatio);
}

const UnitRatio* unit_ratio_of(double ratio) {
  if (!(ratio > 0)) return nullptr;
  const auto* const nearest =
      std::min_element(kRatios.begin(), kRatios.end(), [&](const UnitRatio& a, const UnitRatio& b) {
        return distance(ratio, a.factor) < distance(ratio, b.factor);
      });
  return is_near(ratio, nearest->factor) ? nearest : nullptr;
}

}  // namespace offnominal::desk
