#include "explain/beside_free_links.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "explain/link_share.hpp"

namespace offnominal::desk {

using Eigen::VectorXd;

namespace {

// What it takes beside them, of what it takes beside the links of the file.
constexpr double kStaysNeeded = 0.5;
// Of the joint's torque, beside links that had to be fitted further than CAD is off: so much of
// second derivatives they leave.
constexpr double kOfTorque = 0.05;

// What goes with the effect of what is left without it, on the joint where that is most. `with`:
// the regression's fit of all that was found.
Fall taken(const Regression& regression, const FoundModel& found, const ModelFit& with,
           std::size_t which) {
  const RowLayout& layout = regression.data().layout;
  const ModelFit without = regression.fit(found.terms_without(which));
  return best_fall(layout.rms(without.residual), layout.rms(with.residual));
}

// What gravity on links that are a little elsewhere may look like.
bool may_be_gravity(const Term& term) {
  switch (term.effect->kind()) {
    case EffectKind::kTipPayload:
    case EffectKind::kLinkMass:
    case EffectKind::kTorqueOffset:
    case EffectKind::kTorqueScale:
    case EffectKind::kJointStiffness:
    case EffectKind::kPositionTorque:
      return true;
    default:
      return false;
  }
}

EffectAt at(const Accepted& one) { return {one.term.effect->kind(), one.term.joint}; }

// Masses that the numbers of their link and of the one before it may make up, where each is off by
// itself already.
std::vector<EffectAt> light_masses(const SearchSetting& setting, const RobotDescription& robot,
                                   const FoundModel& found) {
  constexpr double kShares = 2;
  std::vector<EffectAt> light;
  for (std::size_t i = 0; i < found.accepted.size(); ++i) {
    const Term& term = found.accepted[i].term;
    if (!term.effect->is_mass()) continue;
    const auto link = static_cast<std::size_t>(term.joint);
    const std::size_t before = link > 0 ? link - 1 : 0;
    const double near_kg = robot.joints[before].joint.mass_kg + robot.joints[link].joint.mass_kg;
    const double off_kg = kShares * setting.nuisance.link_share * near_kg;
    if (std::abs(found.fit.coefficients[i][0]) <= off_kg) light.push_back(at(found.accepted[i]));
  }
  return light;
}

}  // namespace

bool tells_links_apart(const SearchSetting& setting, const RobotDescription& robot) {
  constexpr int kFewestJoints = 3;
  return robot.joint_count() >= kFewestJoints && !setting.data->recordings[0].at_rest;
}

std::vector<EffectAt> could_be_links(const SearchSetting& setting, const RobotDescription& robot,
                                     const FoundModel& found) {
  if (!tells_links_apart(setting, robot)) return {};
  std::vector<EffectAt> links;
  if (setting.nuisance.link_geometry) links = light_masses(setting, robot, found);
  const auto is_asked = [&](const Accepted& one) {
    return may_be_gravity(one.term) && !holds(links, at(one));
  };
  if (std::none_of(found.accepted.begin(), found.accepted.end(), is_asked)) return links;
  const Data data(*setting.data, robot, beside_wider_links(setting.nuisance));
  const Regression beside_wider(data);
  const ModelFit with = beside_wider.fit(found.terms());
  for (std::size_t i = 0; i < found.accepted.size(); ++i) {
    if (!is_asked(found.accepted[i])) continue;
    const Fall own = taken(*setting.regression, found, found.fit, i);
    const Fall stays = taken(beside_wider, found, with, i);
    if (stays.share < kStaysNeeded * own.share) links.push_back(at(found.accepted[i]));
  }
  return links;
}

void leave_out_links_in_disguise(const SearchSetting& setting, const RobotDescription& robot,
                                 int threads, FoundModel& found) {
  const auto is_asked = [](const Accepted& one) { return one.term.effect->gives_way(); };
  if (std::none_of(found.accepted.begin(), found.accepted.end(), is_asked)) return;
  const Data data(*setting.data, robot, beside_unknown_links(setting.nuisance));
  const Regression beside_unknown(data);
  const VectorXd torque = data.layout.rms(data.torque);
  for (std::size_t i = found.accepted.size(); i-- > 0;) {
    if (!is_asked(found.accepted[i])) continue;
    const Fall own = taken(*setting.regression, found, found.fit, i);
    const Fall stays = taken(beside_unknown, found, beside_unknown.fit(found.terms()), i);
    const bool is_much =
        !setting.nuisance.link_geometry || own.rms >= kOfTorque * torque[own.joint];
    if (is_much && stays.share >= std::max(kRelevantShare, kStaysNeeded * own.share)) continue;
    found.unsure[static_cast<std::size_t>(found.accepted[i].term.joint)] = 1;
    found.accepted.erase(found.accepted.begin() + static_cast<std::ptrdiff_t>(i));
    order_and_hold_out(*setting.regression, *setting.hold_out, threads, found);
    i = found.accepted.size();
  }
}

}  // namespace offnominal::desk
