#include "discovery/effect_candidate.hpp"

#include "discovery/effects/effects.hpp"

namespace offnominal::tools::discovery {

std::vector<ShapePoint> product_grid(const std::vector<ShapeRange>& ranges) {
  std::vector<ShapePoint> points{{}};
  for (const ShapeRange& range : ranges) {
    std::vector<ShapePoint> longer;
    for (const ShapePoint& point : points) {
      for (const double value : range.grid) {
        longer.push_back(point);
        longer.back().push_back(value);
      }
    }
    points = std::move(longer);
  }
  return points;
}

std::vector<ShapeRange> EffectCandidate::shapes(const std::vector<Workspace>& /*at*/,
                                                Eigen::Index /*joint*/) const {
  return {};
}

std::vector<NamedValue> EffectCandidate::parameters(JointType type,
                                                    const Eigen::VectorXd& coefficients,
                                                    const ShapePoint& shape,
                                                    const std::vector<ShapeRange>& ranges) const {
  std::vector<NamedValue> values;
  const std::vector<LinearParameter> linear = linear_parameters(type);
  for (std::size_t i = 0; i < linear.size(); ++i) {
    values.push_back({linear[i].name, coefficients[static_cast<Eigen::Index>(i)], linear[i].unit});
  }
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    values.push_back({ranges[i].name, shape[i], ranges[i].unit});
  }
  return values;
}

bool EffectCandidate::is_physical(const Eigen::VectorXd& /*coefficients*/) const { return true; }

bool EffectCandidate::applies(const Workspace& at, Eigen::Index joint) const {
  return at.top_speed[joint] > 0;
}

bool EffectCandidate::acts_at_rest(const Workspace& /*at*/, Eigen::Index /*joint*/) const {
  return false;
}

const std::vector<std::unique_ptr<const EffectCandidate>>& all_candidates() {
  static const auto candidates = [] {
    std::vector<std::unique_ptr<const EffectCandidate>> all;
    add_friction_effects(all);
    add_drive_effects(all);
    add_inertia_effects(all);
    add_transmission_effects(all);
    return all;
  }();
  return candidates;
}

}  // namespace offnominal::tools::discovery
