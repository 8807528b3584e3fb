#include "explain/undecided.hpp"

#include <algorithm>

#include "explain/alternatives.hpp"
#include "explain/beside_free_links.hpp"
#include "explain/link_share.hpp"
#include "explain/remainder.hpp"

namespace offnominal::desk {

using Eigen::Index;
using Eigen::VectorXd;

namespace {

// How far above its noise a joint's error has to stand. On a motion that shows little the model's
// own numbers take most of any effect; that what is left is no chance is asked of the best effect.
constexpr double kStandsOut = 1.5;
// Share of the error's energy on that joint that the best effect has to explain ...
constexpr double kExplains = 0.65;
// ... and what share of the best one's makes another one possible.
constexpr double kPossible = 0.75;

struct Possible {
  EffectAt what;
  double share = 0;  // of the error's energy on the joint in question
};

// What is left beside the nuisance where joints that do not move have no say: friction holds them
// at any torque within it, and the links' masses would follow that.
VectorXd left_of_moving_joints(const Regression& regression, const std::vector<Term>& terms,
                               const std::vector<Excitation>& excitation) {
  const RowLayout& layout = regression.data().layout;
  std::vector<char> rows(static_cast<std::size_t>(layout.rows()), 1);
  for (std::size_t r = 0; r < layout.recording_count(); ++r) {
    for (Index joint = 0; joint < layout.joint_count(); ++joint) {
      if (excitation[static_cast<std::size_t>(joint)].moves) continue;
      std::fill_n(rows.begin() + layout.begin(r, joint), layout.samples(r), 0);
    }
  }
  return regression.fit(terms, rows).residual;
}

// Joints on which something shows that has no name, and whose error stands out, by how far.
std::vector<Index> joints_that_show(const Regression& regression, const std::vector<Term>& terms,
                                    const std::vector<char>& is_unsure,
                                    const std::vector<Excitation>& excitation,
                                    const VectorXd& left_in_the_end) {
  std::vector<Index> shows;
  for (Index joint = 0; joint < regression.data().layout.joint_count(); ++joint) {
    const Excitation& motion = excitation[static_cast<std::size_t>(joint)];
    const bool answered = std::any_of(terms.begin(), terms.end(),
                                      [&](const Term& term) { return term.joint == joint; });
    if (is_unsure[static_cast<std::size_t>(joint)] != 0 && motion.moves && !answered) {
      shows.push_back(joint);
    }
  }
  if (shows.empty()) return shows;
  const Data& data = regression.data();
  const VectorXd left = left_of_moving_joints(regression, terms, excitation);
  const VectorXd fitted = data.layout.rms(left).cwiseMin(left_in_the_end);
  const VectorXd torque = data.layout.rms(data.torque);
  const VectorXd above = fitted.cwiseQuotient(noise_floor_of(data, left));
  std::erase_if(shows, [&](Index joint) {
    return !(above[joint] > kStandsOut && fitted[joint] > kRelevantTorque * torque[joint]);
  });
  std::stable_sort(shows.begin(), shows.end(),
                   [&](Index a, Index b) { return above[a] > above[b]; });
  return shows;
}

// A wave in time may stand for what follows the state, as waves are what motions are made of: it
// is possible only where it is nearly all that shows, and the state explains far less.
void leave_out_stand_ins_in_time(const std::vector<Proposal>& proposals,
                                 std::vector<Possible>& possible) {
  constexpr double kNearlyAll = 0.9;
  for (const Proposal& one : proposals) {
    const Term& term = one.terms.back();
    if (term.effect->spectrum() != EffectCandidate::Spectrum::kTime) continue;
    const EffectAt what{term.effect->kind(), term.joint};
    const auto here = std::find_if(possible.begin(), possible.end(),
                                   [&](const Possible& other) { return other.what == what; });
    if (here == possible.end()) continue;
    const bool another = std::any_of(possible.begin(), possible.end(), [&](const Possible& other) {
      return !(other.what == what) && other.share >= kPossible * here->share;
    });
    if (another || here->share < kNearlyAll) possible.erase(here);
  }
}

// What every proposal and every slow ripple explains on a joint, the most first.
std::vector<Possible> explained_on(Index joint, const Regression& regression,
                                   const std::vector<Term>& found, const VectorXd& before,
                                   const std::vector<Proposal>& proposals) {
  std::vector<Possible> possible;
  const auto add = [&](const EffectAt& what, const ModelFit& fit) {
    const double left = regression.data().layout.rms(fit.residual)[joint];
    const double share = explained_share(before[joint], left);
    const auto same = std::find_if(possible.begin(), possible.end(),
                                   [&](const Possible& other) { return other.what == what; });
    if (same == possible.end()) {
      possible.push_back({what, share});
    } else {
      same->share = std::max(same->share, share);
    }
  };
  for (const Term& ripple : slow_ripples(regression.data(), joint)) {
    std::vector<Term> terms = found;
    terms.push_back(ripple);
    const ModelFit fit = regression.fit(terms);
    add({ripple.effect->kind(), joint}, fit);
    // One or two bows over the range are as any curve over the position is.
    if (!regression.data().recordings[0].knows(EffectKind::kPositionTorque, joint)) {
      add({EffectKind::kPositionTorque, joint}, fit);
    }
  }
  for (const Proposal& one : proposals) {
    add({one.terms.back().effect->kind(), one.terms.back().joint}, one.fit);
  }
  leave_out_stand_ins_in_time(proposals, possible);
  std::stable_sort(possible.begin(), possible.end(),
                   [](const Possible& a, const Possible& b) { return a.share > b.share; });
  return possible;
}

// Another mass or torque constant.
bool is_own_number(const EffectAt& one) { return info_of(one.kind)->is_known_quantity(); }

// Empty where even the best explains too little, and where masses and torque constants are all that
// is possible: those are the model's own numbers. One alone gets no name either.
std::vector<EffectAt> class_of(const std::vector<Possible>& possible) {
  std::vector<EffectAt> names;
  if (possible.empty() || possible.front().share < kExplains) return names;
  for (const Possible& one : possible) {
    if (one.share < kPossible * possible.front().share) break;
    names.push_back(one.what);
  }
  const bool all_own = std::all_of(names.begin(), names.end(), is_own_number);
  return all_own ? std::vector<EffectAt>{} : names;
}

bool share_an_effect(const std::vector<EffectAt>& a, const std::vector<EffectAt>& b) {
  return std::any_of(a.begin(), a.end(), [&](const EffectAt& one) { return holds(b, one); });
}

// Rms error per joint beside links that may be off further.
VectorXd left_beside_wider_links(const SearchSetting& setting, const RobotDescription& robot,
                                 const std::vector<Term>& terms) {
  const Data data(*setting.data, robot, beside_wider_links(setting.nuisance));
  return data.layout.rms(Regression(data).fit(terms).residual);
}

}  // namespace

std::vector<UndecidedClass> undecided(const SearchSetting& setting, const RobotDescription& robot,
                                      const FoundModel& found,
                                      const std::vector<Excitation>& excitation,
                                      const VectorXd& left_in_the_end) {
  constexpr std::size_t kMostProposals = 24;
  const Regression& regression = *setting.regression;
  const Search& search = *setting.search;
  const std::vector<Term> terms = found.terms();
  const std::vector<Index> joints =
      joints_that_show(regression, terms, found.unsure, excitation, left_in_the_end);
  if (joints.empty()) return {};
  const VectorXd before = regression.data().layout.rms(found.fit.residual);
  const std::vector<Proposal> proposals =
      search.propose(terms, found.fit, search.screen(terms, found.fit), kMostProposals);
  if (proposals.empty() ||
      search.family_p(proposals.front(), found.fit) > search.options().family_error) {
    return {};
  }
  const VectorXd beside_wider =
      tells_links_apart(setting, robot) ? left_beside_wider_links(setting, robot, terms) : before;
  std::vector<UndecidedClass> classes;
  for (const Index joint : joints) {
    const auto possible = explained_on(joint, regression, terms, before, proposals);
    UndecidedClass one{class_of(possible), false};
    // One effect may show on several joints.
    const bool told = std::any_of(classes.begin(), classes.end(), [&](const auto& earlier) {
      return share_an_effect(earlier.effects, one.effects);
    });
    if (one.effects.empty() || told) continue;
    one.or_own_numbers =
        std::any_of(one.effects.begin(), one.effects.end(), is_own_number) ||
        explained_share(before[joint], beside_wider[joint]) >= kPossible * possible.front().share;
    classes.push_back(std::move(one));
  }
  return classes;
}

}  // namespace offnominal::desk
