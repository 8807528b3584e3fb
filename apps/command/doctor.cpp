#include "command/doctor.hpp"

#include <iostream>
#include <utility>

#include "common/error.hpp"
#include "explain/doctor.hpp"

namespace offnominal::desk {

std::vector<DataFault> examined(const std::vector<std::span<const Log>>& groups,
                                const RobotDescription& robot, Progress& progress,
                                std::optional<RestsOn> what) {
  progress.begin("examining the recordings");
  std::vector<DataFault> all;
  for (const std::span<const Log> group : groups) {
    for (const Log& log : group) {
      if (log.at_rest) continue;
      for (DataFault& fault : examine(log, robot)) all.push_back(std::move(fault));
    }
  }
  progress.end();
  for (const DataFault& fault : all) {
    if (!what || !spoils(fault, *what)) continue;
    throw InputError({fault.file, "", fault.words, "", fault.mend});
  }
  for (const DataFault& fault : all) {
    std::cerr << "hint: " << on_one_line(line_of(fault)) << '\n';
  }
  return all;
}

}  // namespace offnominal::desk
