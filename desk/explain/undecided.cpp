#include "explain/undecided.hpp"

#include <algorithm>

#include "explain/alternatives.hpp"
#include "explain/remainder.hpp"

namespace offnominal::desk {

using Eigen::Index;
using Eigen::VectorXd;

namespace {

// How far above its noise a joint's error has to stand; joints with nothing missing reach 2.1.
constexpr double kStandsOut = 3;
// Share of the error's energy on that joint that the best effect has to explain ...
constexpr double kExplains = 0.8;
// ... and what share of the best one's makes another one possible.
constexpr double kPossible = 0.5;

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
                                    const std::vector<Excitation>& excitation) {
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
  const VectorXd fitted = data.layout.rms(left);
  const VectorXd torque = data.layout.rms(data.torque);
  const VectorXd above = fitted.cwiseQuotient(noise_floor_of(data, left));
  std::erase_if(shows, [&](Index joint) {
    return !(above[joint] > kStandsOut && fitted[joint] > kRelevantTorque * torque[joint]);
  });
  std::stable_sort(shows.begin(), shows.end(),
                   [&](Index a, Index b) { return above[a] > above[b]; });
  return shows;
}

// What every proposal and every slow ripple explains on a joint, the most first.
std::vector<Possible> explained_on(Index joint, const Regression& regression,
                                   const std::vector<Term>& found, const VectorXd& before,
                                   const std::vector<Proposal>& proposals) {
  std::vector<Possible> possible;
  const auto add = [&](const Term& term, const ModelFit& fit) {
    const EffectAt what{term.effect->kind(), term.joint};
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
    add(ripple, regression.fit(terms));
  }
  for (const Proposal& one : proposals) add(one.terms.back(), one.fit);
  std::stable_sort(possible.begin(), possible.end(),
                   [](const Possible& a, const Possible& b) { return a.share > b.share; });
  return possible;
}

// Empty where even the best explains too little. At least two otherwise: a motion as poor as this
// one does not leave a single effect.
std::vector<EffectAt> class_of(const std::vector<Possible>& possible) {
  std::vector<EffectAt> names;
  if (possible.size() < 2 || possible.front().share < kExplains) return names;
  for (const Possible& one : possible) {
    if (names.size() >= 2 && one.share < kPossible * possible.front().share) break;
    names.push_back(one.what);
  }
  return names;
}

bool share_an_effect(const std::vector<EffectAt>& a, const std::vector<EffectAt>& b) {
  return std::any_of(a.begin(), a.end(), [&](const EffectAt& one) { return holds(b, one); });
}

}  // namespace

std::vector<std::vector<EffectAt>> undecided(const Search& search, const Regression& regression,
                                             const FoundModel& found,
                                             const std::vector<Excitation>& excitation) {
  constexpr std::size_t kMostProposals = 24;
  const std::vector<Term> terms = found.terms();
  const std::vector<Index> joints = joints_that_show(regression, terms, found.unsure, excitation);
  if (joints.empty()) return {};
  const VectorXd before = regression.data().layout.rms(found.fit.residual);
  const std::vector<Proposal> proposals =
      search.propose(terms, found.fit, search.screen(terms, found.fit), kMostProposals);
  if (proposals.empty() ||
      search.family_p(proposals.front(), found.fit) > search.options().family_error) {
    return {};
  }
  std::vector<std::vector<EffectAt>> classes;
  for (const Index joint : joints) {
    std::vector<EffectAt> names =
        class_of(explained_on(joint, regression, terms, before, proposals));
    // One effect may show on several joints.
    const bool told = std::any_of(classes.begin(), classes.end(), [&](const auto& earlier) {
      return share_an_effect(earlier, names);
    });
    if (!names.empty() && !told) classes.push_back(std::move(names));
  }
  return classes;
}

}  // namespace offnominal::desk
