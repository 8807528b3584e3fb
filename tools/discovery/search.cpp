#include "discovery/search.hpp"

#include <algorithm>
#include <cmath>

#include "discovery/parallel.hpp"
#include "discovery/shape_search.hpp"
#include "signal/correlation.hpp"

namespace offnominal::tools::discovery {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr double kSmallestShare = 0.02;  // of the energy, for a closer look

}  // namespace

// What every model adapts in its nuisance is no discovery in another name either.
bool Search::is_worth_a_name(const Term& term, const VectorXd& coefficients) const {
  const auto& nuisance = data_.nuisance.terms;
  return term.effect->is_physical(coefficients) &&
         std::none_of(nuisance.begin(), nuisance.end(), [&](const NuisanceTerm& one) {
           return takes_place_of(term, one) && coefficients[0] <= one.prior.high;
         });
}

// In the robot file already, where it is one of a kind: then its numbers are a nuisance.
bool Search::is_known(const EffectCandidate& effect, Index joint) const {
  if (effect.spectrum() != EffectCandidate::Spectrum::kNone) return false;
  const auto& known = data_.recordings[0].known_effects;
  return std::any_of(known.begin(), known.end(), [&](const RobotEffect& one) {
    return one.joint == joint && one.kind == effect.kind();
  });
}

Search::Search(const Regression& regression, const SearchOptions& options)
    : regression_(regression), data_(regression.data()), options_(options) {
  for (const auto& effect : all_candidates()) {
    for (Index joint = 0; joint < data_.layout.joint_count(); ++joint) {
      const Workspace& first = data_.recordings[0];
      const bool acts =
          first.at_rest ? effect->acts_at_rest(first, joint) : effect->applies(first, joint);
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
    slot.columns[work[i].second] = columns_of(data_, term);
  });
}

std::vector<ShapePoint> Search::grid_of(const Term& term) {
  if (term.effect->spectrum() != EffectCandidate::Spectrum::kNone) return {};
  return product_grid(term.ranges);
}

void Search::finish(Screened& screened, const Remainder& at) const {
  const Evidence& evidence = screened.evidence;
  const double parameters = static_cast<double>(evidence.coefficients.size()) +
                            static_cast<double>(screened.term.ranges.size());
  const double samples = at.independent_samples.sum();
  screened.score = evidence.log_likelihood - 0.5 * parameters * std::log(std::max(samples, 2.0));
  screened.log10_p = -std::log10(std::max(
      p_of_statistic(evidence.statistic, evidence.coefficients.size(), at.blocks.count), 1e-300));
  screened.physical = is_worth_a_name(screened.term, evidence.coefficients);
}

Screened Search::judge_slot(const Slot& slot, const Remainder& at,
                            std::vector<Evidence>& all) const {
  Screened best;
  best.term = slot.term;
  best.score = -std::numeric_limits<double>::infinity();
  const bool spectral = slot.term.effect->spectrum() != EffectCandidate::Spectrum::kNone;
  const std::vector<ShapePoint> points =
      spectral ? spectral_peaks(data_, slot.term, at) : slot.grid;
  std::vector<MatrixXd> of_peaks;
  for (std::size_t g = 0; spectral && g < points.size(); ++g) {
    Term peak = slot.term;
    peak.shape = points[g];
    of_peaks.push_back(columns_of(data_, peak));
  }
  std::vector<Evidence> judged = judge_each(at, spectral ? of_peaks : slot.columns);
  for (std::size_t g = 0; g < points.size(); ++g) {
    Screened here;
    here.term = slot.term;
    here.term.shape = points[g];
    here.evidence = std::move(judged[g]);
    if (!here.evidence.usable) continue;
    finish(here, at);
    if (!spectral) all.push_back(here.evidence);
    const bool better = here.physical != best.physical ? here.physical : here.score > best.score;
    if (better) best = std::move(here);
  }
  return best;
}

Screening Search::screen(const std::vector<Term>& terms, const ModelFit& at) const {
  std::vector<const Slot*> open;
  for (const Slot& slot : slots_) {
    const bool taken = std::any_of(terms.begin(), terms.end(), [&](const Term& term) {
      return term.effect == slot.term.effect && term.joint == slot.term.joint &&
             term.effect->spectrum() == EffectCandidate::Spectrum::kNone;
    });
    if (!taken) open.push_back(&slot);
  }
  std::vector<Screened> screened(open.size());
  std::vector<std::vector<Evidence>> evidence(open.size());
  parallel_for(open.size(), options_.threads, [&](std::size_t i) {
    screened[i] = judge_slot(*open[i], at.remainder, evidence[i]);
  });
  Screening result;
  result.blocks = at.remainder.blocks.count;
  for (auto& part : evidence) {
    for (Evidence& one : part) result.groups.push_back(std::move(one));
  }
  for (const Slot* slot : open) {
    if (slot->term.effect->spectrum() != EffectCandidate::Spectrum::kNone) {
      result.spectral_points += static_cast<double>(slot->grid.size());
    }
  }
  std::erase_if(screened, [](const Screened& one) { return !one.evidence.usable; });
  std::stable_sort(screened.begin(), screened.end(),
                   [](const Screened& a, const Screened& b) { return a.score > b.score; });
  result.candidates = std::move(screened);
  return result;
}

double Search::family_p(const Proposal& proposal, const ModelFit& at) const {
  const RowLayout& layout = data_.layout;
  const VectorXd moving = layout.while_moving(proposal.fit.residual);
  double correlation_s = 0;
  double whole_s = 0;
  for (std::size_t r = 0; r < layout.recording_count(); ++r) {
    whole_s += layout.period_s(r) * static_cast<double>(layout.samples(r));
    for (Index joint = 0; joint < layout.joint_count(); ++joint) {
      const auto part = moving.segment(layout.begin(r, joint), layout.samples(r));
      correlation_s = std::max(correlation_s, correlation_samples(part) * layout.period_s(r));
    }
  }
  constexpr double kFewestBlocks = 20;
  const RowLayout::Blocks blocks = layout.blocks(
      std::max(kShortestBlockS, std::min(3 * correlation_s, whole_s / kFewestBlocks)));
  Remainder before = at.remainder;
  before.blocks = blocks;
  ModelFit noise = proposal.fit;
  noise.remainder.blocks = blocks;
  Screened candidate = proposal.candidate;
  candidate.evidence = judge(before, columns_of(data_, candidate.term));
  if (!candidate.evidence.usable) return 1;
  finish(candidate, before);
  const Screening without = screen(proposal.terms, noise);
  // Half of the error is for the spectra, half for the rest.
  if (candidate.term.effect->spectrum() != EffectCandidate::Spectrum::kNone) {
    return std::min(1.0, 2 * without.spectral_points * std::pow(10.0, -candidate.log10_p));
  }
  const std::vector<double> null = largest_without_effect(without.groups, without.blocks,
                                                          options_.bootstrap_draws, options_.seed);
  return std::min(1.0, 2 * p_among(null, candidate.log10_p));
}

std::vector<Proposal> Search::propose(const std::vector<Term>& terms, const ModelFit& at,
                                      const Screening& screening, const std::size_t most) const {
  std::vector<const Screened*> shortlist;
  for (const Screened& one : screening.candidates) {
    if (!one.physical && one.evidence.gain < kSmallestShare) continue;
    if (shortlist.size() < most) shortlist.push_back(&one);
  }
  std::vector<Proposal> proposals(shortlist.size());
  parallel_for(shortlist.size(), options_.threads, [&](std::size_t i) {
    Proposal& proposal = proposals[i];
    proposal.candidate = *shortlist[i];
    proposal.terms = terms;
    proposal.terms.push_back(shortlist[i]->term);
    regression_.refine(proposal.terms, proposal.terms.size() - 1, at);
    proposal.candidate.term = proposal.terms.back();
    const Evidence evidence = judge(at.remainder, columns_of(data_, proposal.terms.back()));
    if (evidence.usable) {
      proposal.candidate.evidence = evidence;
      finish(proposal.candidate, at.remainder);
    }
    proposal.fit = regression_.fit(proposal.terms);
    proposal.physical = is_worth_a_name(proposal.terms.back(), proposal.fit.coefficients.back());
  });
  std::erase_if(proposals, [](const Proposal& one) { return !one.physical; });
  rank(proposals);
  return proposals;
}

// All by the same number of independent samples: that of the model that leaves the least.
void Search::rank(std::vector<Proposal>& proposals) const {
  if (proposals.empty()) return;
  const RowLayout& layout = data_.layout;
  VectorXd samples = VectorXd::Zero(layout.joint_count());
  double least = std::numeric_limits<double>::infinity();
  for (const Proposal& one : proposals) {
    const double left = layout.rms(one.fit.residual).array().log().sum();
    if (left < least) {
      least = left;
      samples = one.fit.remainder.independent_samples;
    }
  }
  for (Proposal& one : proposals) {
    const Term& term = one.terms.back();
    const double parameters = static_cast<double>(one.fit.coefficients.back().size()) +
                              static_cast<double>(term.ranges.size());
    one.score = -(samples.array() * layout.rms(one.fit.residual).array().log()).sum() -
                0.5 * parameters * std::log(std::max(samples.sum(), 2.0));
  }
  std::stable_sort(proposals.begin(), proposals.end(),
                   [](const Proposal& a, const Proposal& b) { return a.score > b.score; });
}

}  // namespace offnominal::tools::discovery
