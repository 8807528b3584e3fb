#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "identify/freedom.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk {

// What physics lets a parameter of an effect be; both ends included. Never wider than what robot
// files take, and narrower for friction: what takes energy out of a joint has no other sign.
struct PhysicalRange {
  double min = 0;
  double max = 0;
  bool is_friction = false;

  [[nodiscard]] bool holds(double value) const { return value >= min && value <= max; }
  // The end that a value is beyond.
  [[nodiscard]] double nearest(double value) const { return value < min ? min : max; }
  // "0 or more", "9 or less"
  [[nodiscard]] std::string words_at(double value) const;
  // What a value beyond an end usually means: a clause.
  [[nodiscard]] const char* usual_cause() const;
};

PhysicalRange physical_range(EffectKind kind, std::size_t parameter);

// Whether a recording contradicts the end that a fitted value is beyond: no part of its interval is
// within, and what it asks for beyond is more than nothing to the joint's torque, of whose rms it
// takes `torque_share`. Otherwise the end itself fits as well.
bool contradicts(const PhysicalRange& range, const std::optional<Interval>& ci95,
                 double torque_share);

}  // namespace offnominal::desk
