#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <offnominal/joint_count.hpp>
#include <offnominal/model/chain.hpp>
#include <offnominal/model/effect_list.hpp>
#include <offnominal/model/quantity.hpp>

namespace offnominal {

// What a model says of one joint's friction, motors' as it is felt at the joint. Not below 0.
template <typename Scalar>
struct KnownFriction {
  Scalar dry{};      // of one that moves, N m or N
  Scalar holding{};  // of one that stands still, at most: with what friction at rest has above it
  Scalar viscous{};  // N m s/rad or N s/m
  Scalar width{};    // velocity over which its sign is smoothed, rad/s or m/s
};

// Of every joint. `width`: where the model has no dry friction, and at least.
template <int N, typename Scalar>
[[nodiscard]] PerJoint<N, KnownFriction<Scalar>> known_friction(const Chain<N, Scalar>& chain,
                                                                Scalar width) {
  PerJoint<N, KnownFriction<Scalar>> joints{};
  size_for(chain.joints.size(), joints);
  for (std::size_t i = 0; i < joints.size(); ++i) {
    KnownFriction<Scalar>& friction = joints[i];
    friction = {};
    friction.width = width;
    for (const Effect<Scalar>& effect : chain.effects.view()) {
      Scalar ratio(1);
      if (effect.of_motor) {
        const std::size_t place = effect.joint * chain.transmission.kMost + i;
        ratio = Eigen::numext::abs(chain.transmission.motor_per_joint[place]);
      } else if (effect.joint != i) {
        continue;
      }
      const Scalar size = ratio * effect.parameters[0];
      visit_effect(effect.kind, [&]<typename E>() {
        constexpr FrictionPart kPart = E::kTraits.part;
        if constexpr (kPart == FrictionPart::kPerVelocity) friction.viscous += ratio * size;
        if constexpr (kPart == FrictionPart::kAtRest) friction.holding += size;
        if constexpr (kPart == FrictionPart::kDry) {
          friction.dry += size;
          friction.holding += size;
          const Scalar smoothing = effect.parameters[kPlaceOf<E, Quantity::kVelocity>];
          if (ratio > 0) friction.width = std::max(friction.width, smoothing / ratio);
        }
      });
    }
    // What a fit made less than nothing is none.
    for (Scalar* part : {&friction.dry, &friction.holding, &friction.viscous}) {
      *part = std::max(*part, Scalar(0));
    }
  }
  return joints;
}

}  // namespace offnominal
