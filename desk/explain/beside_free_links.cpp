#include "explain/beside_free_links.hpp"

#include <algorithm>
#include <cstddef>

#include "explain/link_share.hpp"

namespace offnominal::desk {

using Eigen::VectorXd;

namespace {

// What it takes beside them, of what it takes beside the links of the file.
constexpr double kStaysNeeded = 0.5;
// Of the joint's torque, beside links that had to be fitted further than CAD is off: so much of
// second derivatives they leave.
constexpr double kOfTorque = 0.02;

bool gives_way(const Term& term) {
  return term.effect->info().action == EffectAction::kDisplacement;
}

// What goes with the effect of what is left without it, on the joint where that is most. `with`:
// the regression's fit of all that was found.
Fall taken(const Regression& regression, const FoundModel& found, const ModelFit& with,
           std::size_t which) {
  const RowLayout& layout = regression.data().layout;
  const ModelFit without = regression.fit(found.terms_without(which));
  return best_fall(layout.rms(without.residual), layout.rms(with.residual));
}

}  // namespace

void leave_out_links_in_disguise(const SearchSetting& setting, const RobotDescription& robot,
                                 int threads, FoundModel& found) {
  const auto is_asked = [](const Accepted& one) { return gives_way(one.term); };
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
