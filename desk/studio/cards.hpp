#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <optional>

#include "explain/explain.hpp"
#include "studio/job.hpp"

namespace offnominal::desk::studio {

/// What `explain` says, joint by joint, the one that matters most first: {verdict, words, joints:
/// [{joint, verdict, words, cards: [{effect, joint, title, words, formula, parameters: [{name,
/// value, unit, ci95, why_no_ci95}], p_value, unit, held_out_before, held_out_after, alternatives:
/// [{effect, joint, words, motion}], finding}], classes: [{effects: [the same],
/// or_own_numbers}]}], advice}. Joints count from
/// 1; `finding` is null where its picture cannot be drawn.
nlohmann::ordered_json cards_of(const Explanation& explanation);

/// The place of a finding among the effects of the improved robot; none: it is not in it.
std::optional<std::size_t> improved_effect(const Explanation& explanation, std::size_t finding);

/// Of an answer as below: its pictures need the search that it came from.
void without_pictures(nlohmann::ordered_json& answer);

/// {state: none|running|done|stopped|failed, doing, seconds, error, revision, answer: cards or
/// null}
nlohmann::ordered_json to_json(const Job::Report& report);

}  // namespace offnominal::desk::studio
