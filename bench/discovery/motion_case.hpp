#pragma once

#include "outcome.hpp"

namespace offnominal::bench {

// The loop from a recording that cannot tell to one that can: a first motion is recorded on which
// explain() says `ambiguous` (the hidden effect in the class) or `not_excited`; the motion that its
// advice asks for is designed from the nominal robot alone; the same hidden robot is recorded on
// it; explain() judges that recording by itself. Score and verdict are those of the second
// recording, Outcome::before is the first verdict: `ambiguous` where one of several draws gives it.
// Rich excitation of the request draws short motions first, then poor ones; poor, these alone.
Outcome run_motion_case(const sim::hidden::Request& request);

}  // namespace offnominal::bench
