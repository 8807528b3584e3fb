#pragma once

#include "explain/excitation.hpp"
#include "explain/search.hpp"

namespace offnominal::desk {

// What these recordings can say is judged by question: whether they would show this effect beside
// everything that the model adapts to it, by the likelihood with and without it. Correlated errors
// count once, and what is believed of the links' masses is part of the model.

// Every effect's formula is a simplification, and leaves about this share of its own torque.
inline constexpr double kLeftOfItself = 0.06;

// Torque of a fitted term and what of it can be told from everything else that the model fits, rms
// in units of each joint's error and over all joints together.
struct Shown {
  double torque = 0;
  double apart = 0;

  // Whether more of it shows than what such an effect leaves of itself: the rest of a model that is
  // not quite right may look like anything. On a poor motion the model's own numbers take most of
  // any effect, and what is left of one looks like that of another; only the friction that every
  // drive has is believed there by less.
  [[nodiscard]] bool is_enough(const Excitation& motion, EffectKind kind) const {
    constexpr double kOfFriction = 0.35;
    constexpr double kOfOthers = 0.85;
    if (!motion.is_poor()) return apart >= kLeftOfItself * torque;
    return apart >= (info_of(kind)->traits.every_drive_has ? kOfFriction : kOfOthers) * torque;
  }
};

// By how much the log-likelihood of all joints' recordings grows where what is left goes from
// `before` to `after`, rms per joint; `samples`: independent ones that each is worth. A joint of
// which nothing is left says nothing.
double growth_of_log_likelihood(const Eigen::VectorXd& before, const Eigen::VectorXd& after,
                                const Eigen::VectorXd& samples);

// Whether a joint's recordings are more likely with an effect than without where errors next to a
// reversal have a size of their own. How friction builds up there no formula has quite, and what
// stands for that alone, as a delay may, is worse wherever the joint moves.
bool is_more_likely_at_any_speed(const Data& data, const ModelFit& without, const ModelFit& with,
                                 Eigen::Index joint);

// `which`: one of the terms that `fit` is of; `without`: the fit of the others.
Shown shown(const Data& data, const std::vector<Term>& terms, std::size_t which,
            const ModelFit& fit, const ModelFit& without);

// Weighted energy of a term's torque as it was fitted, over all rows; `weights` per joint.
double weighted_energy(const Data& data, const Term& term, const Eigen::VectorXd& coefficients,
                       const Eigen::VectorXd& weights);

// Whether a torque that is periodic in time comes back with the motion of its joint: what repeats
// with a motion that repeats may be any torque that follows the position or the velocity.
bool repeats_with_motion(const Data& data, const Term& term);

// The smallest rms torque of an effect on its joint that the recordings would show beside the
// model: what is left of it beside everything else has to be relevant, and to make the recordings
// more likely by as much as a search asks for. `one`: a candidate that does not; infinite where the
// model takes up whatever the effect does.
double smallest_shown(const Data& data, const ModelFit& at, const Screened& one);

}  // namespace offnominal::desk
