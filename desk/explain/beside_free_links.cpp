#include "explain/beside_free_links.hpp"

#include <algorithm>
#include <cstddef>

namespace offnominal::desk {

namespace {

constexpr double kUnknown = 2;  // two standard deviations, as a share
// What it takes beside them, of what it takes beside the links of the file.
constexpr double kStaysNeeded = 0.5;

bool gives_way(const Term& term) {
  return term.effect->info().action == EffectAction::kDisplacement;
}

// Of what is left without the effect, the share that it takes, on the joint where that is most.
// `with`: the regression's fit of all that was found.
double share_taken(const Regression& regression, const FoundModel& found, const ModelFit& with,
                   std::size_t which) {
  const RowLayout& layout = regression.data().layout;
  const ModelFit without = regression.fit(found.terms_without(which));
  return best_fall(layout.rms(without.residual), layout.rms(with.residual)).share;
}

}  // namespace

void leave_out_links_in_disguise(const SearchSetting& setting, const RobotDescription& robot,
                                 int threads, FoundModel& found) {
  const auto is_asked = [](const Accepted& one) { return gives_way(one.term); };
  if (std::none_of(found.accepted.begin(), found.accepted.end(), is_asked)) return;
  NuisanceOptions unknown = setting.nuisance;
  unknown.link_share = kUnknown;
  unknown.link_geometry = true;
  const Data data(*setting.data, robot, unknown);
  const Regression beside_unknown(data);
  for (std::size_t i = found.accepted.size(); i-- > 0;) {
    if (!is_asked(found.accepted[i])) continue;
    const double own = share_taken(*setting.regression, found, found.fit, i);
    const double stays = share_taken(beside_unknown, found, beside_unknown.fit(found.terms()), i);
    if (stays >= std::max(kRelevantShare, kStaysNeeded * own)) continue;
    found.unsure[static_cast<std::size_t>(found.accepted[i].term.joint)] = 1;
    found.accepted.erase(found.accepted.begin() + static_cast<std::ptrdiff_t>(i));
    order_and_hold_out(*setting.regression, *setting.hold_out, threads, found);
    i = found.accepted.size();
  }
}

}  // namespace offnominal::desk
