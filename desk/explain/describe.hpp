#pragma once

#include "explain/change.hpp"
#include "explain/explain.hpp"
#include "explain/found_model.hpp"
#include "explain/sizes.hpp"
#include "identify/improved_robot.hpp"

namespace offnominal::desk {

// What a search has come to.
struct SearchResult {
  const RobotDescription& robot;  // of the regression
  const Regression& regression;
  const Search& search;
  const HoldOut& hold_out;
  const FoundModel& found;
  const ImprovedRobot& improved;  // with the found model's final numbers
  const Sizes& sizes;             // of its effects
  const std::vector<FoundChange>& changes;
};

// Fills in all that an explanation says in numbers: errors per joint, findings, rejections, what
// the remaining error follows, shifts of known numbers, series for pictures.
void describe(const SearchResult& result, Explanation& to);

}  // namespace offnominal::desk
