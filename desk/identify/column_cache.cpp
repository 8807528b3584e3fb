#include "identify/column_cache.hpp"

#include <utility>

namespace offnominal::desk {

using Eigen::Index;
using Eigen::MatrixXd;

std::optional<MatrixXd> ColumnCache::known(const Key& key) {
  const std::lock_guard lock(mutex_);
  const auto at = known_.find(key);
  if (at == known_.end()) return std::nullopt;
  return at->second;
}

MatrixXd ColumnCache::columns(const RowLayout& layout, const std::vector<Workspace>& recordings,
                              const EffectCandidate& effect, Index joint, const ShapePoint& shape) {
  // 64 MB; beyond that all is forgotten, which changes no result.
  constexpr std::size_t kMostNumbers = std::size_t{8} << 20U;
  Key key{effect.kind(), joint, shape};
  if (auto columns = known(key)) return *std::move(columns);
  MatrixXd columns = stacked_columns(layout, recordings, effect, joint, shape);
  const auto count = static_cast<std::size_t>(columns.size());
  const std::lock_guard lock(mutex_);
  if (numbers_ + count > kMostNumbers) {
    known_.clear();
    numbers_ = 0;
  }
  if (count <= kMostNumbers && known_.emplace(std::move(key), columns).second) numbers_ += count;
  return columns;
}

}  // namespace offnominal::desk
