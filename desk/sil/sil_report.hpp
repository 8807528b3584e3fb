// What a run over the bus shows, as text, JSON and page.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "report/page.hpp"
#include "sil/sil.hpp"

namespace offnominal::desk::sil {

/// init, passive, armed, fault.
[[nodiscard]] std::string name_of(hal::ControllerState state);

/// The keys of `offnominal paper --json` for one run, "fault" naming every fault of the scenario,
/// and in EstimatorSpace::kTorque first_joint and joints: [{name, detection_time_s, ...}], where
/// there are two levels also act_time_s, of the run and of each joint;
/// then judged, at_detection, slowed: {time_s, to, within_s, reached}, bus: {name, frames, lost,
/// rejected, stale, late, load_percent}, time_to_safe_state_s, overruns, controller_state,
/// controller_fault, ended_early_s, isolated (as in replay); of a run in real time also real_time:
/// {ticks, worst_late_us, ...}. Null where there is none.
[[nodiscard]] nlohmann::ordered_json to_json(const SilResult& result);

/// A table, then a sentence.
[[nodiscard]] std::string text_of(const SilResult& result);

/// Needs a recorded run.
[[nodiscard]] report::Page page_of(const SilResult& result, const std::string& command_line);

/// What happened, in words.
[[nodiscard]] std::string sentence_of(const SilResult& result);

}  // namespace offnominal::desk::sil
