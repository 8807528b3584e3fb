#pragma once

#include <span>
#include <vector>

#include "discovery/data_fault.hpp"
#include "log/log.hpp"
#include "robot/robot.hpp"

namespace offnominal::tools {

// What is wrong with recordings in time, as the doctor sees it (discovery/doctor.hpp).
std::vector<discovery::DataFault> examine_all(const std::vector<std::span<const Log>>& groups,
                                              const RobotDescription& robot);

// Says it on stderr, a line each, beside an answer that is given all the same.
void print_hints(const std::vector<discovery::DataFault>& faults);

// Throws InputError at the first fault with which every answer of that kind would be wrong.
void refuse_spoilt(const std::vector<discovery::DataFault>& faults, discovery::RestsOn what);

}  // namespace offnominal::tools
