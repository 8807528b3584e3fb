#include "discovery/torque_scale.hpp"

#include <string_view>

#include "robot/robot.hpp"

namespace offnominal::tools::discovery {
namespace {

bool is(EffectKind kind, const Term& term) {
  return std::string_view(info_of(kind)->name) == term.effect->name();
}

}  // namespace

double factor_beside_torque_scale(const std::vector<Term>& terms, const ModelFit& fit,
                                  Eigen::Index joint) {
  for (std::size_t i = 0; i < terms.size(); ++i) {
    if (terms[i].joint != joint || !is(EffectKind::kTorqueScale, terms[i])) continue;
    return 1 / (1 + fit.coefficients[i][0]);
  }
  return 1;
}

double factor_beside_torque_scale(const std::vector<Term>& terms, const ModelFit& fit,
                                  const Term& term) {
  if (is(EffectKind::kTorqueScale, term) || is(EffectKind::kTimeDelay, term)) return 1;
  return factor_beside_torque_scale(terms, fit, term.joint);
}

}  // namespace offnominal::tools::discovery
