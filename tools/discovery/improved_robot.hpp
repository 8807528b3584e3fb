#pragma once

#include <string>
#include <vector>

#include "discovery/explain.hpp"
#include "discovery/relinearise.hpp"
#include "robot/robot.hpp"

namespace offnominal::tools::discovery {

// The robot as it was read, with what was found: the effects, marked fitted; the numbers of the
// effects that were fitted before; mass and inertia of the links. Fitted together, they belong
// together.
struct ImprovedRobot {
  RobotDescription robot;
  // Found, but not among the effects that a robot file can say; the rest is then of no use alone.
  std::vector<std::string> unwritable;
  std::vector<HeldNumber> held;
  std::vector<std::string> unphysical;  // why it must not be used; empty: it may
};

// `file`: the robot as it was read; `robot`: the one that `data` was made with; `source`: what the
// effects say of where their numbers come from. The numbers are fitted without what no robot file
// can say; links that differ from the file by less than kWorthWriting stay as they are.
ImprovedRobot improved_robot(const RobotDescription& file, const RobotDescription& robot,
                             const Data& data, const NuisanceOptions& options,
                             const Relinearised& found, const std::string& source);

inline constexpr double kWorthWriting = 0.005;  // share of a link's mass

}  // namespace offnominal::tools::discovery
