#pragma once

#include <vector>

#include "inertial/pseudo_inertia.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk {

// What is believed of the links before any recording is seen. Whatever the data leave open stays
// near it.

// A body with extent where the file has a point mass, a rod or a plate: those are at the edge of
// what bodies can be, and nothing is beside an edge. Its mass and centre are the file's.
PseudoInertia believed_inertia(const RobotDescription& robot, std::size_t link);

// Of an arm of which nothing but the geometry is known: each link a bar from its joint to the next,
// as thick as a quarter of the arm's mean link, all of one weight per length, 1 kg/m: the data say
// how much. The last link, of which nobody knows where it ends, is a ball about its joint, of half
// a link's radius of gyration.
std::vector<Joint<double>> joints_of_geometry(const RobotDescription& robot);

}  // namespace offnominal::desk
