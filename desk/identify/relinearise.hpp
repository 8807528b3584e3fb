#pragma once

#include <memory>
#include <vector>

#include "identify/data.hpp"
#include "identify/regression.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk {

// A model fitted anew about the links that its first fit found. Effects that scale what the model
// says (a torque constant, friction by load, elasticity) enter beside the links' masses as a
// product; a regression about the robot file alone leaves that product out.
struct Relinearised {
  std::vector<LinkChange> links;  // of the file's links
  NuisanceOptions nuisance;       // that `data` was made with
  std::unique_ptr<Data> data;
  std::vector<Term> terms;  // shapes refined
  ModelFit fit;
};

// `robot`: the one that `data` was made with; `fit`: of the terms to the data.
Relinearised relinearise(const RobotDescription& robot, const Data& data,
                         const NuisanceOptions& options, const std::vector<Term>& terms,
                         const ModelFit& fit);

RobotDescription with_link_changes(RobotDescription robot, const std::vector<LinkChange>& links);

}  // namespace offnominal::desk
