#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "robot/robot.hpp"

namespace offnominal::desk {

// The combinations of links' inertial numbers and rotor inertias that torques depend on, whatever
// the motion (M. Gautier, J. Robotic Systems 8(4), 1991): numerically, at random states of the
// joints that move.
struct BaseParameters {
  // What numbers stand for, in order: the ten of every link that is free, then rotor inertias.
  std::vector<std::string> symbols;
  // One row per base parameter, in the numbers. The leading number of each row has a factor of 1.
  Eigen::MatrixXd combinations;
  std::vector<Eigen::Index> leading;
  std::vector<std::string> names;  // "Izz1 + Iyy2 + 0.09 m2"
  std::vector<std::string> units;

  [[nodiscard]] Eigen::Index count() const { return combinations.rows(); }
};

struct BaseRequest {
  std::vector<std::size_t> links;   // whose ten numbers are free, from 0
  std::vector<std::size_t> rotors;  // joints with a rotor inertia of their own
  std::vector<char> moves;          // per joint; one that stands is held, and its torque not read
  std::vector<double> stands_at;    // per joint, rad or m
};

BaseParameters base_parameters(const RobotDescription& robot, const BaseRequest& request);

// Whether a rotor's inertia is none of the numbers of the links: that of the first joint is part of
// the link's.
std::vector<std::size_t> rotors_apart(const RobotDescription& robot, const BaseRequest& request);

}  // namespace offnominal::desk
