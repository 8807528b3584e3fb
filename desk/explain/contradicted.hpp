#pragma once

#include <vector>

#include "explain/explain.hpp"
#include "explain/found_model.hpp"
#include "explain/search_setting.hpp"
#include "identify/improved_robot.hpp"

namespace offnominal::desk {

// Numbers of the file's effects that the recordings contradict: far from what the file says, where
// that matters to the joint's torque, or not so far where it is much of it, and data that no fit
// has seen are predicted better with the number that fits than with the file's: by twice what is
// left beside it, or as much as that where it is friction that is three times off. None of a joint
// whose torque may have another scale, as one of `classes` has it: its numbers hang on that.
// `robot`: what the setting's data were made with.
std::vector<Shift> contradicted_numbers(const SearchSetting& setting, const RobotDescription& robot,
                                        const FoundModel& found,
                                        const std::vector<Excitation>& excitation,
                                        const std::vector<std::vector<EffectAt>>& classes);

// Leaves out those of joints one of whose numbers was held at the end of what is possible against
// the recordings: what they ask for there is no number of the file but something that it lacks.
// Whether there were any: the rest is then to be fitted again.
bool leave_out_impossible(const std::vector<HeldNumber>& held, std::vector<Shift>& shifts);

// Leaves out those that are not there once all that is written has been fitted together: less than
// half as far from the file as they were. Whether there were any: the rest is then to be fitted
// again, beside the file's numbers.
bool leave_out_undone(const RobotDescription& fitted, std::vector<Shift>& shifts);

// Effects of the file that get new numbers, as indices: those marked fitted, and of those numbers.
std::vector<std::size_t> refitted_effects(const RobotDescription& file,
                                          const std::vector<Shift>& shifts);

}  // namespace offnominal::desk
