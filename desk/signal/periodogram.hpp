#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace offnominal::desk {

// Power |sum of values exp(i k phase)|^2 at every k of an evenly stepped grid.
std::vector<double> periodogram(const Eigen::Ref<const Eigen::VectorXd>& phase,
                                const Eigen::Ref<const Eigen::VectorXd>& values,
                                const std::vector<double>& grid);

// The grid's values at the `most` highest local maxima of `power`, in ascending order. A grid of
// fewer than three values as a whole.
std::vector<double> highest_peaks(const std::vector<double>& grid, const std::vector<double>& power,
                                  std::size_t most);

}  // namespace offnominal::desk
