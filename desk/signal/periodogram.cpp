#include "signal/periodogram.hpp"

#include <algorithm>
#include <complex>

namespace offnominal::desk {

using Eigen::Index;
using Eigen::VectorXd;

std::vector<double> periodogram(const Eigen::Ref<const VectorXd>& phase,
                                const Eigen::Ref<const VectorXd>& values,
                                const std::vector<double>& grid) {
  std::vector<double> power;
  if (grid.empty()) return power;
  const double step = grid.size() > 1 ? grid[1] - grid[0] : 0;
  Eigen::ArrayXcd turn(phase.size());
  Eigen::ArrayXcd wave(phase.size());
  for (Index i = 0; i < phase.size(); ++i) {
    turn[i] = std::polar(1.0, step * phase[i]);
    wave[i] = values[i] * std::polar(1.0, grid[0] * phase[i]);
  }
  for (std::size_t k = 0; k < grid.size(); ++k) {
    power.push_back(std::norm(wave.sum()));
    wave *= turn;
  }
  return power;
}

std::vector<double> highest_peaks(const std::vector<double>& grid, const std::vector<double>& power,
                                  std::size_t most) {
  if (grid.size() < 3) return grid;
  std::vector<std::size_t> peaks;
  for (std::size_t k = 0; k < power.size(); ++k) {
    const bool rises = k == 0 || power[k] > power[k - 1];
    const bool falls = k + 1 == power.size() || power[k] >= power[k + 1];
    if (rises && falls) peaks.push_back(k);
  }
  std::stable_sort(peaks.begin(), peaks.end(),
                   [&](std::size_t a, std::size_t b) { return power[a] > power[b]; });
  if (peaks.size() > most) peaks.resize(most);
  std::sort(peaks.begin(), peaks.end());
  std::vector<double> result;
  for (const std::size_t k : peaks) result.push_back(grid[k]);
  return result;
}

}  // namespace offnominal::desk
