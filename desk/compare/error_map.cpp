#include "compare/error_map.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace offnominal::desk {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

// Even cells over all that a variable reaches.
class Cells {
 public:
  explicit Cells(const VectorXd& values) {
    constexpr int kCells = 20;
    constexpr double kNarrowest = 1e-9;
    const double low = values.minCoeff();
    const double width = std::max(values.maxCoeff() - low, kNarrowest);
    for (int i = 0; i <= kCells; ++i) edges_.push_back(low + width * i / kCells);
  }
  [[nodiscard]] const std::vector<double>& edges() const { return edges_; }
  [[nodiscard]] std::size_t count() const { return edges_.size() - 1; }
  [[nodiscard]] std::size_t at(double value) const {
    const double part = (value - edges_.front()) / (edges_.back() - edges_.front());
    const auto last = static_cast<double>(count()) - 1;
    return static_cast<std::size_t>(std::clamp(part * static_cast<double>(count()), 0.0, last));
  }

 private:
  std::vector<double> edges_;
};

}  // namespace

report::Heatmap mean_map(const std::string& title, const MapSide& x, const MapSide& y,
                         const MapSide& mean_of) {
  report::Heatmap map;
  map.title = title;
  map.x = x.axis;
  map.y = y.axis;
  map.value_axis = mean_of.axis;
  map.diverging = true;
  std::vector<Index> samples;
  for (Index i = 0; i < mean_of.values.size(); ++i) {
    const double all = x.values[i] + y.values[i] + mean_of.values[i];
    if (!std::isnan(all)) samples.push_back(i);
  }
  if (samples.empty()) {
    map.x_edges = {0, 1};
    map.y_edges = {0, 1};
    map.value = {std::numeric_limits<double>::quiet_NaN()};
    return map;
  }
  const Cells columns(x.values(samples));
  const Cells rows(y.values(samples));
  map.x_edges = columns.edges();
  map.y_edges = rows.edges();
  std::vector<double> sum(rows.count() * columns.count(), 0.0);
  std::vector<double> count(sum.size(), 0.0);
  for (const Index i : samples) {
    const std::size_t cell = rows.at(y.values[i]) * columns.count() + columns.at(x.values[i]);
    sum[cell] += mean_of.values[i];
    count[cell] += 1;
  }
  for (std::size_t i = 0; i < sum.size(); ++i) {
    map.value.push_back(count[i] > 0 ? sum[i] / count[i]
                                     : std::numeric_limits<double>::quiet_NaN());
  }
  return map;
}

}  // namespace offnominal::desk
