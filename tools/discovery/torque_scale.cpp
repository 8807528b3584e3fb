#include "discovery/torque_scale.hpp"

#include "robot/robot.hpp"

namespace offnominal::tools::discovery {

double factor_beside_torque_scale(const std::vector<Term>& terms, const ModelFit& fit,
                                  Eigen::Index joint, EffectKind effect) {
  if (info_of(effect)->acts_on_whole_drive()) return 1;
  for (std::size_t i = 0; i < terms.size(); ++i) {
    if (terms[i].joint != joint || terms[i].effect->info().action != EffectAction::kToldPerGiven)
      continue;
    return 1 / (1 + fit.coefficients[i][0]);
  }
  return 1;
}

}  // namespace offnominal::tools::discovery
