#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "compare/before_after.hpp"
#include "compare/compare.hpp"
#include "identify/fit_memory.hpp"
#include "identify/freedom.hpp"
#include "identify/on_progress.hpp"
#include "identify/unknown.hpp"
#include "log/log.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk {

struct AddRequest {
  std::vector<EffectKind> effects;    // to add, one or more
  std::size_t joint = 0;              // from 0, for all of them
  bool of_motor = false;              // they act on the shaft of the motor of that number
  std::map<std::string, double> set;  // "smoothing" or "coulomb_friction.smoothing": given values
  // Standard deviation of the prior on every link's mass and inertia, 0.05 for 5 %; none: the
  // rigid-body numbers stay.
  std::optional<double> inertia_deviation;
  // Beside all else a time skew between torque and position, which is the recording's own. Without
  // it the numbers make up for one: right for a monitor that will have the same.
  bool fit_skew = true;
  bool keep = false;   // leave effects that were fitted before as they are
  std::string source;  // what the written effects say of where their numbers come from
};

// The joints whose torque an effect of that kind on that joint, or motor, changes, ascending: a
// mass shows on every joint before it, and on its own not where it hangs in that joint's axis.
std::vector<std::size_t> joints_of(const RobotDescription& robot, EffectKind kind,
                                   std::size_t joint, bool of_motor);
// Of everything that is asked for.
std::vector<std::size_t> joints_asked(const RobotDescription& robot, const AddRequest& request);

// What a sensor behind the gear does not see cannot be fitted to its torques: throws InputError
// where the recording does not show what is asked for or an effect of the robot, as add() does.
void check_sensors(const RobotDescription& robot, const AddRequest& request, const Log& log);

// One parameter of an effect after a fit.
struct FittedParameter {
  std::size_t effect = 0;  // index into the robot's effects
  std::size_t parameter = 0;
  double value = 0;
  std::optional<Interval> ci95;
  std::string why_no_interval = {};  // where it was fitted and has none, in words
  bool fitted = false;               // false: given, or left where it was
};

// Mass and inertia of one link after a fit, as a factor on what they were.
struct FittedLink {
  std::size_t link = 0;
  double factor = 1;
  std::optional<Interval> ci95;
};

// Numbers that the recording cannot tell apart; `fixed` was left at its start for it.
struct Indistinct {
  Unknown fixed;
  std::vector<Unknown> others;  // empty: the recording does not excite it at all
};

struct AddedNumbers {
  std::vector<FittedParameter> parameters;
  std::vector<FittedLink> links;
  std::vector<Indistinct> indistinct;
};

struct AddResult {
  RobotDescription robot;          // with the effects, fitted
  std::vector<std::size_t> added;  // indices into robot.effects
  AddedNumbers fit;
  std::vector<BeforeAfter>
      fitted_logs;                    // per joint of the robot, of all fitted recordings together
  std::vector<BeforeAfter> held_out;  // per joint that the fit touched
  bool cross_validated = false;       // held_out is from parts of the fitted recordings
  // Per joint of the robot in each recording, the fitted ones first.
  struct OfRecording {
    std::string file;
    bool held_out = false;
    std::vector<BeforeAfter> joints;
    std::vector<std::string> remarks;  // the recording's
  };
  std::vector<OfRecording> recordings;
  Comparisons before;  // on the hold-out recordings, or on the fitted ones where there are none
  Comparisons after;
  Comparisons after_fitted;             // on the fitted recordings, where there are others
  std::vector<std::string> notes;       // what a reader of the numbers has to know
  std::vector<std::string> objections;  // why the result must not be used; empty: it may
  // Why it should not be, as far as data say that the fit has not seen: for the user to overrule.
  std::vector<std::string> doubts;

  [[nodiscard]] bool may_be_written(bool overruled) const {
    return objections.empty() && (doubts.empty() || overruled);
  }
};

// Fits new effects together with the effects of `robot` that are marked fitted and act on the same
// joints to one or more recordings, and judges the fit on data that it has not seen: `holdout`, or
// where that is empty contiguous parts of the recordings themselves (every fifth of them predicted
// by a fit of the others, shapes included). The regression is that of explain(). Throws InputError
// when a joint or parameter does not exist, a given value is out of range, an effect is there
// already, the robot has no room for it, a recording has other joints than the robot, or as
// plan_filter().
AddResult add(const RobotDescription& robot, const AddRequest& request,
              const std::vector<Log>& logs, const std::vector<Log>& holdout,
              const FilterRequest& filter = {}, const OnProgress& on_progress = {});

// The same, to the bit, of the memory's recordings with its filter: for many fits one after the
// other.
AddResult add(const RobotDescription& robot, const AddRequest& request, FitMemory& memory,
              const OnProgress& on_progress = {});

}  // namespace offnominal::desk
