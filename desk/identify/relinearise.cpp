#include "identify/relinearise.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

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

// The model fitted anew about the robot with these links, with these shapes or refined ones.
Relinearised fitted_about(std::vector<LinkChange> links, const RobotDescription& robot,
                          const Data& data, const NuisanceOptions& options,
                          const std::vector<Term>& terms, bool refines) {
  Relinearised anew;
  anew.links = std::move(links);
  const RobotDescription closer = with_link_changes(robot, anew.links);
  anew.nuisance = options;
  anew.nuisance.links = anew.links;
  anew.data = std::make_unique<Data>(Data::of_robot(data, closer, anew.nuisance));
  const Regression regression(*anew.data);
  anew.terms = terms;
  for (std::size_t i = 0; refines && i < terms.size(); ++i) regression.refine(anew.terms, i);
  anew.fit = regression.fit(anew.terms);
  anew.links = fitted_changes(*anew.data, anew.fit, anew.links);
  return anew;
}

// Part of the way from one to the other.
std::vector<LinkChange> on_the_way(const std::vector<LinkChange>& from,
                                   const std::vector<LinkChange>& to, double part) {
  std::vector<LinkChange> links = from;
  for (std::size_t link = 0; link < to.size(); ++link) {
    links[link].factor *= std::pow(to[link].factor / from[link].factor, part);
    links[link].inertia_factor *=
        std::pow(to[link].inertia_factor / from[link].inertia_factor, part);
    for (std::size_t axis = 0; axis < from[link].centre_m.size(); ++axis) {
      links[link].centre_m[axis] += part * (to[link].centre_m[axis] - from[link].centre_m[axis]);
    }
  }
  return links;
}

// The largest change from one to the other, as a share of the link's numbers.
double largest_step(const RobotDescription& robot, const std::vector<LinkChange>& from,
                    const std::vector<LinkChange>& to) {
  double largest = 0;
  for (std::size_t link = 0; link < to.size(); ++link) {
    LinkChange step{to[link].factor / from[link].factor,
                    to[link].inertia_factor / from[link].inertia_factor, to[link].centre_m};
    for (std::size_t axis = 0; axis < step.centre_m.size(); ++axis) {
      step.centre_m[axis] -= from[link].centre_m[axis];
    }
    largest = std::max(largest, step.largest(size_of_link(robot, link)));
  }
  return largest;
}

}  // namespace

Relinearised relinearise(const RobotDescription& robot, const Data& data,
                         const NuisanceOptions& options, const std::vector<Term>& terms,
                         const ModelFit& fit) {
  // A step leaves out the product of a mass and its centre: less than a thousandth of both then.
  constexpr double kSmallStep = 0.03;
  // Where recordings hardly tell the two apart, whole steps go to and fro for ever. One of which
  // only a part is taken cannot shrink by more than that part.
  constexpr double kShrinks = 0.3;
  constexpr double kLeastPart = 1.0 / 16;
  constexpr int kMostSteps = 12;
  std::vector<LinkChange> from =
      fitted_changes(data, fit, std::vector<LinkChange>(robot.joints.size()));
  // Refined again and again, the place of what is carried would drift against the links' masses.
  std::vector<Term> shaped = terms;
  double part = 1;
  double before = std::numeric_limits<double>::infinity();
  double least = before;
  Relinearised best;
  for (int step = 1;; ++step) {
    Relinearised anew = fitted_about(from, robot, data, options, shaped, step == 1);
    const double now = largest_step(robot, from, anew.links);
    if (now > (1 - kShrinks * part) * before) part = std::max(kLeastPart, part / 2);
    before = now;
    shaped = anew.terms;
    from = on_the_way(from, anew.links, part);
    if (step == 1 || now < least) {
      least = now;
      best = std::move(anew);
    }
    if (step == kMostSteps || least < kSmallStep) return best;
  }
}

}  // namespace offnominal::desk
