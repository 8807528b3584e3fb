#pragma once

#include <vector>

#include "explain/explain.hpp"
#include "explain/found_model.hpp"

namespace offnominal::desk {

// Takes names back that stand for something else. Effects of a joint that are functions of one
// variable have to take nine tenths of what a free function of that variable takes (of velocity,
// Coulomb and viscous friction eight); and all effects of a joint together nine tenths of what a
// free function of one variable takes in their place. Where they do not, the joint's error has a
// torque over that variable of a shape that no effect has: it is returned, and those effects leave
// the model that take next to nothing beside it. So do effects that leave more than half of an
// error that comes in a few stretches of time. Where what is left is noise, or follows nothing,
// every name stays.
std::vector<OverVariable> leave_out_stand_ins(const Regression& regression, const HoldOut& hold_out,
                                              int threads, FoundModel& found);

}  // namespace offnominal::desk
