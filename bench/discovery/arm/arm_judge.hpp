#pragma once

#include <optional>
#include <string>
#include <vector>

#include "arm_case.hpp"
#include "explain/explain.hpp"

namespace offnominal::bench {

// An effect that is asked for, and what became of it.
struct ArmAsked {
  desk::EffectAt what;
  double share = 0;     // of its joint's torque
  bool named = false;   // and in no class
  int class_size = 0;   // of the class that holds it; 1 where named; 0: not there
  std::string instead;  // where not there: what its joint's answer is
};

// One joint of one case.
struct ArmJointScore {
  Eigen::Index joint = 0;
  bool is_asked = false;     // something is missing there that is large enough
  bool is_answered = false;  // all of it is named, or in a class of at most three
  bool is_wrong = false;     // something is named that is not there
};

struct ArmScore {
  std::vector<ArmAsked> asked;
  std::vector<ArmJointScore> joints;
  std::vector<desk::EffectAt> wrong;
  int false_pushes = 0;         // told where nothing pushes
  std::optional<bool> payload;  // its mass within 10 %; none where none is asked for
  // The moment of the change, or the begin and the end of every push, within 0.1 s on a joint that
  // has it.
  std::optional<bool> moment;
};

// What counts as there, beside what is hidden: a torque constant that is off by 1 % or more; a
// link's mass where the file's is off by 5 % or more, in the same direction. A class counts for its
// first effect's joint, and is wrong where nothing in it is there.
ArmScore arm_score_of(const ArmTruth& truth, const desk::Explanation& told);

}  // namespace offnominal::bench
