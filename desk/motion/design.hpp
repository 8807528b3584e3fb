#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "log/log.hpp"
#include "motion/separation.hpp"

namespace offnominal::desk::motion {

struct DesignRequest {
  // What the motion has to tell apart (two or more), or to excite (one, or none: every effect that
  // the robot may have).
  std::vector<Contender> effects;
  double duration_s = 30;
  double rate_hz = 1000;
  double margin = 0.1;  // share of every limit that is left free
  Expectation expectation;
  std::uint64_t seed = 1;
  int starts = 0;               // random motions tried; 0: as many as suit the robot
  int threads = 1;              // the result does not depend on it
  std::vector<Log> recordings;  // that could not tell; for comparison, may be empty
};

// One of the effects against another, or the only one against its worst rival.
struct PairReport {
  Contender truth;
  std::optional<Contender> rival;    // none: against the adapting numbers alone
  std::optional<Separation> before;  // of the recordings, or of one slow sine
  Separation after;
  bool possible = true;  // false: no motion that was tried tells them apart
};

struct Design {
  DesignRequest request;
  std::vector<JointLimits> limits;  // that the motion kept, with the margin
  FittedMotion fitted;              // at request.rate_hz
  std::vector<PairReport> pairs;
  std::vector<bool> excited;  // per joint
  double slow_from_s = 0;     // oscillation before, poses after
  int motions_tried = 0;

  // The pair that the motion separates least, of those that some motion can; null where none can.
  [[nodiscard]] const PairReport* worst() const;
};

// What is being done, and that one more motion has been judged.
struct DesignProgress {
  std::function<void(const std::string& doing)> begin;
  std::function<void()> step;
};

// The motion of the family (trajectory.hpp) that does best what is asked: random starts, the best
// of them improved by the subplex method (T. H. Rowan, 1990; NLopt). The same request gives the
// same motion. Throws InputError where the robot has no limits, or cannot hold itself within them.
Design design_motion(const RobotDescription& robot, const DesignRequest& request,
                     const DesignProgress& progress = {});

}  // namespace offnominal::desk::motion
