// What a robot file has to say before its controller arms.
#pragma once

#include <offnominal/controller/fault.hpp>
#include <string>

#include "robot/robot.hpp"

namespace offnominal::desk {

/// How to mend it that arming was refused: which joints miss what, where the file says so.
[[nodiscard]] std::string mend_of(controller::Fault refusal, const RobotDescription& robot);

}  // namespace offnominal::desk
