#include "identify/relinearise.hpp"

namespace offnominal::desk {

RobotDescription with_link_factors(RobotDescription robot, const std::vector<double>& factors) {
  for (std::size_t link = 0; link < factors.size(); ++link) {
    Joint<double>& joint = robot.joints[link].joint;
    joint.mass_kg *= factors[link];
    for (double& inertia : joint.inertia_kg_m2) inertia *= factors[link];
  }
  return robot;
}

namespace {

std::vector<double> fitted_link_factors(const Data& data, const ModelFit& fit,
                                        std::vector<double> factors) {
  for (std::size_t i = 0; i < data.nuisance.terms.size(); ++i) {
    const NuisanceTerm& term = data.nuisance.terms[i];
    if (term.kind != NuisanceTerm::Kind::kLink) continue;
    factors[static_cast<std::size_t>(term.joint)] *= 1 + fit.nuisance[static_cast<Eigen::Index>(i)];
  }
  return factors;
}

}  // namespace

Relinearised relinearise(const RobotDescription& robot, const Data& data,
                         const NuisanceOptions& options, const std::vector<Term>& terms,
                         const ModelFit& fit) {
  Relinearised anew;
  anew.link_factors = fitted_link_factors(data, fit, std::vector<double>(robot.joints.size(), 1.0));
  const RobotDescription closer = with_link_factors(robot, anew.link_factors);
  std::vector<Workspace> recordings = data.recordings;
  for (Workspace& at : recordings) at.set_model(closer);
  anew.nuisance = options;
  anew.nuisance.link_factors = anew.link_factors;
  anew.data = std::make_unique<Data>(std::move(recordings), closer, anew.nuisance);
  const Regression regression(*anew.data);
  anew.terms = terms;
  for (std::size_t i = 0; i < terms.size(); ++i) regression.refine(anew.terms, i);
  anew.fit = regression.fit(anew.terms);
  anew.link_factors = fitted_link_factors(*anew.data, anew.fit, anew.link_factors);
  return anew;
}

}  // namespace offnominal::desk
