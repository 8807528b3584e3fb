#pragma once

#include "inertial/identify.hpp"
#include "inertial/inertial_fit.hpp"

namespace offnominal::desk {

// Fills in what a fit says of links, drives, base parameters and payload, with intervals, and how
// well the motion determines them. `result.robot` is the identified one.
void put_numbers(const InertialFit& fit, const IdentifyRequest& request, Identification& result);

}  // namespace offnominal::desk
