#include "command/doctor.hpp"

#include <iostream>
#include <utility>

#include "common/error.hpp"
#include "common/nearest.hpp"
#include "explain/doctor.hpp"
#include "explain/explain.hpp"

namespace offnominal::desk {
namespace {

void say(const std::vector<DataFault>& faults) {
  for (const DataFault& fault : faults) {
    if (fault.left_out_of.empty()) {
      const char* kept = fault.overruled ? "kept: " : "hint: ";
      std::cerr << kept << on_one_line(line_of(fault)) << '\n';
    } else {
      std::cerr << "left out: " << on_one_line(left_out_line(fault)) << '\n';
    }
  }
}

}  // namespace

void add_keep_option(CLI::App& verb, std::vector<KeepFault>& keep) {
  verb.add_option_function<std::vector<std::string>>(
          "--keep",
          [&keep](const std::vector<std::string>& texts) {
            keep.clear();
            for (const std::string& text : texts) keep.push_back(keep_fault_of(text));
          },
          "2:saturation, all:gaps and the like: what the doctor finds there is no fault, and "
          "nothing is left out or refused for it. Once for each. Reasons: " +
              list_of(keep_reasons()))
      ->type_name("JOINT:REASON")
      ->expected(1)
      ->take_all()
      ->allow_extra_args(false);
}

std::vector<DataFault> treated(const std::vector<std::span<Log>>& groups,
                               const RobotDescription& robot, const std::vector<KeepFault>& keep,
                               Progress& progress, std::optional<RestsOn> what) {
  progress.begin("examining the recordings");
  std::vector<DataFault> all = treat_all(groups, robot, keep);
  progress.end();
  for (const DataFault& fault : all) {
    if (!what || !spoils(fault, *what)) continue;
    throw InputError({fault.file, "", fault.words, "", fault.mend});
  }
  say(all);
  return all;
}

std::vector<DataFault> examined(const std::vector<std::span<const Log>>& groups,
                                const RobotDescription& robot, Progress& progress) {
  progress.begin("examining the recordings");
  std::vector<DataFault> all;
  for (const std::span<const Log> group : groups) {
    for (const Log& log : group) {
      if (log.at_rest) continue;
      for (DataFault& fault : examine(log, robot)) all.push_back(std::move(fault));
    }
  }
  progress.end();
  say(all);
  return all;
}

}  // namespace offnominal::desk
