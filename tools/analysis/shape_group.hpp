#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "analysis/motion.hpp"
#include "robot/robot.hpp"

namespace offnominal::tools {

// A shape parameter of an effect: robot.effects[effect].parameters[parameter].
struct ShapeMember {
  std::size_t effect = 0;
  std::size_t parameter = 0;
};

// Shape parameters that have one common value, which the fit searches for. The widths of the
// smoothed sign of one joint are one group: two widths on one joint could not be told apart.
struct ShapeGroup {
  enum class Search {
    kGrid,         // the whole grid, then between its points
    kDiscrete,     // the whole grid and nothing between
    kPeriodicQ,    // period in position: the grid is screened with the residual first
    kPeriodicTime  // period in time: likewise
  };
  std::vector<ShapeMember> members;
  std::string name;  // of the parameter
  Search search = Search::kGrid;
  bool logarithmic = false;
  std::vector<double> grid;  // ascending
  double start = 0;
};

// The groups that are searched when the effects `added` (indices into robot.effects) are fitted
// together with the `refitted` ones: shape parameters of the added effects that are not in `given`,
// with grids chosen from the motion. Lengths are never searched.
// Widths of the smoothed sign: where a refitted effect of the joint has one, it joins the group;
// where an effect that is not refitted has one, the added effects take that value over and nothing
// is searched. The width of a coupling is that of the joint it follows. Another joint that has only
// one candidate is not searched for. Sets such taken-over and starting values in `robot`.
std::vector<ShapeGroup> make_shape_groups(RobotDescription& robot,
                                          const std::vector<std::size_t>& added,
                                          const std::vector<std::size_t>& refitted,
                                          const std::vector<ShapeMember>& given,
                                          const Motion& motion, double torque_cutoff_hz);

// The description with every group's members at the group's value.
RobotDescription with_shapes(RobotDescription robot, const std::vector<ShapeGroup>& groups,
                             const std::vector<double>& values);

}  // namespace offnominal::tools
