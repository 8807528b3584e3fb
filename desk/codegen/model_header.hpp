#pragma once

#include <offnominal/status.hpp>
#include <string>

#include "robot/robot.hpp"

// A robot as a C++ header of constants, for a controller that reads no files.

namespace offnominal::desk {

struct ModelHeaderOptions {
  std::string robot_file = {};  // named in the header, without its folder
  std::string name_space = "robot_model";
};

struct ModelHeader {
  std::string text;
  int joints = 0;
  int hidden_units = 0;
  int effects = 0;
  // What the core says of the configuration rounded to float. Where it is not kOk, the header's
  // constants are there for double only.
  Status in_float = Status::kOk;
};

/// The constants are those of chain_of(), monitor_config_of() and gains_of(), to the bit, for both
/// scalars. Throws InputError where the robot has no uncertainty bound, or the name space is none.
[[nodiscard]] ModelHeader model_header(const RobotDescription& robot,
                                       const ModelHeaderOptions& options);

}  // namespace offnominal::desk
