#pragma once

#include <nlohmann/json_fwd.hpp>

#include "explain/explain.hpp"
#include "studio/job.hpp"

namespace offnominal::desk::studio {

/// What `explain` says, joint by joint, the one that matters most first: {verdict, words, joints:
/// [{joint, verdict, words, cards: [{effect, joint, title, words, formula, parameters: [{name,
/// value, unit, ci95, why_no_ci95}], p_value, unit, held_out_before, held_out_after, alternatives:
/// [{effect, joint}]}], classes: [[{effect, joint, words}]]}], advice}. Joints count from 1.
nlohmann::ordered_json cards_of(const Explanation& explanation);

/// {state: none|running|done|stopped|failed, doing, seconds, error, revision, answer: cards or
/// null}
nlohmann::ordered_json to_json(const Job::Report& report);

}  // namespace offnominal::desk::studio
