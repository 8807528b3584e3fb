#pragma once

namespace offnominal::desk {

// A velocity over the derivative of its position, by the units of the two.
struct UnitRatio {
  double factor;
  const char* position;
  const char* velocity;
};

// Within 12 %: noise and filters take some of a velocity, and units lie further apart.
[[nodiscard]] bool is_near(double ratio, double wanted);

// The nearest that is known; null where none is near.
[[nodiscard]] const UnitRatio* unit_ratio_of(double ratio);

}  // namespace offnominal::desk
