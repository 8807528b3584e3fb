#include "identify/relinearise.hpp"

namespace offnominal::desk {

RobotDescription with_link_changes(RobotDescription robot, const std::vector<LinkChange>& links) {
  for (std::size_t link = 0; link < links.size(); ++link) {
    const LinkChange& by = links[link];
    Joint<double>& joint = robot.joints[link].joint;
    joint.mass_kg *= by.factor;
    for (double& inertia : joint.inertia_kg_m2) inertia *= by.factor * by.inertia_factor;
    for (std::size_t axis = 0; axis < by.centre_m.size(); ++axis) {
      joint.centre_of_mass_m[axis] += by.centre_m[axis];
    }
  }
  return robot;
}

namespace {

std::vector<LinkChange> fitted_changes(const Data& data, const ModelFit& fit,
                                       std::vector<LinkChange> links) {
  for (std::size_t i = 0; i < data.nuisance.terms.size(); ++i) {
    const NuisanceTerm& term = data.nuisance.terms[i];
    const double by = fit.nuisance[static_cast<Eigen::Index>(i)];
    if (term.kind == NuisanceTerm::Kind::kLink) {
      links[static_cast<std::size_t>(term.joint)].factor *= 1 + by;
    } else if (term.kind == NuisanceTerm::Kind::kLinkInertia) {
      links[static_cast<std::size_t>(term.joint)].inertia_factor *= 1 + by;
    } else if (term.kind == NuisanceTerm::Kind::kLinkCentre) {
      links[static_cast<std::size_t>(term.joint)].centre_m[term.parameter] += by;
    }
  }
  return links;
}

}  // namespace

Relinearised relinearise(const RobotDescription& robot, const Data& data,
                         const NuisanceOptions& options, const std::vector<Term>& terms,
                         const ModelFit& fit) {
  Relinearised anew;
  anew.links = fitted_changes(data, fit, std::vector<LinkChange>(robot.joints.size()));
  const RobotDescription closer = with_link_changes(robot, anew.links);
  std::vector<Workspace> recordings = data.recordings;
  for (Workspace& at : recordings) at.set_model(closer);
  anew.nuisance = options;
  anew.nuisance.links = anew.links;
  anew.data = std::make_unique<Data>(std::move(recordings), closer, anew.nuisance);
  const Regression regression(*anew.data);
  anew.terms = terms;
  for (std::size_t i = 0; i < terms.size(); ++i) regression.refine(anew.terms, i);
  anew.fit = regression.fit(anew.terms);
  anew.links = fitted_changes(*anew.data, anew.fit, anew.links);
  return anew;
}

}  // namespace offnominal::desk
