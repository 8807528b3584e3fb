#pragma once

#include <offnominal/model/quantity.hpp>
#include <vector>

// Where numbers inside an effect's formula are searched.

namespace offnominal::desk {

// Both ends and even steps of the logarithm between them; empty unless 0 < from < to.
std::vector<double> logarithmic_grid(double from, double to, double per_decade = 5);

// Position in which a torque of order 1 repeats: a turn, 2 pi rad, or a metre.
double first_order_period(JointType type);

}  // namespace offnominal::desk
