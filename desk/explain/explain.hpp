#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "explain/excitation.hpp"
#include "explain/pushes.hpp"
#include "explain/remainder.hpp"
#include "explain/treated.hpp"
#include "identify/effect_candidate.hpp"
#include "identify/estimates.hpp"
#include "identify/improved_robot.hpp"
#include "identify/on_progress.hpp"
#include "log/log.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk {

enum class Verdict {
  kExplained,
  kFound,
  kAmbiguous,
  kParameterShift,
  kUnknownStateDependent,
  kUnknownExternal,
  kNotExcited,
  kChanged,
  kDataFault
};
const char* name_of(Verdict verdict);
// Whether what was found is to be written to the robot file.
bool is_to_write(Verdict verdict);
// The names of all, in the order of the enumeration.
std::vector<std::string> verdict_names();

// An effect on a joint; the joint counts from 0.
struct EffectAt {
  EffectKind kind = EffectKind::kViscousFriction;
  Eigen::Index joint = 0;
  [[nodiscard]] std::string_view name() const { return info_of(kind)->name; }
  friend bool operator==(const EffectAt&, const EffectAt&) = default;
};
// As an answer on a joint names it: "coulomb_friction", "coulomb_friction of joint 5" from another.
std::string name_seen_from(Eigen::Index joint, const EffectAt& one);
bool holds(const std::vector<EffectAt>& effects, const EffectAt& one);
bool holds_in_any(const std::vector<std::vector<EffectAt>>& classes, const EffectAt& one);

// Whether its torque can be one of that joint: a mass has one on every joint that carries it.
bool shows_on(const EffectAt& one, Eigen::Index joint);

struct Finding {
  EffectAt what;
  // Whose error says most of it: its own joint, or of a mass one that carries it.
  Eigen::Index seen_on = 0;
  std::string words;
  std::string formula;  // of its torque, in its parameters
  std::vector<Estimate> parameters;
  double p_value = 1;   // of the whole search, wild block bootstrap
  double p_replay = 1;  // by playing the model without the effect, 1 where not asked for
  // Of the regression with all else that was found, rms torque error of `seen_on` without and with
  // it, N m or N: beside what is each recording's own, which no file has (JointErrors).
  double holdout_before = 0;
  double holdout_after = 0;
  double simulated_before = 0;  // the same of positions in short forward simulations, rad or m
  double simulated_after = 0;

  // Share of the error on held-out data.
  [[nodiscard]] double takes_of_held_out() const {
    return holdout_before > 0 ? 1 - holdout_after / holdout_before : 0;
  }
};

// "coulomb_friction"; "cogging_torque of order 72" where there may be several of it.
std::string title_of(const Finding& finding);

// A torque that the joint's error has over a variable, of a shape that no named effect has.
struct OverVariable {
  Eigen::Index joint = 0;
  std::string variable;  // "position", "velocity" or "load"
  // The effects that looked like it, and what they take of what a free function of it takes, 0
  // to 1.
  std::vector<EffectAt> stand_ins;
  double share = 0;
  // Its map: middles of equally filled bins of the variable, and the mean error there, N m or N.
  std::vector<double> at, torque;
};

// A stretch of time in which a joint's error stands out.
struct LoudSpan {
  Eigen::Index joint = 0;
  std::size_t recording = 0;  // from 0
  double from_s = 0;          // by the recording's own time stamps
  double to_s = 0;
};

// Something that a joint has, or has no longer, from a moment in the middle of a recording on, or
// in the recordings that were made after the others.
struct Change {
  EffectAt what;
  std::vector<EffectAt> alike;  // what else may have changed: these recordings cannot tell
  // In those recordings as a whole: then it has no moment.
  bool is_between = false;
  std::size_t recording = 0;                            // from 0; of those recordings the first
  double at_s = 0;                                      // by the recording's own time stamps
  std::optional<std::array<double, 2>> at_ci95_s = {};  // none: the moment was given
  // When it is gone again; none: it stays.
  std::optional<double> until_s;
  std::array<double, 2> until_ci95_s{};
  std::vector<Estimate> by;  // what of the effect is there more than before
  double p_value = 1;        // of the whole search for changes, wild block bootstrap
};

// "coulomb_friction on joint 4 from 14.98 s of recording 1 on (level +3.1 N m)", "tip_payload on
// joint 6 from before to after (mass +0.5 kg)".
std::string words_of(const Change& change);

// An effect that noise may hide: likely more than chance, and too unsure or too small to be named.
struct Suspicion {
  EffectAt what;
  double p_value = 1;  // of the whole search, wild block bootstrap
  double share = 0;    // of the squared error that it takes away, on the joint where that is most
};

struct Rejection {
  EffectAt what;
  double p_value = 1;
  double smallest_detectable = 0;  // rms torque that would have been seen; infinite: none would
  std::string unit;
};

struct JointErrors {
  Eigen::Index joint = 0;
  std::string unit;
  double rms_torque = 0;
  double rms_before = 0;         // of the file's model as it is, as compare() has it
  double rms_improved = 0;       // the same of the robot with what was found
  double rms_fitted_before = 0;  // with its numbers fitted within what they may be off
  double rms_after = 0;          // of the regression, with what is the recordings' own
  // On what no fit has seen: of the file as it is, and of the robot with what was found
  // (held_out_errors.hpp); at rest of the regression.
  double holdout_before = 0;
  double holdout_after = 0;
  double holdout_fitted = 0;  // of the regression there, with what is the recordings' own
  double noise_floor = 0;     // of the fitted recordings
  double holdout_noise_floor =
      0;  // of those that the held-out errors are of: another motion has another
};

// A known number of the robot file that the recordings contradict; `improved` has what they say.
struct Shift {
  Eigen::Index joint = 0;
  std::size_t effect = 0;  // of the robot file, as an index, and which of its parameters
  std::size_t parameter = 0;
  std::string name;
  double share = 0;  // of the file's value
  double file = 0;   // that value
  double came = 0;   // what the recordings say instead
  std::string unit;
};

// "viscous_friction.coefficient of joint 3 is 1.44 N m s/rad, not 1".
std::string words_of(const Shift& shift);

// What holds a joint where it has come to rest, by the direction from which it came: fitted beside
// everything else, never written. A hold map cannot say how much of it is Coulomb friction.
struct HoldFriction {
  Eigen::Index joint = 0;
  double level = 0;  // N m or N
  std::string unit;
};

// What is left of a joint's error.
struct Remains {
  double rms = 0;                   // N m or N
  double share_of_torque = 0;       // rms over rms torque
  double times_noise = 0;           // rms over the noise floor
  std::string follows = {};         // the variable that it follows most, or "time"; empty: nothing
  double share = 0;                 // of its energy that follows it
  std::vector<LoudSpan> when = {};  // where it follows time
};

// What stands beside the effects of a class that may be none of them.
inline constexpr const char* kOwnNumbers = "the model's own numbers";

// What is said of one joint; the joint counts from 0.
struct JointAnswer {
  Eigen::Index joint = 0;
  Verdict verdict = Verdict::kExplained;
  std::string words;
  std::vector<EffectAt> found;
  std::vector<std::vector<EffectAt>> ambiguous;
  Remains left;
};

struct Explanation {
  Verdict verdict = Verdict::kExplained;
  std::string words;
  bool holdout_is_apart = false;     // hold-out recordings, not blocks of time
  std::optional<FilterPlan> filter;  // of the first recording; none: nothing was left to search
  std::vector<JointErrors> joints;
  std::vector<JointAnswer> answers;  // per joint, the one that matters most first
  std::vector<Finding> found;        // what matters most first
  std::vector<OverVariable> over_variable;
  std::vector<LoudSpan> loud;
  // What acts on the arm from outside for a moment; left out of all else that is said.
  std::vector<Push> pushes;
  std::vector<Change> changes;  // the likeliest first
  // Whether it was asked what has changed since a given time or recording, and whether that is
  // what is in one recording and not in another.
  bool changes_asked = false;
  bool changes_between = false;
  // Joints whose model has neither Coulomb nor viscous friction.
  std::vector<Eigen::Index> without_friction;
  // Effects of which one is missing, per class; of a class of one it is that or the model's own
  // numbers.
  std::vector<std::vector<EffectAt>> ambiguous;
  // Of them, those that links which are off as CAD is could be (could_be_links()).
  std::vector<EffectAt> or_links;
  std::optional<Suspicion> suspected;  // only where it makes the verdict
  std::vector<Rejection> rejected;
  std::vector<StructureShare> where;  // of what is left, largest first
  std::vector<Shift> shifts;
  // How far the links' masses, centres of mass and inertias were let off the file, and whether the
  // recordings said so.
  double link_share = 0;
  bool link_share_judged = false;
  std::vector<DataFault> data_faults;  // that make the verdict
  std::vector<DataFault> data_hints;   // that leave the answer right
  std::vector<DataFault> left_out;     // whose stretches are left out
  std::vector<Excitation> excitation;
  // Joints on which something shows that these recordings do not tell from the model's own numbers.
  std::vector<Eigen::Index> unsure;
  // Joints that nothing was found of and that other numbers of the links would predict worse: the
  // links stay as the robot file has them.
  std::vector<Eigen::Index> links_kept_for;
  std::vector<std::string> advice;
  std::string robot_file = "ROBOT";         // as commands in the advice name it
  std::string reading;                      // ExplainOptions::reading
  bool at_rest = false;                     // by hold maps
  std::vector<HoldFriction> hold_friction;  // of hold maps, per joint that came from both sides

  // For pictures, of every recording that was searched or held out, or of every stretch of it: one
  // row per kept sample, columns: joints.
  struct Series {
    std::string name;  // of the recording, as the user named it, and which stretch of it
    Eigen::VectorXd t_s;
    Eigen::MatrixXd measured, model_before, model_after, q, dq, load;
  };
  std::vector<Series> series;
  // Hold-out error of every joint with the findings so far, from none to all.
  std::vector<Eigen::VectorXd> waterfall;
  // The robot with what was found and with the numbers fitted beside it; improved_robot.hpp.
  RobotDescription improved;
  std::vector<std::string> unwritable;  // what of the findings is not in it, and why
  std::vector<HeldNumber> held;         // of `improved`
  // Fitted beside the links' numbers and written with them; empty: none.
  std::vector<FittedConstant> torque_constants;
  std::vector<std::string> unphysical;  // what physics forbids of it
};

// Whether a class of `ambiguous` may be no effect at all, but the model's own numbers.
bool may_be_own_numbers(const Explanation& e, const std::vector<EffectAt>& same);
// Whether `improved` has the finding: not where the recordings do not tell it from another effect,
// and not beside a number of its joint that was held against what they say.
bool is_written(const Explanation& e, const EffectAt& finding);
// Whether the recordings say that the robot file's links are off by more than CAD is, and
// `improved`, which has others, leaves at most half of the joint's error on data that no fit has
// seen; of any joint. Not where a joint moves too little to tell, nor where another's error rises.
bool gains_by_links(const Explanation& e, const JointErrors& joint);
bool gains_by_links(const Explanation& e);
// Whether `improved` says more than what was fitted beside.
bool changes_the_file(const Explanation& e);

struct ExplainOptions {
  int threads = 1;
  std::uint64_t seed = 1;
  int bootstrap_draws = 1999;
  int replays = 19;  // 0: none
  // How far the links' numbers may be off the file, two standard deviations as a share; none: what
  // the recordings say of it (link_share.hpp).
  std::optional<double> link_share = {};
  // Whether the numbers of the file's effects are right as they are: nothing is fitted beside them.
  bool keep_effects = false;
  int most_effects = 6;         // of one joint
  std::string source = {};      // what `improved` says of where its numbers come from
  std::string robot_file = {};  // as the user named it, for commands in the advice; empty: "ROBOT"
  // What every command has to be given that reads the same recordings, " --channels c.toml", for
  // the advice.
  std::string reading = {};
  std::vector<KeepFault> keep = {};  // of the doctor's findings, that are no faults
  // When the robot may have become another one, where that is known: nothing else is then asked of
  // changes. The recordings from this one on were made after it (0: none of them), or what the only
  // recording has from there on, by its own time stamps.
  std::size_t after = 0;
  std::optional<double> since_s = {};
};

// Which effects the robot's model lacks, by recordings of it. `holdout` may be empty: then parts of
// the recordings are held out in turn. Throws InputError where the recordings and the robot do not
// fit together or are too short, and in the names of --after and --since, where the options say
// what cannot be.
Explanation explain(const RobotDescription& robot, std::vector<Log> logs, std::vector<Log> holdout,
                    const ExplainOptions& options, const OnProgress& on_progress = {});
Explanation explain(const RobotDescription& robot, const Treated& recordings,
                    const ExplainOptions& options, const OnProgress& on_progress = {});

}  // namespace offnominal::desk
