#pragma once

#include "look/look.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk {

// Gives the proposed channels the units that the data show: a velocity against the derivative of
// its position, a position against the limits of its joint. Each is a note, and so is what could
// not be judged. Of columns of one family, those that show none take the unit of the others. Units
// that a name or the file says stay. Returns how many velocities go with their positions then.
int take_units_from_data(Look& look, const RobotDescription* robot);

}  // namespace offnominal::desk
