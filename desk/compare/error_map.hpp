#pragma once

#include <Eigen/Core>
#include <string>

#include "report/page.hpp"

namespace offnominal::desk {

// One side of a map: what it is, and its value at every sample.
struct MapSide {
  report::Axis axis;
  Eigen::VectorXd values;
};

// The mean of a signed quantity over two variables, on a grid of 20 x 20 cells over what both
// reach; cells without a sample are empty. Samples of which a value is NaN are none. All three have
// one length; where no sample has all three the map is one empty cell.
report::Heatmap mean_map(const std::string& title, const MapSide& x, const MapSide& y,
                         const MapSide& mean_of);

}  // namespace offnominal::desk
