#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "compare/compare.hpp"
#include "compare/filter_plan.hpp"
#include "compare/measurement.hpp"
#include "identify/inertial_columns.hpp"
#include "identify/stretches.hpp"
#include "identify/workspace.hpp"
#include "log/log.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk {

// What add() makes of its recordings, kept from one fit to the next: everything that does not
// follow from the model, and how the last robot compares. A fit with it is the fit without, to the
// bit. Of robots that differ in their effects alone, with one filter; not for several threads at
// once.
class FitMemory {
 public:
  // For how many fits: one alone needs no measurement for a second time.
  enum class For { kOneFit, kMany };
  // The recordings have to outlive it, unchanged.
  FitMemory(const std::vector<Log>& logs, const std::vector<Log>& holdout,
            const FilterRequest& filter = {}, For fits = For::kMany)
      : logs_(logs), holdout_(holdout), filter_(filter), for_(fits) {}

  [[nodiscard]] const std::vector<Log>& logs() const { return logs_; }
  [[nodiscard]] const std::vector<Log>& holdout() const { return holdout_; }

  // plan_filter() of the fitted recordings.
  const FilterPlan& plan(const RobotDescription& robot);
  // resolved_sign_widths() of them.
  const Eigen::VectorXd& sign_widths(const RobotDescription& robot);
  // searched_workspaces() of their stretches.
  std::vector<Workspace> workspaces(const RobotDescription& robot,
                                    const Eigen::VectorXd& sign_width);
  // Of the workspaces that were asked for last.
  [[nodiscard]] const std::shared_ptr<InertialColumns>& inertial() const { return inertial_; }
  // measure() and compare() of two robots on every one of them, and on the hold-out recordings.
  struct Two {
    Comparisons before;
    Comparisons after;
  };
  Two compared(const RobotDescription& before, const RobotDescription& after);
  Two compared_held_out(const RobotDescription& before, const RobotDescription& after);
  // The same of one robot, which the next two are not compared with.
  Comparisons compared(const RobotDescription& robot) { return compare_one(robot, logs_, fitted_); }
  Comparisons compared_held_out(const RobotDescription& robot) {
    return compare_one(robot, holdout_, held_out_);
  }

 private:
  struct Known {
    std::vector<Measurement> measured;
    std::vector<ModelTorqueMemory> models;  // of each of them
    std::string robot;                      // the text of the one that was compared last
    Comparisons result;
  };
  const Measurement& measured(const std::vector<Log>& logs, std::size_t recording,
                              const RobotDescription& robot, Known& known);
  Comparisons compare_one(const RobotDescription& robot, const std::vector<Log>& logs,
                          Known& known);
  Two compare_two(const RobotDescription& before, const RobotDescription& after,
                  const std::vector<Log>& logs, Known& known);

  const std::vector<Log>& logs_;
  const std::vector<Log>& holdout_;
  FilterRequest filter_;
  For for_;
  std::optional<FilterPlan> plan_;
  std::optional<Eigen::VectorXd> sign_widths_;
  std::vector<Stretch> stretches_;
  std::vector<Workspace> workspaces_;
  std::shared_ptr<InertialColumns> inertial_;
  Known fitted_;
  Known held_out_;
};

}  // namespace offnominal::desk
