#pragma once

#include <vector>

#include "analysis/add.hpp"
#include "analysis/shape_group.hpp"
#include "analysis/unknown.hpp"

namespace offnominal::tools {

// What add() fits: the robot with the new effects in it, their linear parameters 0 unless given.
struct AddSetup {
  RobotDescription robot;
  std::vector<std::size_t> added;
  std::vector<Unknown> unknowns;  // those of the new effects last
  std::vector<ShapeMember> given;
  std::vector<std::size_t> refitted;  // effects that were there and are fitted again
};

// Throws InputError as add().
AddSetup set_up(const RobotDescription& robot, const AddRequest& request);

}  // namespace offnominal::tools
