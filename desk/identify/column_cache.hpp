#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "identify/effect_candidate.hpp"
#include "identify/inertial_columns.hpp"
#include "identify/rows.hpp"

namespace offnominal::desk {

// Stacked columns of candidates at shapes that were asked for before, of one set of recordings:
// those of an effect that needs the dynamics of the whole arm cost as much as everything else. What
// comes back is what would be computed anew. Any number of threads may ask at once.
class ColumnCache {
 public:
  // `inertial`: of the same recordings.
  explicit ColumnCache(std::shared_ptr<InertialColumns> inertial)
      : inertial_(std::move(inertial)) {}

  // Columns of `effect` on a joint: one of all_candidates(), or a payload with values of its own.
  [[nodiscard]] Eigen::MatrixXd columns(const RowLayout& layout,
                                        const std::vector<Workspace>& recordings,
                                        const EffectCandidate& effect, Eigen::Index joint,
                                        const ShapePoint& shape);

 private:
  struct Key {
    EffectKind kind = EffectKind::kViscousFriction;
    Eigen::Index joint = 0;
    ShapePoint shape;
    friend auto operator<=>(const Key&, const Key&) = default;
  };
  [[nodiscard]] std::optional<Eigen::MatrixXd> known(const Key& key);

  std::shared_ptr<InertialColumns> inertial_;
  std::mutex mutex_;
  std::map<Key, Eigen::MatrixXd> known_;
  std::size_t numbers_ = 0;  // in known_
};

}  // namespace offnominal::desk
