#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "identify/fit.hpp"
#include "identify/inertial_columns.hpp"
#include "identify/rows.hpp"
#include "identify/term.hpp"
#include "identify/workspace.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk {

// What is fitted in every model, with and without a candidate, and never reported as a discovery:
// the numbers of the robot file within what its author may have got wrong.
struct NuisanceTerm {
  enum class Kind {
    kLink,         // mass and inertia of a link, as a share
    kLinkCentre,   // centre of mass of a link along axis `parameter` of its frame, m
    kLinkInertia,  // inertia of a link about its centre of mass, as a share
    kConstant,     // torque constant of a joint's drive, as the error of torque_scale
    kKnownEffect,  // a linear parameter of an effect of the robot file, as a difference
    kSignShape,    // how dry friction builds up at a reversal; only beside dry friction
    kSkew,         // time skew between torque and position, s
    kApproach,     // of hold maps: friction by the direction of approach, N m or N
    kChange,       // a coefficient of an effect that acts in a part of a recording
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

// How a link differs from what a prior is about.
struct LinkChange {
  double factor = 1;                        // of mass and inertia
  double inertia_factor = 1;                // of inertia, beyond that
  std::array<double, 3> centre_m{0, 0, 0};  // by which the centre of mass is moved

  // The largest of its changes as a share; a centre's in `size_m`.
  [[nodiscard]] double largest(double size_m) const;
};

struct NuisanceOptions {
  // As far as these may be off, two standard deviations of what is believed:
  double link_share = 0.05;  // mass and inertia of a link, as a share; 0: they are right
  // Mass, centre of mass and inertia of a link each by itself, for numbers that are little more
  // than a guess: one factor for a link is right where its geometry is.
  bool link_geometry = false;
  // Torque constants, as a share; 0: they are right, as on one joint and at rest, which do not
  // tell them from masses. One that the file has a torque_scale for is a number of the file.
  double torque_constant = 0;
  double skew_samples = 1.0;  // torque against position; 0: they are of one time
  // By which each link of the robot differs from what the prior is about; empty: by nothing.
  std::vector<LinkChange> links = {};
  std::vector<KnownNumber> known = {};  // what is left out is free
  // Effects of the robot, as indices, whose linear numbers are fitted; none: those of all.
  std::optional<std::vector<std::size_t>> free_effects = {};
  // Beside dry friction, ways to build up at a reversal that no robot file can say.
  bool sign_shapes = true;
  // Per joint, what their widths are shares of, rad or m: of the data that are fitted, so that a
  // coefficient has one meaning on what is held out too. Empty: what the recordings themselves
  // move.
  Eigen::VectorXd ranges_moved = {};
  // What changed in the middle of a recording: no robot file can say it.
  std::vector<Term> changes = {};
};

// Size of a link, m, that its centre of mass is counted in: how far that is from the joint, or the
// radius of gyration where this is more.
double size_of_link(const RobotDescription& robot, std::size_t link);

// `inertial`: of the recordings.
Nuisance make_nuisance(const RobotDescription& robot, const std::vector<Workspace>& recordings,
                       const RowLayout& layout, const NuisanceOptions& options,
                       InertialColumns& inertial);

}  // namespace offnominal::desk
