#include "identify/torque_scale.hpp"

namespace offnominal::desk {

namespace {

using Eigen::Index;

bool is_scale(EffectKind kind) { return info_of(kind)->action == EffectAction::kToldPerGiven; }

// 1 + the error of a joint's torque constant: as the data's model has it, and as it was fitted.
struct Scale {
  double made_with = 1;
  double fitted = 1;
};

Scale scale_of(const Data& data, const std::vector<Term>& terms, const ModelFit& fit, Index joint) {
  Scale scale;
  const auto& known = data.recordings[0].known_effects;
  scale.made_with = scale_known(data.recordings[0], joint);
  scale.fitted = scale.made_with;
  for (std::size_t i = 0; i < data.nuisance.terms.size(); ++i) {
    const NuisanceTerm& term = data.nuisance.terms[i];
    if (term.joint != joint) continue;
    const double by = fit.nuisance[static_cast<Index>(i)];
    if (term.kind == NuisanceTerm::Kind::kKnownEffect && is_scale(known[term.effect].kind)) {
      scale.fitted += by;
    } else if (term.kind == NuisanceTerm::Kind::kConstant) {
      scale.fitted *= 1 + by;
    }
  }
  for (std::size_t i = 0; i < terms.size(); ++i) {
    if (terms[i].joint == joint && terms[i].effect->is_torque_constant()) {
      scale.fitted *= 1 + fit.coefficients[i][0];
    }
  }
  return scale;
}

// The joint whose torque says most of a term: of a mass not its own, which may hardly feel it.
Index joint_of(const Data& data, const Term& term, const ModelFit& fit) {
  if (!term.effect->is_mass()) return term.joint;
  Index joint = term.joint;
  data.layout.energy(data.layout.weighted(columns_of(data, term).col(0), fit.joint_weights))
      .maxCoeff(&joint);
  return joint;
}

}  // namespace

double scale_known(const Workspace& at, Index joint) {
  double scale = 1;
  for (const RobotEffect& effect : at.known_effects) {
    if (effect.joint == joint && is_scale(effect.kind)) scale *= 1 + effect.parameters[0];
  }
  return scale;
}

double factor_of_term(const Data& data, const std::vector<Term>& terms, const ModelFit& fit,
                      std::size_t i) {
  const Term& term = terms[i];
  if (term.effect->info().acts_on_whole_drive()) return 1;
  const Scale scale = scale_of(data, terms, fit, joint_of(data, term, fit));
  // What is carried is scaled already by what the model knows (columns_of()).
  return (term.effect->is_mass() ? scale.made_with : 1) / scale.fitted;
}

double factor_of_known(const Data& data, const std::vector<Term>& terms, const ModelFit& fit,
                       std::size_t i) {
  const NuisanceTerm& term = data.nuisance.terms[i];
  if (info_of(data.recordings[0].known_effects[term.effect].kind)->acts_on_whole_drive()) return 1;
  const Scale scale = scale_of(data, terms, fit, term.joint);
  return scale.made_with / scale.fitted;
}

}  // namespace offnominal::desk
