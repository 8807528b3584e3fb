#include "identify/column_cache.hpp"

#include <offnominal/model/effects/inertia.hpp>
#include <utility>

#include "identify/inertial_regressor.hpp"

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
  // A mass at a place that is looked for: each costs ten products, not the dynamics of the arm.
  if (effect.kind() == EffectKind::kTipPayload) {
    const Effect<double> mass =
        effect.effect(joint, Eigen::VectorXd::Ones(1), shape, recordings[0].sign_width);
    const auto point = effects::TipPayload::point_mass(mass.parameters, {});
    Joint<double> body;
    body.mass_kg = point.mass_kg;
    body.centre_of_mass_m = point.position_m;
    return *inertial_->of_link(layout, recordings, joint) * inertial_numbers_of(body);
  }
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
