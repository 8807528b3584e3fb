#include "discovery/torque_scale.hpp"

#include "robot/robot.hpp"

namespace offnominal::tools::discovery {

double factor_beside_torque_scale(const std::vector<Term>& terms, const ModelFit& fit,
                                  Eigen::Index joint, std::string_view effect) {
  const std::string_view scale = info_of(EffectKind::kTorqueScale)->name;
  if (effect == scale || effect == info_of(EffectKind::kTimeDelay)->name) return 1;
  for (std::size_t i = 0; i < terms.size(); ++i) {
    if (terms[i].joint != joint || scale != terms[i].effect->name()) continue;
    return 1 / (1 + fit.coefficients[i][0]);
  }
  return 1;
}

}  // namespace offnominal::tools::discovery
