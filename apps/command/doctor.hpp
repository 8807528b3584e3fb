#pragma once

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "command/progress.hpp"
#include "explain/data_fault.hpp"
#include "explain/data_fault_report.hpp"
#include "log/log.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk {

// --keep JOINT:REASON, of every verb that leaves out what the doctor finds.
void add_keep_option(CLI::App& verb, std::vector<KeepFault>& keep);

// What is wrong with recordings in time, as the doctor sees it (explain/treatment.hpp), which are
// left out of them but for `keep`; says it on stderr too, a line each, beside an answer that is
// given all the same. Throws InputError at the first fault with which every answer that rests on
// `what` would be wrong.
std::vector<DataFault> treated(const std::vector<std::span<Log>>& groups,
                               const RobotDescription& robot, const std::vector<KeepFault>& keep,
                               Progress& progress, std::optional<RestsOn> what = std::nullopt);

// The same with nothing left out: what is asked is asked of the recording as it is.
std::vector<DataFault> examined(const std::vector<std::span<const Log>>& groups,
                                const RobotDescription& robot, Progress& progress);

// An answer in JSON, and a page, that say it too.
template <typename Json>
Json with_faults(Json json, const std::vector<DataFault>& faults) {
  json["data_faults"] = to_json(faults);
  return json;
}
inline report::Page with_faults(report::Page page, const std::vector<DataFault>& faults) {
  add_faults(faults, page);
  return page;
}

}  // namespace offnominal::desk
