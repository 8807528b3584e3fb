#pragma once

#include <string>
#include <vector>

#include "identify/effect_candidate.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk::motion {

// An effect on a joint that recordings may have to tell from others.
struct Contender {
  const EffectCandidate* effect = nullptr;
  Eigen::Index joint = 0;  // from 0

  friend bool operator==(const Contender&, const Contender&) = default;
};

// "coulomb_friction@2", joints from 1.
std::string text_of(const Contender& contender);

// Reads "EFFECT" or "EFFECT@JOINT", joints from 1; `option` is named in messages. Without a joint
// it is the robot's only one where the effect can act. Throws InputError on an effect that is
// unknown, is in the robot file already or cannot act there, and on a joint that is missing or
// none.
Contender contender_of(const std::string& text, const RobotDescription& robot,
                       const std::string& option);

// Every effect that may act on one of `joints` and that the robot file does not have yet.
std::vector<Contender> contenders_on(const RobotDescription& robot,
                                     const std::vector<Eigen::Index>& joints);

}  // namespace offnominal::desk::motion
