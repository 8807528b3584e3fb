#pragma once

#include <vector>

#include "explain/explain.hpp"
#include "explain/found_model.hpp"
#include "explain/search_setting.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk {

// Takes the name from a transmission that gives way (elasticity, backlash) which is not needed
// beside links of unknown numbers, or where those of the file are off by more than CAD is, takes
// less than a twentieth of its joint's torque. To the joint it is an inertia that grows with
// frequency: where the links of the file are off by more than they were let, it takes their place.
// `robot`: that the setting was made with.
void leave_out_links_in_disguise(const SearchSetting& setting, const RobotDescription& robot,
                                 int threads, FoundModel& found);

// Whether links that are off further than they were let are asked for at all: those of an arm of
// three joints or more, in motion.
bool tells_links_apart(const SearchSetting& setting, const RobotDescription& robot);

// Of what was found, what could as well be the links of the file: constant torques, springs, torque
// constants, payloads and masses of links of an arm of three joints or more that take half as much
// beside links whose masses, centres of mass and inertias are off further, each by itself; and
// where the links of the file had to be off by more than CAD is, a mass of no more than twice what
// its link and the one before it may be off. `robot`: that the setting was made with.
std::vector<EffectAt> could_be_links(const SearchSetting& setting, const RobotDescription& robot,
                                     const FoundModel& found);

}  // namespace offnominal::desk
