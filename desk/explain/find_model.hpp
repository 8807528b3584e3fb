#pragma once

#include <limits>
#include <vector>

#include "explain/excitation.hpp"
#include "explain/found_model.hpp"
#include "explain/search.hpp"
#include "identify/holdout.hpp"
#include "identify/on_progress.hpp"
#include "identify/regression.hpp"

namespace offnominal::desk {

struct FindOptions {
  int most_effects = 6;                        // of one joint
  int room = std::numeric_limits<int>::max();  // for effects of all joints together
  int replays = 19;                            // 0: none
};

// Adds effects in rounds, in each the best one of every joint that passes significance over the
// whole search, relevance, hold-out, replay and, where it remembers, simulation. What fails is set
// aside and the joint's next one is tried; no joint waits for another. Then each effect has to be
// needed beside all others (shared method: S4 to S8). `excitation`: per joint.
FoundModel find_model(const Search& search, const Regression& regression, const HoldOut& hold_out,
                      const std::vector<Excitation>& excitation, const FindOptions& options,
                      const OnProgress& on_progress);

}  // namespace offnominal::desk
