#include "explain/friction_family.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/parallel.hpp"
#include "compare/inverse_model.hpp"
#include "explain/questions.hpp"

namespace offnominal::desk {

using Eigen::Index;
using Eigen::VectorXd;

namespace {

// How much more likely, in log-likelihood, a larger member has to make the recordings.
constexpr double kBeats = 3;

// What of Coulomb and viscous friction neither the file nor the model has on a joint.
std::vector<EffectKind> lacking(const Data& data, const std::vector<Term>& terms, Index joint) {
  std::vector<EffectKind> missing;
  for (const EffectInfo& info : kAllEffectInfos) {
    if (!info.traits.every_drive_has) continue;
    const EffectKind kind = info.kind;
    if (!file_has(data, kind, joint) && !has_term(terms, kind, joint)) missing.push_back(kind);
  }
  return missing;
}

// Whether it adds an effect of which that is true.
template <typename Is>
bool brings(const Proposal& one, const Is& is) {
  return std::any_of(one.terms.end() - static_cast<std::ptrdiff_t>(one.added), one.terms.end(),
                     [&](const Term& term) { return is(term.effect->info()); });
}

bool is_drift(const EffectInfo& info) { return info.traits.is_friction && info.traits.counts_time; }

bool may_lack_offset(const Data& data, const std::vector<Term>& terms, Index joint) {
  return !has_effect(data, terms, EffectKind::kTorqueOffset, joint) &&
         !has_effect(data, terms, EffectKind::kJointStiffness, joint);
}

// Of what friction a joint lacks each by itself and all together, and the same beside a constant
// torque: on a slow joint each hides the other, judged one after the other. Friction stands last.
std::vector<std::vector<EffectKind>> combinations_of(const std::vector<EffectKind>& missing,
                                                     bool with_offset) {
  std::vector<std::vector<EffectKind>> all;
  for (const EffectKind kind : missing) all.push_back({kind});
  if (missing.size() > 1) all.push_back(missing);
  const std::size_t without = all.size();
  for (std::size_t i = 0; with_offset && i < without; ++i) {
    std::vector<EffectKind> kinds{EffectKind::kTorqueOffset};
    kinds.insert(kinds.end(), all[i].begin(), all[i].end());
    all.push_back(std::move(kinds));
  }
  return all;
}

}  // namespace

bool file_has(const Data& data, EffectKind kind, Index joint) {
  const Workspace& at = data.recordings[0];
  return std::any_of(at.known_effects.begin(), at.known_effects.end(), [&](const RobotEffect& one) {
    return one.kind == kind && acts_on_joint(at.rigid, one, joint);
  });
}

Term first_on_grid(const Data& data, EffectKind kind, Index joint) {
  const auto& all = all_candidates();
  const auto effect =
      std::find_if(all.begin(), all.end(), [&](const auto& one) { return one->kind() == kind; });
  Term term{effect->get(), joint, {}, (*effect)->shapes(data.recordings, joint)};
  for (const ShapeRange& range : term.ranges) term.shape.push_back(range.grid.front());
  return term;
}

std::vector<Term> standard_friction(const Data& data) {
  std::vector<Term> terms;
  for (Index joint = 0; joint < data.layout.joint_count(); ++joint) {
    if (!moves_in_any(data.recordings, joint)) continue;
    for (const EffectKind kind : lacking(data, {}, joint)) {
      terms.push_back(first_on_grid(data, kind, joint));
    }
  }
  return terms;
}

bool is_refuted_by_simpler(const Data& data, const Term& simpler, const ModelFit& with_simpler,
                           const Term& other, const ModelFit& with_other) {
  if (other.joint != simpler.joint) return false;
  const VectorXd simple = data.layout.rms(with_simpler.residual);
  const VectorXd rest = data.layout.rms(with_other.residual);
  // A link that is heavier as a whole is a payload at its centre of mass.
  if (simpler.effect->kind() == EffectKind::kLinkMass &&
      other.effect->kind() == EffectKind::kTipPayload) {
    const VectorXd& samples = with_other.remainder.independent_samples;
    const auto place = static_cast<double>(other.shape.size());
    return growth_of_log_likelihood(simple, rest, samples) <
           kBeats + 0.5 * place * std::log(std::max(samples.sum(), 2.0));
  }
  return simpler.effect->info().traits.every_drive_has &&
         other.effect->info().traits.passes_for_friction &&
         rest[simpler.joint] >= simple[simpler.joint];
}

void refine_over_range(const Regression& regression, std::vector<Term>& terms, std::size_t which) {
  if (!terms[which].is_searched()) return;
  std::vector<Term> others = terms;
  others.erase(others.begin() + static_cast<std::ptrdiff_t>(which));
  const ModelFit beside = regression.fit(others);
  const Judge judge(beside.remainder);
  Term& term = terms[which];
  double most = judge.gain(columns_of(regression.data(), term));
  for (std::size_t axis = 0; axis < term.ranges.size(); ++axis) {
    if (!term.ranges[axis].is_searched()) continue;
    Term trial = term;
    for (const double value : term.ranges[axis].grid) {
      trial.shape[axis] = value;
      const double gain = judge.gain(columns_of(regression.data(), trial));
      if (gain <= most) continue;
      most = gain;
      term.shape[axis] = value;
    }
  }
  regression.refine(terms, which, beside, judge);
}

void put_friction_first(const Search& search, const Regression& regression,
                        const std::vector<Term>& terms, const std::vector<char>& open,
                        std::vector<std::vector<Proposal>>& proposals) {
  const Data& data = regression.data();
  if (data.recordings[0].at_rest) return;
  struct Member {
    std::size_t joint = 0;
    std::vector<EffectKind> kinds;
    Proposal proposal;
  };
  std::vector<Member> members;
  for (std::size_t joint = 0; joint < proposals.size(); ++joint) {
    const auto at = static_cast<Index>(joint);
    if (open[joint] == 0 || !moves_in_any(data.recordings, at)) continue;
    for (std::vector<EffectKind>& kinds :
         combinations_of(lacking(data, terms, at), may_lack_offset(data, terms, at))) {
      members.push_back({joint, std::move(kinds), {}});
    }
  }
  parallel_for(members.size(), search.options().threads, [&](std::size_t i) {
    Member& member = members[i];
    std::vector<Term> longer = terms;
    for (const EffectKind kind : member.kinds) {
      longer.push_back(first_on_grid(data, kind, static_cast<Index>(member.joint)));
    }
    refine_over_range(regression, longer, longer.size() - 1);
    member.proposal = search.proposal_of(std::move(longer), terms.size());
  });
  for (std::size_t joint = 0; joint < proposals.size(); ++joint) {
    std::vector<Proposal>& list = proposals[joint];
    bool has_family = false;
    for (Member& member : members) {
      if (member.joint != joint || !member.proposal.physical) continue;
      if (member.kinds.size() == 1) {
        const auto is_same = [&](const EffectInfo& info) { return info.kind == member.kinds[0]; };
        std::erase_if(list, [&](const Proposal& one) { return brings(one, is_same); });
      }
      list.push_back(std::move(member.proposal));
      has_family = true;
    }
    // What changes has to be there: a drift beside no friction at all stands for the friction.
    if (lacking(data, terms, static_cast<Index>(joint)).size() > 1) {
      std::erase_if(list, [](const Proposal& one) { return brings(one, is_drift); });
    }
    if (!has_family) continue;
    search.rank(list);
    double best = -std::numeric_limits<double>::infinity();
    for (const Proposal& one : list) {
      if (one.terms.back().effect->info().traits.every_drive_has) best = std::max(best, one.score);
    }
    std::erase_if(list, [&](const Proposal& one) {
      return one.terms.back().effect->info().traits.passes_for_friction &&
             one.score < best + kBeats;
    });
  }
}

}  // namespace offnominal::desk
