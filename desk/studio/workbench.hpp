#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "compare/compare.hpp"
#include "explain/explain.hpp"
#include "identify/add.hpp"
#include "report/page.hpp"
#include "robot/payload.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk::studio {

/// What a session works on, read and examined as `offnominal add` does.
struct Input {
  RobotDescription robot;
  std::string robot_file;                     // as the user named it
  std::shared_ptr<const Treated> recordings;  // one to fit or more; `holdout` may be empty
  std::vector<std::string> log_files;         // as the user named them
  std::vector<std::string> holdout_files;     // the same
  std::string source;                         // what fitted effects say of where they come from
  std::string options;                        // of every command that repeats the session, or empty
  std::vector<RecordingPayload> payloads;     // what --payload says of some of the recordings
  std::optional<std::string> output;          // the file that -o names; none: beside the robot file
  std::vector<std::string> commands_before;   // those that make the files of this session
  std::vector<report::EventMark> marks;       // in the time of the first recording
  // Beside what its state is kept, as beside a recording; none: nowhere.
  std::optional<std::filesystem::path> keep_beside = {};
  std::string commands_note;  // what those who repeat the session have to know, or empty
  int threads = 1;            // of explain
};

/// The effect that a robot file calls so; none: there is no such effect.
[[nodiscard]] std::optional<EffectKind> effect_named(const std::string& name);

/// One effect that was switched on.
struct Step {
  std::size_t id = 0;  // never used twice in a session
  EffectKind kind = EffectKind::kViscousFriction;
  std::size_t joint = 0;  // from 0
};

/// Its fit to all the recordings, together with the steps before it.
struct Fitted {
  AddRequest request;
  AddResult result;
};

/// One model against the recordings.
struct Compared {
  Comparisons fitted;
  std::optional<Comparisons> held_out;  // none: no recording is held out
};

/// From 0, the fitted ones first; `recording` is less than there are.
const Comparison& recording_of(const Compared& compared, std::size_t recording);

/// The robot as it was read with a stack of added effects. Every step is one add() to the robot of
/// the step before, as `offnominal add` would do it to its file: the numbers are the same.
/// Not for several threads at once.
class Workbench {
 public:
  /// Throws InputError where the recordings and the robot do not fit together.
  explicit Workbench(Input input);

  [[nodiscard]] const Input& input() const { return input_; }
  [[nodiscard]] const std::vector<Step>& steps() const { return steps_; }
  /// Throws Refused for an unknown id.
  [[nodiscard]] const Step& step(std::size_t id) const;
  [[nodiscard]] const Fitted& fitted(std::size_t step) const { return *fits_[step]; }
  /// With all steps.
  [[nodiscard]] const RobotDescription& robot() const { return robot_after(steps_.size()); }
  [[nodiscard]] const Compared& start() const { return start_; }
  [[nodiscard]] const Compared& now() const { return now_; }

  /// Error of a joint with the first `steps` steps, 100 |tau - tau_m| / |tau|: on the fitted
  /// recordings, and on data that no fit has seen, as `add` says it. NaN where there is none:
  /// without held-out recordings before the first step that touches the joint.
  [[nodiscard]] double fitted_percent(std::size_t joint, std::size_t steps) const;
  [[nodiscard]] double held_out_percent(std::size_t joint, std::size_t steps) const;

  /// Why an effect cannot be added to a joint now, in words; empty: it can be tried.
  [[nodiscard]] std::string why_not(EffectKind kind, std::size_t joint) const;

  /// Another model against the same recordings.
  [[nodiscard]] Compared compared_with(const RobotDescription& robot);
  /// The effect of a step, with the numbers that the robot with all steps has. Throws Refused for
  /// an unknown id; so do the next two.
  [[nodiscard]] const RobotEffect& effect(std::size_t id) const {
    return robot().effects[effect_of(id)];
  }
  /// The robot with all steps, but for one of them: what the effect does by itself.
  [[nodiscard]] RobotDescription robot_without(std::size_t id) const;
  /// The robot with all steps, one number of one of them moved off its fit. Throws Refused for an
  /// unknown parameter, too, and where the effect cannot have that value.
  [[nodiscard]] RobotDescription robot_with(std::size_t id, const std::string& parameter,
                                            double value) const;

  /// Adds an effect on top. Throws InputError as desk::add(), Refused where its fit must not be
  /// used; nothing has changed then.
  void add(EffectKind kind, std::size_t joint);
  /// Takes a step away; those above it are fitted anew. Throws Refused for an unknown id and where
  /// one above cannot be without it; nothing has changed then.
  void undo(std::size_t id);
  void undo_all() { take({}); }

 private:
  using Fit = std::shared_ptr<const Fitted>;

  [[nodiscard]] const RobotDescription& robot_after(std::size_t steps) const;
  // Among the effects of robot(): those above it are added behind it.
  [[nodiscard]] std::size_t effect_of(std::size_t id) const;
  [[nodiscard]] AddRequest request_of(const Step& step) const;
  // With all of these fits.
  [[nodiscard]] static Compared compared(const Fitted& last);
  [[nodiscard]] std::vector<Fit> fits_of(const std::vector<Step>& steps);
  Fit fit(const RobotDescription& robot, const Step& step, const std::string& key);
  void take(std::vector<Step> steps);

  Input input_;
  FitMemory memory_;
  std::vector<Step> steps_;
  std::vector<Fit> fits_;
  std::map<std::string, Fit> known_;  // by the steps up to it: what was undone comes back at once
  std::size_t most_known_ = 0;
  Compared start_;
  Compared now_;
  std::size_t next_id_ = 1;
};

}  // namespace offnominal::desk::studio
