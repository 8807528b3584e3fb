#pragma once

#include "identify/effect_candidate.hpp"

// Effects whose mathematics in a search is not what their struct evaluates, one file per family.
// Every class is local to its file. Null: none of the family.

namespace offnominal::desk {

Candidate drive_candidate(EffectKind kind);         // torque constant, delay, springs
Candidate payload_candidate(EffectKind kind);       // what is carried
Candidate ripple_candidate(EffectKind kind);        // what repeats with position or time
Candidate transmission_candidate(EffectKind kind);  // between motor and link

}  // namespace offnominal::desk
