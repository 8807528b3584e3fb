#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "compare/filter_plan.hpp"
#include "identify/workspace.hpp"
#include "log/log.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk {

// A part of a recording that is searched as one of its own.
struct Stretch {
  const Log* log = nullptr;
  Eigen::Index first = 0;
  Eigen::Index samples = 0;
  // Samples at both ends that are only led in and out: what remembers has forgotten how it began.
  Eigen::Index margin = 0;

  [[nodiscard]] bool is_whole() const { return samples == log->sample_count(); }
  // The samples as a recording.
  [[nodiscard]] Log cut() const;
};

// What of the recordings is searched: all of it, or where that is more than the search can bear,
// stretches of half a minute that lie evenly over all of them. A search costs as much as there are
// filtered samples times joints times unknowns, and half an hour of one arm shows no effect that a
// few minutes over the same time do not. A robot whose file has effects in time is searched as a
// whole, because they count from the start of a run.
std::vector<Stretch> stretches_of(const std::vector<Log>& logs, const RobotDescription& robot,
                                  const FilterPlan& plan);

// The stretches as the search sees them, without their margins; effects in time count from the
// start of the recording that a stretch is of.
std::vector<Workspace> searched_workspaces(const std::vector<Stretch>& stretches,
                                           const RobotDescription& robot, const FilterPlan& plan,
                                           const Eigen::VectorXd& sign_width);

// What was left out, in words for the user; empty where nothing was.
std::string words_of(const std::vector<Stretch>& stretches, const std::vector<Log>& logs);

}  // namespace offnominal::desk
