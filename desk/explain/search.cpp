#include "explain/search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "common/parallel.hpp"
#include "explain/excitation.hpp"
#include "explain/friction_family.hpp"
#include "identify/independent_samples.hpp"
#include "identify/shape_search.hpp"

namespace offnominal::desk {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr double kSmallestShare = 0.02;  // of the energy, for a closer look

// Numbers of a term's shape that the recordings choose.
double chosen_numbers(const Term& term) {
  return static_cast<double>(
      std::count_if(term.ranges.begin(), term.ranges.end(),
                    [](const ShapeRange& one) { return one.grid.size() != 1; }));
}

}  // namespace

// What every model adapts in its nuisance is no discovery in another name either.
bool Search::is_worth_a_name(const Term& term, const VectorXd& coefficients) const {
  const auto& nuisance = data_.nuisance.terms;
  return can_be(term, coefficients, data_.recordings) &&
         std::none_of(nuisance.begin(), nuisance.end(), [&](const NuisanceTerm& one) {
           return takes_place_of(term, one) && coefficients[0] >= one.prior.low &&
                  coefficients[0] <= one.prior.high;
         });
}

// In the robot file already, where it is one of a kind: then its numbers are a nuisance.
bool Search::is_known(const EffectCandidate& effect, Index joint) const {
  if (effect.spectrum() != EffectCandidate::Spectrum::kNone) return false;
  return data_.recordings[0].knows(effect.kind(), joint);
}

Search::Search(const Regression& regression, const SearchOptions& options)
    : regression_(regression), data_(regression.data()), options_(options) {
  for (Index joint = 0; joint < data_.layout.joint_count(); ++joint) {
    moves_.push_back(static_cast<char>(moves(data_.recordings, joint)));
  }
  for (const auto& effect : all_candidates()) {
    if (effect->info().traits.has_any_shape) continue;  // any_shape.hpp
    for (Index joint = 0; joint < data_.layout.joint_count(); ++joint) {
      const Workspace& first = data_.recordings[0];
      const bool acts = first.at_rest ? effect->acts_at_rest(first, joint)
                                      : effect->applies_in_any(data_.recordings, joint);
      if (!acts || is_known(*effect, joint)) continue;
      Slot slot;
      slot.term = {effect.get(), joint, {}, effect->shapes(data_.recordings, joint)};
      slot.grid = product_grid(slot.term.ranges);
      if (!slot.grid.empty()) slots_.push_back(std::move(slot));
    }
  }
  std::vector<std::pair<std::size_t, std::size_t>> work;
  for (std::size_t s = 0; s < slots_.size(); ++s) {
    if (slots_[s].term.effect->spectrum() != EffectCandidate::Spectrum::kNone) continue;
    slots_[s].columns.resize(slots_[s].grid.size());
    for (std::size_t g = 0; g < slots_[s].grid.size(); ++g) work.emplace_back(s, g);
  }
  parallel_for(work.size(), options.threads, [&](std::size_t i) {
    Slot& slot = slots_[work[i].first];
    Term term = slot.term;
    term.shape = slot.grid[work[i].second];
    slot.columns[work[i].second] = ActingColumns(data_.layout, columns_of(data_, term));
  });
}

std::vector<ShapePoint> Search::grid_of(const Term& term) {
  if (term.effect->spectrum() != EffectCandidate::Spectrum::kNone) return {};
  return product_grid(term.ranges);
}

void Search::finish(Screened& screened, const Remainder& at) const {
  const Evidence& evidence = screened.evidence;
  const double parameters =
      static_cast<double>(evidence.coefficients.size()) + chosen_numbers(screened.term);
  const double samples = at.independent_samples.sum();
  screened.score = evidence.log_likelihood - 0.5 * parameters * std::log(std::max(samples, 2.0));
  screened.log10_p = -std::log10(std::max(
      p_of_statistic(evidence.statistic, evidence.coefficients.size(), at.blocks.count), 1e-300));
  screened.physical = is_worth_a_name(screened.term, evidence.coefficients);
}

Screened Search::judge_slot(const Slot& slot, const Remainder& at, const Judge& judge) const {
  Screened best;
  best.term = slot.term;
  best.score = -std::numeric_limits<double>::infinity();
  const bool spectral = slot.term.effect->spectrum() != EffectCandidate::Spectrum::kNone;
  const std::vector<ShapePoint> points =
      spectral ? spectral_peaks(data_, slot.term, at) : slot.grid;
  for (std::size_t g = 0; g < points.size(); ++g) {
    Screened here;
    here.term = slot.term;
    here.term.shape = points[g];
    here.evidence =
        spectral ? judge.evidence(columns_of(data_, here.term)) : judge.evidence(slot.columns[g]);
    if (!here.evidence.usable) continue;
    finish(here, at);
    const bool better = here.physical != best.physical ? here.physical : here.score > best.score;
    if (better) best = std::move(here);
  }
  return best;
}

bool Search::is_open(const Slot& slot, const std::vector<Term>& terms) const {
  return std::none_of(terms.begin(), terms.end(), [&](const Term& term) {
    return term.effect == slot.term.effect && term.joint == slot.term.joint &&
           term.effect->spectrum() == EffectCandidate::Spectrum::kNone;
  });
}

Screening Search::screen(const std::vector<Term>& terms, const ModelFit& at) const {
  std::vector<const Slot*> open;
  for (const Slot& slot : slots_) {
    if (is_open(slot, terms)) open.push_back(&slot);
  }
  const Judge judge(at.remainder);
  std::vector<Screened> screened(open.size());
  parallel_for(open.size(), options_.threads,
               [&](std::size_t i) { screened[i] = judge_slot(*open[i], at.remainder, judge); });
  std::erase_if(screened, [](const Screened& one) { return !one.evidence.usable; });
  std::stable_sort(screened.begin(), screened.end(),
                   [](const Screened& a, const Screened& b) { return a.score > b.score; });
  return {std::move(screened)};
}

bool Search::is_asked_first(const Term& term) const {
  return term.effect->info().traits.every_drive_has &&
         !file_has(data_, term.effect->kind(), term.joint);
}

// What no search can name is none of its questions: the few rows of a joint that stands, which a
// rest or two fill, would show anything.
bool Search::can_show(const Term& term) const {
  if (data_.recordings[0].at_rest || !term.effect->is_mass()) {
    return data_.recordings[0].at_rest || moves_[static_cast<std::size_t>(term.joint)] != 0;
  }
  return std::any_of(moves_.begin(), moves_.begin() + term.joint + 1,
                     [](char one) { return one != 0; });
}

NullOfSearch Search::null_of(const std::vector<Term>& terms, const ModelFit& fit,
                             const ModelFit& at) const {
  const RowLayout& layout = data_.layout;
  // Lengths in a few steps: joints whose errors are correlated alike are judged at once.
  constexpr double kStep = 1.25;
  std::map<int, std::vector<Index>> joints_of_length;
  for (Index joint = 0; joint < layout.joint_count(); ++joint) {
    const double length_s = independent_block_s(layout, fit.residual, joint);
    joints_of_length[static_cast<int>(
                         std::floor(std::log(length_s / kShortestBlockS) / std::log(kStep) + 1e-9))]
        .push_back(joint);
  }
  NullOfSearch null;
  null.blocks.resize(static_cast<std::size_t>(layout.joint_count()));
  null.largest.assign(static_cast<std::size_t>(options_.bootstrap_draws), 0.0);
  for (const auto& [steps, joints] : joints_of_length) {
    ModelFit noise = fit;
    noise.remainder.blocks = layout.blocks(kShortestBlockS * std::pow(kStep, steps));
    for (const Index joint : joints) {
      null.blocks[static_cast<std::size_t>(joint)] = noise.remainder.blocks;
    }
    // The same noise beside the model before, which has nothing yet of what is asked first.
    Remainder before = at.remainder;
    before.blocks = noise.remainder.blocks;
    before.residual = before.beside_basis(before.weighted(fit.residual));
    before.energy = layout.energy(before.residual);
    const Judge judge_after(noise.remainder);
    const Judge judge_before(before);
    for (const bool first : {false, true}) {
      std::vector<const ActingColumns*> columns;
      for (const Slot& slot : slots_) {
        if (std::find(joints.begin(), joints.end(), slot.term.joint) == joints.end()) continue;
        if (!can_show(slot.term)) continue;
        if (is_asked_first(slot.term) != first || (!first && !is_open(slot, terms))) continue;
        for (const ActingColumns& one : slot.columns) columns.push_back(&one);
      }
      if (columns.empty()) continue;
      const Judge& judge = first ? judge_before : judge_after;
      std::vector<Evidence> groups(columns.size());
      parallel_for(columns.size(), options_.threads,
                   [&](std::size_t i) { groups[i] = judge.evidence(*columns[i]); });
      const std::vector<double> largest =
          largest_without_effect(groups, noise.remainder.blocks.count, options_.bootstrap_draws,
                                 options_.seed, options_.threads);
      std::vector<double>& all = first ? null.of_friction : null.largest;
      all.resize(largest.size(), 0.0);
      for (std::size_t i = 0; i < largest.size(); ++i) all[i] = std::max(all[i], largest[i]);
    }
  }
  std::sort(null.largest.begin(), null.largest.end());
  std::sort(null.of_friction.begin(), null.of_friction.end());
  for (const Slot& slot : slots_) {
    if (slot.term.effect->spectrum() != EffectCandidate::Spectrum::kNone) {
      null.spectral_points += static_cast<double>(slot.grid.size());
    }
  }
  return null;
}

double Search::family_p(const Term& term, const ModelFit& at, const NullOfSearch& null) const {
  Remainder before = at.remainder;
  before.blocks = null.blocks[static_cast<std::size_t>(term.joint)];
  const Evidence evidence = evidence_for(Judge(before), data_, term);
  if (!evidence.usable) return 1;
  const double log10_p = -std::log10(std::max(
      p_of_statistic(evidence.statistic, evidence.coefficients.size(), before.blocks.count),
      1e-300));
  // Half of the error is for the spectra, half for the rest.
  if (term.effect->spectrum() != EffectCandidate::Spectrum::kNone) {
    return std::min(1.0, 2 * null.spectral_points * std::pow(10.0, -log10_p));
  }
  // ... and of that half for friction where a file has none.
  const double share = null.of_friction.empty() ? 2 : 4;
  return std::min(1.0,
                  share * p_among(is_asked_first(term) ? null.of_friction : null.largest, log10_p));
}

double Search::family_p(const Proposal& proposal, const ModelFit& at) const {
  return family_p(proposal.terms.back(), at, null_of(proposal.terms, proposal.fit, at));
}

Proposal Search::proposal_of(std::vector<Term> terms, std::size_t first_new) const {
  Proposal proposal;
  proposal.terms = std::move(terms);
  proposal.added = proposal.terms.size() - first_new;
  proposal.fit = regression_.fit(proposal.terms);
  proposal.physical = true;
  for (std::size_t i = first_new; i < proposal.terms.size(); ++i) {
    proposal.physical =
        proposal.physical && is_worth_a_name(proposal.terms[i], proposal.fit.coefficients[i]);
  }
  return proposal;
}

std::vector<Proposal> Search::fitted(const std::vector<Term>& terms, const ModelFit& at,
                                     const std::vector<const Screened*>& shortlist) const {
  const Judge judge(at.remainder);
  std::vector<Proposal> proposals(shortlist.size());
  parallel_for(shortlist.size(), options_.threads, [&](std::size_t i) {
    std::vector<Term> longer = terms;
    longer.push_back(shortlist[i]->term);
    regression_.refine(longer, terms.size(), at, judge);
    proposals[i] = proposal_of(std::move(longer), terms.size());
  });
  std::erase_if(proposals, [](const Proposal& one) { return !one.physical; });
  return proposals;
}

std::vector<Proposal> Search::propose(const std::vector<Term>& terms, const ModelFit& at,
                                      const Screening& screening, const std::size_t most) const {
  std::vector<const Screened*> shortlist;
  for (const Screened& one : screening.candidates) {
    if (!one.physical && one.evidence.gain < kSmallestShare) continue;
    if (shortlist.size() < most) shortlist.push_back(&one);
  }
  std::vector<Proposal> proposals = fitted(terms, at, shortlist);
  rank(proposals);
  return proposals;
}

std::vector<std::vector<Proposal>> Search::propose_per_joint(
    const std::vector<Term>& terms, const ModelFit& at, const Screening& screening,
    const std::vector<char>& joints) const {
  constexpr std::size_t kMost = 7;
  constexpr double kNear = 0.5;  // of the best score
  std::vector<std::vector<const Screened*>> lists(joints.size());
  for (const Screened& one : screening.candidates) {
    const auto joint = static_cast<std::size_t>(one.term.joint);
    if (joints[joint] == 0 || lists[joint].size() >= kMost) continue;
    if (!one.physical && one.evidence.joint_gain < kSmallestShare) continue;
    const bool far = !lists[joint].empty() && one.score < kNear * lists[joint].front()->score;
    if (far && lists[joint].size() > 2) continue;
    lists[joint].push_back(&one);
  }
  std::vector<const Screened*> all;
  for (const auto& list : lists) all.insert(all.end(), list.begin(), list.end());
  std::vector<std::vector<Proposal>> proposals(joints.size());
  for (Proposal& one : fitted(terms, at, all)) {
    proposals[static_cast<std::size_t>(one.terms.back().joint)].push_back(std::move(one));
  }
  for (std::vector<Proposal>& of_joint : proposals) rank(of_joint);
  return proposals;
}

void Search::rank(std::vector<Proposal>& proposals) const {
  if (proposals.empty()) return;
  const RowLayout& layout = data_.layout;
  VectorXd samples = VectorXd::Zero(layout.joint_count());
  double least = std::numeric_limits<double>::infinity();
  // Of a joint of which nothing is left, nothing is said.
  const auto logs = [&](const ModelFit& fit) -> Eigen::ArrayXd {
    const Eigen::ArrayXd rms = layout.rms(fit.residual).array();
    return (rms > 0).select(rms.max(1e-300).log(), 0.0);
  };
  for (const Proposal& one : proposals) {
    const double left = logs(one.fit).sum();
    if (left < least) {
      least = left;
      samples = one.fit.remainder.independent_samples;
    }
  }
  for (Proposal& one : proposals) {
    double parameters = 0;
    for (std::size_t i = one.terms.size() - one.added; i < one.terms.size(); ++i) {
      parameters +=
          static_cast<double>(one.fit.coefficients[i].size()) + chosen_numbers(one.terms[i]);
    }
    one.score = -(samples.array() * logs(one.fit)).sum() -
                0.5 * parameters * std::log(std::max(samples.sum(), 2.0));
  }
  std::stable_sort(proposals.begin(), proposals.end(),
                   [](const Proposal& a, const Proposal& b) { return a.score > b.score; });
}

}  // namespace offnominal::desk
