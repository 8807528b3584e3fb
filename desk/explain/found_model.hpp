#pragma once

#include <optional>
#include <string>
#include <vector>

#include "identify/holdout.hpp"
#include "identify/regression.hpp"

namespace offnominal::desk {

// An effect that passed every gate.
struct Accepted {
  Term term;
  double p = 1;                 // of the whole search, wild block bootstrap
  double p_replay = 1;          // by playing the model without the effect, 1 where not asked for
  std::string stands_for = {};  // what else it is, in words: any_shape.hpp
};

// What goes of an error on the joint where the largest share of its energy goes.
struct Fall {
  Eigen::Index joint = 0;
  double share = -1;  // of the energy
  double rms = 0;     // of what goes
};

// Errors per joint, rms.
Fall best_fall(const Eigen::VectorXd& before, const Eigen::VectorXd& after);

// The effect that came closest to a name: likely more than chance, and too unsure or too small.
struct Suspected {
  Term term;
  double p = 1;      // of the whole search, wild block bootstrap
  double share = 0;  // of the residual energy that it takes away, on the joint where that is most
};

// Share of a joint's residual energy below which an effect is not worth a name.
inline constexpr double kRelevantShare = 0.08;
// The same of the joint's rms torque, for an effect and for what is left of the error.
inline constexpr double kRelevantTorque = 0.001;

// Whether what goes of a joint's error is worth a name at all, where its rms torque is `torque`:
// what is less than a hundredth of that has to be most of the error, or it may as well be what
// smoothed friction and filtered positions leave of themselves.
bool is_worth_a_name(const Fall& fall, double torque);

struct FoundModel {
  std::vector<Accepted> accepted;      // those that matter most first
  std::optional<Suspected> suspected;  // only where nothing was accepted
  ModelFit baseline;                   // nuisance alone
  ModelFit fit;                        // with all that was accepted
  // Residuals on held-out data without any and with all of the accepted.
  Eigen::VectorXd held_out_before;
  Eigen::VectorXd held_out_after;
  // Per joint: whether something shows that its recordings do not tell from the model's own
  // numbers.
  std::vector<char> unsure;
  // Held-out error, rms per joint, with the first 0, 1, ... of the accepted.
  std::vector<Eigen::VectorXd> waterfall;

  [[nodiscard]] std::vector<Term> terms() const;
  [[nodiscard]] std::vector<Term> terms_without(std::size_t left_out) const;
};

// Puts the accepted in order, those that matter most first, and judges them anew on what is held
// out.
void order_and_hold_out(const Regression& regression, const HoldOut& hold_out, int threads,
                        FoundModel& found);

}  // namespace offnominal::desk
