#pragma once

#include <Eigen/Core>
#include <vector>

#include "discovery/nuisance.hpp"
#include "discovery/rows.hpp"
#include "discovery/workspace.hpp"
#include "log/log.hpp"
#include "robot/robot.hpp"

namespace offnominal::tools::discovery {

// Recordings of one robot as a regression: target = nuisance.columns * x + missing effects + noise.
struct Data {
  std::vector<Workspace> recordings;
  RowLayout layout;
  Nuisance nuisance;
  Eigen::VectorXd torque;  // measured, filtered, stacked
  Eigen::VectorXd target;  // measured minus model torque

  Data(std::vector<Workspace> made, const RobotDescription& robot, const NuisanceOptions& options);
};

// Same filter for all: cut-off by what the encoder's resolution leaves of the acceleration. None
// for hold maps.
FilterPlan discovery_filter(const std::vector<Log>& logs, const RobotDescription& robot);

// Samples per second of a recording as blocks of time count them. Readings at rest have no time: so
// many a "second" that a recording has about 300 of the shortest blocks, of 5 readings or more.
double sample_rate_of(const Log& log);

// The same filter for a recording that has its own sample rate.
FilterPlan plan_for(const Log& log, FilterPlan plan);

// Sets the width of the smoothed sign of every effect that has one to what the motion can resolve,
// and returns it per joint. The shape of the build-up at a reversal is a nuisance.
Eigen::VectorXd set_sign_widths(RobotDescription& robot, const std::vector<Log>& logs,
                                const FilterPlan& plan);

}  // namespace offnominal::tools::discovery
