#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "explain/as_written.hpp"
#include "explain/change.hpp"
#include "explain/explain.hpp"
#include "explain/found_model.hpp"
#include "explain/pushes.hpp"
#include "explain/search_setting.hpp"
#include "explain/sizes.hpp"
#include "identify/improved_robot.hpp"

namespace offnominal::desk {

// One search over recordings of a robot: what is missing, what it could be as well, and the robot
// file with it. What it is made of has to outlive it. Throws InputError as explain().
class Explainer {
 public:
  Explainer(const RobotDescription& robot, const std::vector<Log>& logs,
            const std::vector<Log>& holdout, const ExplainOptions& options,
            const OnProgress& on_progress);

  // A recording at fault tells nothing of effects: then there is no search, and what the model
  // leaves of the recording is still shown. `pushes`: that the recordings are without.
  Explanation run(bool search, std::vector<Push> pushes);

  // Of what is searched and of what is held out.
  [[nodiscard]] std::vector<Push> pushes() const;

  // What was not searched, in words; empty where all was.
  [[nodiscard]] const std::string& left_out() const { return left_out_; }

  // The robot with all that run() has found, also what the recordings do not tell from another
  // effect: Explanation::improved is without that.
  [[nodiscard]] const RobotDescription& with_all_found() const { return with_all_found_; }

 private:
  struct Settled {
    ImprovedRobot improved;
    Sizes sizes;
  };

  void tell(const std::string& doing) const;

  // What is known before the search.
  [[nodiscard]] Explanation begun(std::vector<Push> pushes) const;

  // Which names stay beside what else they could be, and the numbers of the model with them: until
  // none gives way to its own.
  [[nodiscard]] Settled settle(FoundModel& found, Explanation& result) const;

  // What shows and cannot be told from something else, or from the model's own numbers.
  void add_undecided(const FoundModel& found, const ImprovedRobot& improved,
                     Explanation& result) const;

  [[nodiscard]] FoundModel find(bool search, const Explanation& result) const;

  [[nodiscard]] ImprovedRobot robot_with(const std::vector<Term>& terms, const ModelFit& fit,
                                         const Explanation& result, bool keeps_links) const;
  [[nodiscard]] ImprovedRobot fitted_robot(const FoundModel& found, const Explanation& result,
                                           bool keeps_links) const;

  // All that is written. Links get other numbers where the recordings support that: where a joint
  // that nothing was found of would be predicted worse, they stay as the file has them.
  ImprovedRobot fitted_robot(const FoundModel& found, Explanation& result) const;

  // Without names of unsure size, as run() does in the end.
  [[nodiscard]] FoundModel sure_of(FoundModel found, const Explanation& result) const;

  // Whether a name was taken back, or gave its place to a simpler one.
  bool gives_one_up(const Sizes& sizes, FoundModel& found) const;

  // With links as far off as the recordings ask for, where nobody has said how far that is.
  FoundModel search_model(bool search, Explanation& result);

  // Another nuisance from now on; returns the setting that was.
  SearchSetting set_beside(const NuisanceOptions& nuisance);

  // The same beside what changes in the middle of a recording, if anything does: it is asked of
  // the model without, and what is missing all the time is then sought anew beside it.
  FoundModel search_with_changes(bool search, Explanation& result);

  // Beside the effects that were found.
  [[nodiscard]] std::vector<FoundChange> changes_in(const FoundModel& found) const;

  // What could as well be something else is not written, nor what stands beside a number that
  // cannot be. The links' numbers were fitted beside it, so that they do not take its place; what
  // else is written of its joint was fitted to what it leaves, and fits nothing without it.
  void leave_out_undecided(const FoundModel& found, Explanation& result,
                           ImprovedRobot& improved) const;

  // Numbers of those joints' effects from a fit of these terms alone.
  void take_numbers_without(const std::vector<Term>& kept, const std::vector<char>& joints,
                            Explanation& result, ImprovedRobot& improved) const;

  // A hold map may show one order after the other: as many as robot files have room for.
  [[nodiscard]] int most_effects() const;

  // Of a robot file, and with what is carried in a recording, which is one more, and the torque
  // constants that are written with the links.
  [[nodiscard]] int room_for_effects() const;

  const RobotDescription& file_;
  RobotDescription robot_;  // the same with signs as wide as the motion can resolve
  RobotDescription with_all_found_;
  const std::vector<Log>& logs_;
  const std::vector<Log>& holdout_;
  FilterPlan plan_;  // of all of them
  Judged judged_;
  ExplainOptions options_;
  const OnProgress& on_progress_;
  std::vector<char> both_ways_;
  std::string left_out_;
  SearchSetting setting_;
  std::vector<FoundChange> changes_;
  std::optional<TimeSpan> given_;  // the only part that may differ from the rest
};

}  // namespace offnominal::desk
