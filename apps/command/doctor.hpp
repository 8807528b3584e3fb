#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <vector>

#include "command/progress.hpp"
#include "explain/data_fault.hpp"
#include "explain/data_fault_report.hpp"
#include "log/log.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk {

// What is wrong with recordings in time, as the doctor sees it (discovery/doctor.hpp); says it on
// stderr too, a line each, beside an answer that is given all the same. Throws InputError at the
// first fault with which every answer that rests on `what` would be wrong.
std::vector<DataFault> examined(const std::vector<std::span<const Log>>& groups,
                                const RobotDescription& robot, Progress& progress,
                                std::optional<RestsOn> what = std::nullopt);

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
