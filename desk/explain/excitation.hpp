#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "identify/effect_candidate.hpp"
#include "identify/workspace.hpp"

namespace offnominal::desk {

// What the recordings let one see of one joint. How rich its motion is says little by itself: what
// these recordings can tell is asked effect by effect (questions.hpp).
struct Excitation {
  double range = 0;      // rad or m, between the extreme positions
  double top_speed = 0;  // rad/s or m/s, 99 % quantile
  // Smallest singular value of [1, q, dq, ddq, sgn dq, dq |dq|], each of length 1: how far the
  // motion is from one on which two of them are the same. About 0.15 for a rich motion, 0.03 for
  // one sine.
  double separation = 0;
  bool moves = false;
  // Whether every effect that any drive may have would show.
  bool sufficient = false;
  std::string lack;  // in words, what would not; empty where sufficient

  // Whether it moves as poorly as on one sine or at one speed to and fro, which reach 0.09: effects
  // that every drive may have are nearly the same then, and what fits best is one of many.
  [[nodiscard]] bool is_poor() const { return moves && separation > 0 && separation < 0.095; }
};

// 1, q, dq, ddq, sgn dq and dq |dq| of a joint: what any motion should tell apart.
std::vector<Regressor> standard_regressors(const Workspace& at, Eigen::Index joint);

// Whether a joint leaves its place, by more than encoder counts, in or between the recordings.
bool moves(const std::vector<Workspace>& recordings, Eigen::Index joint);

// Where no effect has been asked for yet, a joint that moves is sufficient.
std::vector<Excitation> excitation_of(const std::vector<Workspace>& recordings);

bool all_sufficient(const std::vector<Excitation>& joints);

}  // namespace offnominal::desk
