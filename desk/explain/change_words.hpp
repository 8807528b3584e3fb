#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "explain/explain.hpp"

// What is said of changes.

namespace offnominal::desk {

std::vector<Change> changes_on(const Explanation& e, Eigen::Index joint);

// One after the other, without a full stop.
std::string words_of(const std::vector<Change>& changes);

// The same as a sentence of the whole robot. Where nothing changes: that nothing does, if that was
// asked, otherwise empty.
std::string sentence_on_changes(const Explanation& e);

// Where to cut what is not of one robot.
void advise_on_changes(Explanation& e);

}  // namespace offnominal::desk
