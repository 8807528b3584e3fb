#pragma once

#include "outcome.hpp"

namespace offnominal::bench {

// The loop from a recording that cannot tell to one that can: a first motion is recorded on which
// explain() says `ambiguous` (the hidden effect in the class) or `not_excited`; the motion that its
// advice asks for is designed from the nominal robot alone; the same hidden robot is recorded on
// it; explain() judges that recording by itself. Score and verdict are those of the second
// recording, Outcome::before is the first verdict. Rich excitation of the request asks for
// `ambiguous`, where such a motion is found; poor for `not_excited`.
Outcome run_motion_case(const sim::hidden::Request& request);

}  // namespace offnominal::bench
