#include "command/doctor.hpp"

#include <iostream>
#include <utility>

#include "common/error.hpp"
#include "discovery/data_fault_report.hpp"
#include "discovery/doctor.hpp"

namespace offnominal::tools {

using discovery::DataFault;

std::vector<DataFault> examine_all(const std::vector<std::span<const Log>>& groups,
                                   const RobotDescription& robot) {
  std::vector<DataFault> all;
  for (const std::span<const Log> group : groups) {
    for (const Log& log : group) {
      if (log.at_rest) continue;
      for (DataFault& fault : discovery::examine(log, robot)) all.push_back(std::move(fault));
    }
  }
  return all;
}

void print_hints(const std::vector<DataFault>& faults) {
  for (const DataFault& fault : faults) {
    std::cerr << "hint: " << on_one_line(discovery::line_of(fault)) << '\n';
  }
}

void refuse_spoilt(const std::vector<DataFault>& faults, discovery::RestsOn what) {
  for (const DataFault& fault : faults) {
    if (!spoils(fault, what)) continue;
    throw InputError({fault.file, "", fault.words, "", fault.mend});
  }
}

}  // namespace offnominal::tools
