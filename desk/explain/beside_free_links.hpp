#pragma once

#include "explain/find_model.hpp"
#include "explain/search_setting.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk {

// Takes the name from a transmission that gives way (elasticity, backlash) which is not needed
// beside links of unknown numbers, or where those of the file are off by more than CAD is, takes
// less than a fiftieth of its joint's torque. To the joint it is an inertia that grows with
// frequency: where the links of the file are off by more than they were let, it takes their place.
// `robot`: that the setting was made with.
void leave_out_links_in_disguise(const SearchSetting& setting, const RobotDescription& robot,
                                 int threads, FoundModel& found);

}  // namespace offnominal::desk
