#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "identify/column_cache.hpp"
#include "identify/nuisance.hpp"
#include "identify/rows.hpp"
#include "identify/workspace.hpp"
#include "log/log.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk {

// Recordings of one robot as a regression: target = nuisance.columns * x + missing effects + noise.
struct Data {
  std::vector<Workspace> recordings;
  RowLayout layout;
  std::shared_ptr<InertialColumns> inertial;  // of `recordings`
  Nuisance nuisance;
  Eigen::VectorXd torque;  // measured, filtered, stacked
  Eigen::VectorXd target;  // measured minus model torque
  // Of `recordings`, which do not change: copies of these data share it.
  std::shared_ptr<ColumnCache> cache;

  Data(std::vector<Workspace> made, const RobotDescription& robot, const NuisanceOptions& options);
  // `inertial_columns`: of the same motions, joints and gravity.
  Data(std::vector<Workspace> made, std::shared_ptr<InertialColumns> inertial_columns,
       const RobotDescription& robot, const NuisanceOptions& options);
  // The same recordings of the same robot beside another nuisance.
  Data(const Data& same, const RobotDescription& robot, const NuisanceOptions& options);
  // The same recordings of a robot with other masses or effects, and the same joints and gravity.
  static Data of_robot(const Data& same, const RobotDescription& robot,
                       const NuisanceOptions& options);
};

// The error of a robot file as it is, rms per joint (N m or N), on the data's rows that say
// something.
Eigen::VectorXd errors_as_it_is(const RobotDescription& file, const Data& data);
// The same of recordings of the robot, whatever model they have; `torque`: measured, stacked.
Eigen::VectorXd errors_as_it_is(const RobotDescription& file, std::vector<Workspace> recordings,
                                const RowLayout& layout, const Eigen::VectorXd& torque);

// The width of the smoothed sign that the motion can resolve, per joint; 0 where it does not move.
Eigen::VectorXd resolved_sign_widths(const std::vector<Log>& logs, const FilterPlan& plan);
// Sets it, where it is above 0, in every effect that has one.
void set_sign_widths(RobotDescription& robot, const Eigen::VectorXd& widths);

// The width that a fit of these recordings begins with, per joint, which robot and recordings have
// from now on: that of the robot file's own effects that no fit has made (a fit without all effects
// bends it) where the file meets the recordings clearly better with it, otherwise what the motion
// resolves. `recordings`: of this robot.
Eigen::VectorXd settle_sign_widths(const Eigen::VectorXd& resolved, RobotDescription& robot,
                                   std::vector<Workspace>& recordings);

// Sets the width of the smoothed sign of every effect that has one to what the motion can resolve,
// and returns it per joint. The shape of the build-up at a reversal is a nuisance.
Eigen::VectorXd set_sign_widths(RobotDescription& robot, const std::vector<Log>& logs,
                                const FilterPlan& plan);

}  // namespace offnominal::desk
