#pragma once

#include <optional>
#include <vector>

#include "explain/explain.hpp"
#include "identify/file_errors.hpp"
#include "identify/held_out_errors.hpp"
#include "identify/improved_robot.hpp"

namespace offnominal::desk {

// What a new robot file is judged by: the one that it came from, and the recordings. All of it has
// to outlive it. Not for several threads at once.
class Judged {
 public:
  // `holdout`, empty: parts of `logs` are held out in turn. `plan`: the filter of all of them.
  Judged(const RobotDescription& file, const std::vector<Log>& logs,
         const std::vector<Log>& holdout, const FilterPlan& plan)
      : file_(file), logs_(logs), holdout_(holdout), plan_(plan) {}

  [[nodiscard]] const RobotDescription& file() const { return file_; }
  [[nodiscard]] const std::vector<Log>& holdout() const { return holdout_; }
  // Those of the file are asked once.
  [[nodiscard]] const FileErrors& errors_of_file() const;
  [[nodiscard]] const FileErrors& held_out_errors_of_file() const;
  // Of what is fitted, and of what is held out.
  [[nodiscard]] FileErrors errors_of(const RobotDescription& robot) const;
  [[nodiscard]] FileErrors held_out_errors_of(const RobotDescription& robot) const;

 private:
  const RobotDescription& file_;
  const std::vector<Log>& logs_;
  const std::vector<Log>& holdout_;
  const FilterPlan& plan_;
  mutable std::optional<FileErrors> errors_of_file_;
  mutable std::optional<FileErrors> held_out_errors_of_file_;
};

HeldOutErrors held_out_of(const Judged& by, const ImprovedRobot& improved);

// Fills in the errors of the joints, of both files. Not of readings at rest: they have no filter,
// and their friction by the direction of approach no file.
void tell_errors_of_files(const Judged& by, const ImprovedRobot& improved, Explanation& result);

// Gives the effects of these joints, a flag each, the numbers of another fit of the same effects
// and others, where that lowers the joint's error. Masses, and constants of drives, belong to the
// links and stay. Returns the joints that have other numbers then.
std::vector<Eigen::Index> take_better_numbers(const Judged& by, const RobotDescription& other,
                                              const std::vector<char>& joints,
                                              RobotDescription& robot);

// Joints whose error on data that no fit has seen rises although nothing is changed at them, by
// more than what a twentieth is: what raises it are the links' numbers that were fitted beside.
// `changed`: per joint, whether an effect or a number of it is.
std::vector<Eigen::Index> raised_by_links(const Judged& by, const ImprovedRobot& improved,
                                          const std::vector<char>& changed);

}  // namespace offnominal::desk
