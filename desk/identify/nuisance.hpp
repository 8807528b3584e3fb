#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "identify/fit.hpp"
#include "identify/rows.hpp"
#include "identify/workspace.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk {

// What is fitted in every model, with and without a candidate, and never reported as a discovery:
// the numbers of the robot file within what its author may have got wrong.
struct NuisanceTerm {
  enum class Kind {
    kLink,         // mass and inertia of a link, as a share
    kKnownEffect,  // a linear parameter of an effect of the robot file, as a difference
    kSignShape,    // how dry friction builds up at a reversal; only beside dry friction
    kSkew,         // time skew between torque and position, s
    kApproach,     // of hold maps: friction by the direction of approach, N m or N
  };
  Kind kind = Kind::kLink;
  Eigen::Index joint = 0;  // or link
  std::size_t effect = 0;  // kKnownEffect: index into the robot's effects
  std::size_t parameter = 0;
  Prior prior;
  std::string name;  // in words
};

struct Nuisance {
  std::vector<NuisanceTerm> terms;
  Eigen::MatrixXd columns;  // stacked, filtered, not weighted; one per term
};

// A number of an effect of the robot file, as a difference, is not free.
struct KnownNumber {
  std::size_t effect = 0;
  std::size_t parameter = 0;
  double low = 0;
  double high = 0;
};

struct NuisanceOptions {
  // As far as these may be off, two standard deviations of what is believed:
  double link_share = 0.05;   // mass and inertia of a link, as a share; 0: they are right
  double skew_samples = 1.0;  // torque against position; 0: they are of one time
  // Factor by which mass and inertia of each link of the robot differ from what the prior is about;
  // empty: by none.
  std::vector<double> link_factors = {};
  std::vector<KnownNumber> known = {};  // what is left out is free
  // Effects of the robot, as indices, whose linear numbers are fitted; none: those of all.
  std::optional<std::vector<std::size_t>> free_effects = {};
  // Beside dry friction, ways to build up at a reversal that no robot file can say.
  bool sign_shapes = true;
};

Nuisance make_nuisance(const RobotDescription& robot, const std::vector<Workspace>& recordings,
                       const RowLayout& layout, const NuisanceOptions& options);

}  // namespace offnominal::desk
