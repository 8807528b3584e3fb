#include "discovery/search.hpp"

#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <complex>
#include <numbers>

#include "analysis/fit_problem.hpp"
#include "discovery/parallel.hpp"

namespace offnominal::tools::discovery {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr double kShortestBlockS = 0.3;
constexpr double kSmallestShare = 0.02;  // of the energy, for a closer look

std::vector<ShapePoint> product_grid(const std::vector<ShapeRange>& ranges) {
  std::vector<ShapePoint> points{{}};
  for (const ShapeRange& range : ranges) {
    std::vector<ShapePoint> longer;
    for (const ShapePoint& point : points) {
      for (const double value : range.grid) {
        longer.push_back(point);
        longer.back().push_back(value);
      }
    }
    points = std::move(longer);
  }
  return points;
}

VectorXd independent_samples_of(const RowLayout& layout, const VectorXd& residual) {
  VectorXd samples = VectorXd::Zero(layout.joint_count());
  for (std::size_t r = 0; r < layout.recording_count(); ++r) {
    for (Index joint = 0; joint < layout.joint_count(); ++joint) {
      const auto part = residual.segment(layout.begin(r, joint), layout.samples(r));
      samples[joint] += static_cast<double>(part.size()) / correlation_samples(part);
    }
  }
  return samples;
}

}  // namespace

bool Search::has_dry_friction(const std::vector<Term>& terms, Index joint) const {
  const auto& known = data_.recordings[0].known_effects;
  return std::any_of(known.begin(), known.end(),
                     [&](const RobotEffect& effect) {
                       return effect.joint == joint && effect.kind == EffectKind::kCoulombFriction;
                     }) ||
         std::any_of(terms.begin(), terms.end(), [&](const Term& term) {
           return term.joint == joint && term.effect->is_dry_friction();
         });
}

// In the robot file already, where it is one of a kind: then its numbers are a nuisance.
bool Search::is_known(const EffectCandidate& effect, Index joint) const {
  if (effect.spectrum() != EffectCandidate::Spectrum::kNone) return false;
  const auto& known = data_.recordings[0].known_effects;
  return std::any_of(known.begin(), known.end(), [&](const RobotEffect& one) {
    return one.joint == joint && std::string_view(info_of(one.kind)->name) == effect.name();
  });
}

Search::Search(const Data& data, const SearchOptions& options) : data_(data), options_(options) {
  for (const auto& effect : all_candidates()) {
    for (Index joint = 0; joint < data.layout.joint_count(); ++joint) {
      if (!effect->applies(data.recordings[0], joint) || is_known(*effect, joint)) continue;
      Slot slot;
      slot.term = {effect.get(), joint, {}, effect->shapes(data.recordings, joint)};
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

MatrixXd Search::columns_of(const Data& data, const Term& term) {
  return stacked_columns(data.layout, data.recordings, *term.effect, term.joint, term.shape);
}

Search::Design Search::design(const std::vector<Term>& terms) const {
  Design made;
  for (std::size_t i = 0; i < data_.nuisance.terms.size(); ++i) {
    const NuisanceTerm& nuisance = data_.nuisance.terms[i];
    if (nuisance.kind == NuisanceTerm::Kind::kSignShape &&
        !has_dry_friction(terms, nuisance.joint)) {
      continue;
    }
    const bool replaced = nuisance.kind == NuisanceTerm::Kind::kSkew &&
                          std::any_of(terms.begin(), terms.end(), [&](const Term& term) {
                            return term.joint == nuisance.joint && term.effect->replaces_skew();
                          });
    if (!replaced) made.kept.push_back(static_cast<Index>(i));
  }
  std::vector<MatrixXd> of_terms;
  Index count = static_cast<Index>(made.kept.size());
  for (const Term& term : terms) {
    of_terms.push_back(columns_of(data_, term));
    made.first.push_back(count);
    count += of_terms.back().cols();
  }
  made.first.push_back(count);
  made.columns.resize(data_.layout.rows(), count);
  Index at = 0;
  for (const Index i : made.kept) {
    made.columns.col(at++) = data_.nuisance.columns.col(i);
    made.boxes.push_back(data_.nuisance.terms[static_cast<std::size_t>(i)].box);
  }
  for (const MatrixXd& of_term : of_terms) {
    made.columns.middleCols(at, of_term.cols()) = of_term;
    at += of_term.cols();
  }
  made.boxes.resize(static_cast<std::size_t>(count));
  return made;
}

ModelFit Search::fit(const std::vector<Term>& terms, const std::vector<char>& rows) const {
  const RowLayout& layout = data_.layout;
  const Design made = design(terms);
  const MatrixXd& columns = made.columns;
  VectorXd mask = VectorXd::Ones(layout.rows());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i] == 0) mask[static_cast<Index>(i)] = 0;
  }

  ModelFit result;
  BoxedFit boxed;
  VectorXd spread = layout.rms(data_.target);
  for (int pass = 0; pass < 2; ++pass) {
    const double floor = 1e-9 * layout.rms(data_.torque).maxCoeff() + 1e-300;
    result.joint_weights = spread.cwiseMax(floor).cwiseInverse();
    VectorXd row_weights = layout.weighted(mask, result.joint_weights);
    const MatrixXd weighted = row_weights.asDiagonal() * columns;
    boxed = boxed_least_squares(weighted, row_weights.cwiseProduct(data_.target), made.boxes);
    result.residual = data_.target - columns * boxed.x;
    spread = layout.rms(result.residual);
  }
  result.nuisance = VectorXd::Zero(data_.nuisance.columns.cols());
  for (std::size_t i = 0; i < made.kept.size(); ++i) {
    result.nuisance[made.kept[i]] = boxed.x[static_cast<Index>(i)];
  }
  for (std::size_t i = 0; i < terms.size(); ++i) {
    result.coefficients.push_back(
        boxed.x.segment(made.first[i], made.first[i + 1] - made.first[i]));
  }
  result.at_bound = boxed.at_bound;
  Remainder& remainder = result.remainder;
  remainder.layout = &layout;
  remainder.independent_samples = independent_samples_of(layout, result.residual);
  remainder.blocks = layout.blocks(kShortestBlockS);
  remainder.joint_weights = result.joint_weights;
  remainder.residual = boxed.residual;
  remainder.basis = boxed.basis;
  remainder.energy = joint_energy(layout, boxed.residual);
  return result;
}

std::vector<ShapePoint> Search::grid_of(const Term& term) {
  if (term.effect->spectrum() != EffectCandidate::Spectrum::kNone) return {};
  return product_grid(term.ranges);
}

std::vector<ShapePoint> Search::spectral_peaks(const Slot& slot, const Remainder& at) const {
  constexpr std::size_t kPeaks = 6;
  const RowLayout& layout = data_.layout;
  const std::vector<double>& grid = slot.term.ranges[0].grid;
  const bool position = slot.term.effect->spectrum() == EffectCandidate::Spectrum::kPosition;
  const JointType type =
      data_.recordings[0].rigid.joints[static_cast<std::size_t>(slot.term.joint)].joint.type;
  const double unit = position && type == JointType::kPrismatic ? 2 * std::numbers::pi : 1.0;
  std::vector<double> power(grid.size(), 0.0);
  for (std::size_t r = 0; r < layout.recording_count(); ++r) {
    const Workspace& workspace = data_.recordings[r];
    const VectorXd variable = position ? VectorXd(workspace.motion.q.col(slot.term.joint))
                                       : VectorXd(workspace.motion.t_s.array() - workspace.start_s);
    const Eigen::ArrayXd phase = unit * kept_samples(workspace.plan, variable).array();
    const Eigen::ArrayXd values =
        at.residual.segment(layout.begin(r, slot.term.joint), layout.samples(r)).array();
    const double step = grid.size() > 1 ? grid[1] - grid[0] : 0.0;
    Eigen::ArrayXd c = (grid[0] * phase).cos();
    Eigen::ArrayXd s = (grid[0] * phase).sin();
    const Eigen::ArrayXd dc = (step * phase).cos();
    const Eigen::ArrayXd ds = (step * phase).sin();
    for (std::size_t g = 0; g < grid.size(); ++g) {
      const double in = (values * c).sum();
      const double quadrature = (values * s).sum();
      power[g] += in * in + quadrature * quadrature;
      const Eigen::ArrayXd turned = c * dc - s * ds;
      s = s * dc + c * ds;
      c = turned;
    }
  }
  std::vector<std::size_t> peaks;
  for (std::size_t g = 0; g < power.size(); ++g) {
    const bool rises = g == 0 || power[g] >= power[g - 1];
    const bool falls = g + 1 == power.size() || power[g] > power[g + 1];
    if (rises && falls) peaks.push_back(g);
  }
  const std::size_t most = std::min(kPeaks, peaks.size());
  std::partial_sort(peaks.begin(), peaks.begin() + static_cast<std::ptrdiff_t>(most), peaks.end(),
                    [&](std::size_t a, std::size_t b) { return power[a] > power[b]; });
  std::vector<ShapePoint> points;
  for (std::size_t i = 0; i < most; ++i) points.push_back({grid[peaks[i]]});
  return points;
}

void Search::finish(Screened& screened, const Remainder& at) const {
  const Evidence& evidence = screened.evidence;
  const double parameters = static_cast<double>(evidence.coefficients.size()) +
                            static_cast<double>(screened.term.ranges.size());
  const double samples = at.independent_samples.sum();
  screened.score = evidence.log_likelihood - 0.5 * parameters * std::log(std::max(samples, 2.0));
  screened.log10_p = -std::log10(std::max(
      p_of_statistic(evidence.statistic, evidence.coefficients.size(), at.blocks.count), 1e-300));
  screened.physical = screened.term.effect->is_physical(evidence.coefficients);
}

Screened Search::judge_slot(const Slot& slot, const Remainder& at,
                            std::vector<Evidence>& all) const {
  Screened best;
  best.term = slot.term;
  best.score = -std::numeric_limits<double>::infinity();
  const bool spectral = slot.term.effect->spectrum() != EffectCandidate::Spectrum::kNone;
  const std::vector<ShapePoint> points = spectral ? spectral_peaks(slot, at) : slot.grid;
  for (std::size_t g = 0; g < points.size(); ++g) {
    Screened here;
    here.term = slot.term;
    here.term.shape = points[g];
    here.evidence = judge(at, spectral ? columns_of(data_, here.term) : slot.columns[g]);
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
  double correlation_s = 0;
  double whole_s = 0;
  for (std::size_t r = 0; r < layout.recording_count(); ++r) {
    whole_s += layout.period_s(r) * static_cast<double>(layout.samples(r));
    for (Index joint = 0; joint < layout.joint_count(); ++joint) {
      const auto part = proposal.fit.residual.segment(layout.begin(r, joint), layout.samples(r));
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
                                      const Screening& screening) const {
  constexpr std::size_t kShortlist = 10;
  std::vector<const Screened*> shortlist;
  for (const Screened& one : screening.candidates) {
    if (!one.physical && one.evidence.gain < kSmallestShare) continue;
    if (shortlist.size() < kShortlist) shortlist.push_back(&one);
  }
  std::vector<Proposal> proposals(shortlist.size());
  parallel_for(shortlist.size(), options_.threads, [&](std::size_t i) {
    Proposal& proposal = proposals[i];
    proposal.candidate = *shortlist[i];
    proposal.terms = terms;
    proposal.terms.push_back(shortlist[i]->term);
    refine(proposal.terms, proposal.terms.size() - 1);
    proposal.candidate.term = proposal.terms.back();
    const Evidence evidence = judge(at.remainder, columns_of(data_, proposal.terms.back()));
    if (evidence.usable) {
      proposal.candidate.evidence = evidence;
      finish(proposal.candidate, at.remainder);
    }
    proposal.fit = fit(proposal.terms);
    proposal.physical = proposal.terms.back().effect->is_physical(proposal.fit.coefficients.back());
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

void Search::refine(std::vector<Term>& terms, std::size_t which) const {
  Term& term = terms[which];
  for (std::size_t axis = 0; axis < term.ranges.size(); ++axis) {
    const ShapeRange& range = term.ranges[axis];
    if (range.discrete || (range.grid.size() < 2 && !(range.high > range.low))) continue;
    const auto coordinate = [&](double value) {
      return range.logarithmic ? std::log(value) : value;
    };
    const auto value_at = [&](double x) { return range.logarithmic ? std::exp(x) : x; };
    const auto above = std::upper_bound(range.grid.begin(), range.grid.end(), term.shape[axis]);
    const auto place =
        static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, (above - range.grid.begin()) - 1));
    const bool one = range.grid.size() < 2;
    const double low = coordinate(one ? range.low : range.grid[place > 0 ? place - 1 : 0]);
    const double high =
        coordinate(one ? range.high : range.grid[std::min(place + 1, range.grid.size() - 1)]);
    std::vector<Term> others = terms;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(which));
    const ModelFit beside = fit(others);
    const auto gain = [&](double x) {
      Term trial = term;
      trial.shape[axis] = value_at(x);
      const Evidence evidence = judge(beside.remainder, columns_of(data_, trial));
      return evidence.usable ? evidence.gain : -1.0;
    };
    constexpr int kBits = 22;
    std::uintmax_t most = 40;
    const auto [found, loss] = boost::math::tools::brent_find_minima(
        [&](double x) { return -gain(x); }, low, high, kBits, most);
    if (-loss > gain(coordinate(term.shape[axis]))) term.shape[axis] = value_at(found);
  }
}

}  // namespace offnominal::tools::discovery
