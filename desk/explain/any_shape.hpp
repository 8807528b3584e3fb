#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "explain/found_model.hpp"
#include "explain/search.hpp"

namespace offnominal::desk {

// An effect that is a curve of any shape over one variable of its joint (EffectTraits), which can
// stand for every other effect of that variable.
struct AnyShape {
  // The curve in the place of what it replaces, or a ripple of one or two periods over the range
  // that says the same with fewer numbers.
  Proposal proposal;
  ModelFit without;                   // the same without the curve
  std::vector<std::size_t> replaced;  // of what was found, ascending
  std::string words;  // "joint_stiffness is 60 % of it"; empty where it replaces nothing
};

// What such a curve may be on a joint where all other effects have been tried. It takes the place
// of the effects that were found of its variable, or that it can be, as a constant torque: of all
// where it takes more than they do, otherwise of those that it holds as they are. Empty unless what
// is left follows the variable, none of the replaced alone takes nine tenths of what the curve
// takes (or leaves ten times what it leaves), the curve takes nine tenths of what a free function
// takes, it makes the recordings more likely than the best other candidate beside all that was
// found, and no end stop takes as much and leaves as little. What is significant, relevant and
// holds on other data is for find_model() to say.
std::optional<AnyShape> any_shape_on(Eigen::Index joint, const Search& search,
                                     const Regression& regression, const FoundModel& found);

// The effect that is a curve of any shape over this variable; null where there is none.
const EffectInfo* any_shape_over(std::string_view variable);

}  // namespace offnominal::desk
