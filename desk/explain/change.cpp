#include "explain/change.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <string>
#include <utility>

#include "explain/alternatives.hpp"
#include "explain/questions.hpp"
#include "explain/remainder.hpp"
#include "identify/independent_samples.hpp"
#include "identify/parallel.hpp"

namespace offnominal::desk {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr std::array kMayChange{EffectKind::kTipPayload, EffectKind::kCoulombFriction,
                                EffectKind::kViscousFriction, EffectKind::kTorqueOffset,
                                EffectKind::kTorqueScale};
constexpr std::size_t kMostChanges = 4;
constexpr double kClearly = 10;  // log-likelihood

// A remainder beside more columns, stacked and not weighted; what they do not add is left out.
Remainder beside_columns(Remainder at, const MatrixXd& columns) {
  constexpr double kNothingNew = 1e-3;
  MatrixXd fresh(at.residual.size(), columns.cols());
  for (Index c = 0; c < columns.cols(); ++c) {
    fresh.col(c) = at.weighted(columns.col(c));
    const double length = fresh.col(c).norm();
    if (length > 0) fresh.col(c) /= length;
  }
  fresh = at.beside_basis(std::move(fresh));
  Eigen::ColPivHouseholderQR<MatrixXd> qr(fresh);
  Index rank = 0;
  while (rank < qr.matrixR().cols() && std::abs(qr.matrixR()(rank, rank)) > kNothingNew) ++rank;
  if (rank == 0) return at;
  MatrixXd more = MatrixXd::Identity(fresh.rows(), rank);
  more.applyOnTheLeft(qr.householderQ());
  at.residual -= more * (more.transpose() * at.residual).eval();
  at.energy = at.layout->energy(at.residual);
  at.basis.conservativeResize(Eigen::NoChange, at.basis.cols() + rank);
  at.basis.rightCols(rank) = more;
  return at;
}

// The stretches of one recording, and where a change in it may be looked for.
struct Recorded {
  std::string file;
  double from_s = 0;
  double to_s = 0;
  std::vector<double> samples;  // time stamps of the kept samples, ascending
  std::vector<double> grid;     // moments, a few steps apart
};

std::vector<Recorded> recorded_in(const Data& data) {
  constexpr double kEdgeS = 1;
  constexpr double kEdgeShare = 0.05;
  constexpr int kSteps = 80;
  constexpr double kSmallestStepS = 0.2;
  std::vector<Recorded> all;
  for (const Workspace& at : data.recordings) {
    const VectorXd t_s = kept_samples(at.plan, at.motion.t_s);
    if (t_s.size() == 0) continue;
    auto same = std::find_if(all.begin(), all.end(),
                             [&](const Recorded& one) { return one.file == at.file; });
    if (same == all.end()) same = all.insert(all.end(), {at.file, t_s[0], t_s[0], {}, {}});
    same->samples.insert(same->samples.end(), t_s.begin(), t_s.end());
  }
  for (Recorded& one : all) {
    std::sort(one.samples.begin(), one.samples.end());
    one.from_s = one.samples.front();
    one.to_s = one.samples.back();
    const double duration = one.to_s - one.from_s;
    const double edge = std::max(kEdgeS, kEdgeShare * duration);
    const double step = std::max(kSmallestStepS, duration / kSteps);
    for (double t = one.from_s + edge; t <= one.to_s - edge; t += step) one.grid.push_back(t);
  }
  return all;
}

class ChangeFinder {
 public:
  ChangeFinder(const Regression& regression, std::vector<Term> terms, const SearchOptions& options)
      : regression_(regression),
        data_(regression.data()),
        terms_(std::move(terms)),
        options_(options),
        recorded_(recorded_in(data_)) {
    std::erase_if(terms_, [](const Term& term) { return term.effect->info().traits.counts_time; });
    for (const Recorded& in : recorded_) {
      rows_.emplace_back();
      for (const double t : in.grid) {
        rows_.back().push_back(rows_in({in.file, t}, data_.layout, data_.recordings));
      }
    }
    for (const auto& effect : all_candidates()) {
      if (std::find(kMayChange.begin(), kMayChange.end(), effect->kind()) == kMayChange.end()) {
        continue;
      }
      for (Index joint = 0; joint < data_.layout.joint_count(); ++joint)
        add_candidate(*effect, joint);
    }
  }

  std::vector<FoundChange> run() {
    while (found_.size() < kMostChanges && add_one()) {
    }
    return std::move(found_);
  }

 private:
  // An effect whose every moment has been tried; `term` is at the best one.
  struct Scanned {
    Term term;
    std::size_t recorded = 0;
    double log_likelihood = -std::numeric_limits<double>::infinity();
  };

  // In the middle of where its shape is looked for; a joint that stands may have nowhere to look.
  void add_candidate(const EffectCandidate& effect, Index joint) {
    if (!effect.applies_in_any(data_.recordings, joint)) return;
    Term term{&effect, joint, {}, effect.shapes(data_.recordings, joint)};
    for (const ShapeRange& range : term.ranges) {
      if (range.grid.empty()) return;
      term.shape.push_back(range.grid[range.grid.size() / 2]);
    }
    candidates_.push_back(std::move(term));
  }

  // Columns of what acts behind a moment of a grid alone.
  [[nodiscard]] MatrixXd behind(const MatrixXd& columns, std::size_t recorded,
                                std::size_t moment) const {
    return columns.array().colwise() * rows_[recorded][moment].array();
  }

  [[nodiscard]] static Term at_moment(Term term, const Recorded& in, double t_s) {
    term.during = TimeSpan{in.file, t_s};
    return term;
  }

  [[nodiscard]] double likelihood(const Judge& judge, const Term& term) const {
    const Evidence evidence = judge.evidence(columns_of(data_, term));
    return evidence.usable ? evidence.log_likelihood : 0;
  }

  // The model with what changes, as it is known so far.
  [[nodiscard]] std::vector<Term> model() const {
    std::vector<Term> all = terms_;
    for (const FoundChange& one : found_) all.push_back(one.term);
    return all;
  }

  // The effect as it would be all the time is beside it: only what changes is asked for. An error
  // with a step in it looks correlated for as long as the recording is: `independent` samples are
  // those of what is left without it.
  [[nodiscard]] Remainder beside_effect(const ModelFit& at, Term effect,
                                        const VectorXd& independent) const {
    effect.during.reset();
    Remainder beside = beside_columns(at.remainder, columns_of(data_, effect));
    beside.independent_samples = independent;
    return beside;
  }

  // As many as there are, for finding which change is the likeliest.
  [[nodiscard]] VectorXd all_samples() const {
    const RowLayout& layout = data_.layout;
    VectorXd samples = VectorXd::Zero(layout.joint_count());
    for (std::size_t r = 0; r < layout.recording_count(); ++r) {
      for (Index joint = 0; joint < samples.size(); ++joint) {
        samples[joint] += layout.moving_count(r, joint);
      }
    }
    return samples;
  }

  [[nodiscard]] Scanned scan(const Term& effect, const ModelFit& at) const {
    const Remainder remainder = beside_effect(at, effect, all_samples());
    const Judge judge(remainder);
    const MatrixXd columns = columns_of(data_, effect);
    Scanned best{effect};
    for (std::size_t r = 0; r < recorded_.size(); ++r) {
      for (std::size_t m = 0; m < recorded_[r].grid.size(); ++m) {
        const Evidence evidence = judge.evidence(behind(columns, r, m));
        if (!evidence.usable || evidence.log_likelihood <= best.log_likelihood) continue;
        best = {at_moment(effect, recorded_[r], recorded_[r].grid[m]), r, evidence.log_likelihood};
      }
    }
    return best;
  }

  // Moves the moment to where the recordings are most likely, near where it is: to the sample, and
  // between two of them.
  void refine_moment(Scanned& one, const Judge& judge) const {
    constexpr int kParts = 6;  // of the time between two samples
    const Recorded& in = recorded_[one.recorded];
    if (in.grid.size() < 2 || in.samples.size() < 2) return;
    const double around = one.term.during->from_s;
    const double reach = 1.5 * (in.grid[1] - in.grid[0]);
    one.log_likelihood = -std::numeric_limits<double>::infinity();
    const Term effect = one.term;
    const auto try_at = [&](double t_s) {
      const Term here = at_moment(effect, in, t_s);
      const double likely = likelihood(judge, here);
      if (likely <= one.log_likelihood) return;
      one.log_likelihood = likely;
      one.term = here;
    };
    const auto first = std::lower_bound(in.samples.begin(), in.samples.end(), around - reach);
    for (auto t = first; t != in.samples.end() && *t <= around + reach; ++t) try_at(*t);
    const double period = (in.to_s - in.from_s) / static_cast<double>(in.samples.size() - 1);
    const double best = one.term.during->from_s;
    for (int part = 1 - kParts; part < kParts; ++part) try_at(best + period * part / kParts);
  }

  // The moment, and the place of what is carried, each as the other has it.
  void refine(Scanned& one, const ModelFit& at) const {
    refine_moment(one, Judge(beside_effect(at, one.term, all_samples())));
    if (!one.term.is_searched()) return;
    std::vector<Term> all = model();
    all.push_back(one.term);
    regression_.refine(all, all.size() - 1);
    one.term = all.back();
    refine_moment(one, Judge(beside_effect(at, one.term, all_samples())));
  }

  // 95 % of where the moment is: as far as the likelihood stays near its top.
  [[nodiscard]] std::array<double, 2> moment_of(const Scanned& one, const Judge& judge) const {
    constexpr double kHalfChiSquared95 = 1.92;
    const std::vector<double>& samples = recorded_[one.recorded].samples;
    const auto top = std::lower_bound(samples.begin(), samples.end(), one.term.during->from_s);
    const auto is_near = [&](double t) {
      return likelihood(judge, at_moment(one.term, recorded_[one.recorded], t)) >=
             one.log_likelihood - kHalfChiSquared95;
    };
    // A change lies between the sample before and the first one that has it.
    auto low = top;
    while (low != samples.begin() && is_near(*std::prev(low))) --low;
    if (low != samples.begin()) --low;
    auto high = top;
    while (std::next(high) != samples.end() && is_near(*std::next(high))) ++high;
    return {*low, *high};
  }

  bool add_one() {
    constexpr std::size_t kMostTries = 4;
    const ModelFit at = regression_.fit(model());
    std::vector<Scanned> scanned(candidates_.size());
    parallel_for(scanned.size(), options_.threads,
                 [&](std::size_t i) { scanned[i] = scan(candidates_[i], at); });
    std::erase_if(scanned, [](const Scanned& one) { return one.log_likelihood < kClearly; });
    std::stable_sort(scanned.begin(), scanned.end(), [](const Scanned& a, const Scanned& b) {
      return a.log_likelihood > b.log_likelihood;
    });
    for (std::size_t i = 0; i < std::min(kMostTries, scanned.size()); ++i) {
      Scanned one = scanned[i];
      refine(one, at);
      if (auto change = judged(one, at)) {
        change->alike = alike(one, scanned, at);
        found_.push_back(std::move(*change));
        return true;
      }
    }
    return false;
  }

  // The model beside the effect all the time, where that adds anything.
  [[nodiscard]] std::vector<Term> model_with_effect(const Scanned& one, const ModelFit& at) const {
    std::vector<Term> all = model();
    Term effect = one.term;
    effect.during.reset();
    if (evidence_for(Judge(at.remainder), data_, effect).usable) all.push_back(std::move(effect));
    return all;
  }

  [[nodiscard]] std::optional<FoundChange> judged(Scanned one, const ModelFit& at) const {
    constexpr double kFamilyError = 0.01;
    const std::vector<Term> without = model_with_effect(one, at);
    std::vector<Term> with = without;
    with.push_back(one.term);
    const ModelFit fit_without = regression_.fit(without);
    const ModelFit fit = regression_.fit(with);
    const Remainder remainder = beside_effect(at, one.term, fit.remainder.independent_samples);
    const Judge judge(remainder);
    one.log_likelihood = likelihood(judge, one.term);
    if (one.log_likelihood < kClearly) return std::nullopt;
    const Fall fall =
        best_fall(data_.layout.rms(fit_without.residual), data_.layout.rms(fit.residual));
    if (!is_relevant(fall) || !is_sudden(one, judge) || !is_no_other_motion(one, remainder, fall)) {
      return std::nullopt;
    }
    FoundChange change;
    change.term = one.term;
    change.p = p_of(one.term, fit_without, fit);
    if (change.p > kFamilyError) return std::nullopt;
    // Physics of the file's own numbers does not matter to the size.
    const Estimates estimates = estimates_of(regression_, data_.recordings[0].rigid, with, fit);
    if (!(estimates.linear.back().from_nothing() >= 1)) return std::nullopt;
    change.numbers = estimates.terms.back();
    change.at_s = moment_of(one, judge);
    return change;
  }

  [[nodiscard]] bool is_relevant(const Fall& fall) const {
    const RowLayout& layout = data_.layout;
    const ModelFit plain = regression_.fit({});
    return fall.share >= kRelevantShare &&
           fall.rms >= kRelevantTorque * layout.rms(data_.torque)[fall.joint] &&
           fall.rms >= kLeftOfItself * layout.rms(plain.residual)[fall.joint];
  }

  // A drift of the effect, as slow as a cubic in time, does not make the recordings as likely.
  [[nodiscard]] bool is_sudden(const Scanned& one, const Judge& judge) const {
    constexpr double kSudden = 5;
    constexpr int kDegree = 3;
    const Recorded& in = recorded_[one.recorded];
    Term whole = one.term;
    whole.during = TimeSpan{in.file, in.from_s};
    const MatrixXd columns = columns_of(data_, whole);
    MatrixXd slow(columns.rows(), kDegree * columns.cols());
    const RowLayout& layout = data_.layout;
    for (std::size_t r = 0; r < data_.recordings.size(); ++r) {
      const Workspace& at = data_.recordings[r];
      const VectorXd t_s = kept_samples(at.plan, at.motion.t_s);
      const Eigen::ArrayXd part = (t_s.array() - in.from_s) / (in.to_s - in.from_s);
      for (Index joint = 0; joint < layout.joint_count(); ++joint) {
        const Index begin = layout.begin(r, joint);
        for (Index c = 0; c < slow.cols(); ++c) {
          slow.col(c).segment(begin, t_s.size()) =
              columns.col(c / kDegree).segment(begin, t_s.size()).array() *
              part.pow(static_cast<double>(c % kDegree + 1));
        }
      }
    }
    const Evidence drift = judge.evidence(slow);
    return one.log_likelihood > (drift.usable ? drift.log_likelihood : 0) + kSudden;
  }

  // Free functions of what the joint does take less than half of it: behind the moment it does not
  // only move otherwise.
  [[nodiscard]] bool is_no_other_motion(const Scanned& one, const Remainder& remainder,
                                        const Fall& fall) const {
    constexpr double kStays = 0.5;
    const MatrixXd columns = columns_of(data_, one.term);
    const double taken = Judge(remainder).gain(columns) * remainder.residual.squaredNorm();
    Remainder free = remainder;
    for (const char* variable : {"position", "velocity", "load"}) {
      free = beside_columns(std::move(free), bins_over(data_, fall.joint, variable));
    }
    const double still = Judge(free).gain(columns) * free.residual.squaredNorm();
    return still >= kStays * taken;
  }

  // Probability that such a search shows as much anywhere where nothing changes.
  [[nodiscard]] double p_of(const Term& term, const ModelFit& without, const ModelFit& fit) const {
    Remainder noise = fit.remainder;
    double block_s = kShortestBlockS;
    for (Index joint = 0; joint < data_.layout.joint_count(); ++joint) {
      block_s = std::max(block_s, independent_block_s(data_.layout, fit.residual, joint));
    }
    noise.blocks = data_.layout.blocks(block_s);
    const Judge judge(noise);
    std::vector<std::vector<Evidence>> of_candidates(candidates_.size());
    parallel_for(candidates_.size(), options_.threads, [&](std::size_t i) {
      const MatrixXd columns = columns_of(data_, candidates_[i]);
      for (std::size_t r = 0; r < recorded_.size(); ++r) {
        for (std::size_t m = 0; m < recorded_[r].grid.size(); ++m) {
          of_candidates[i].push_back(judge.evidence(behind(columns, r, m)));
        }
      }
    });
    std::vector<Evidence> groups;
    for (auto& of_one : of_candidates) {
      std::move(of_one.begin(), of_one.end(), std::back_inserter(groups));
    }
    std::erase_if(groups, [](const Evidence& one) { return !one.usable; });
    std::vector<double> largest = largest_without_effect(
        groups, noise.blocks.count, options_.bootstrap_draws, options_.seed, options_.threads);
    std::sort(largest.begin(), largest.end());
    Remainder before = without.remainder;
    before.blocks = noise.blocks;
    const Evidence evidence = Judge(before).evidence(columns_of(data_, term));
    if (!evidence.usable) return 1;
    return p_among(
        largest,
        -std::log10(std::max(
            p_of_statistic(evidence.statistic, evidence.coefficients.size(), before.blocks.count),
            1e-300)));
  }

  // What else could have changed, each at its own best moment near it.
  [[nodiscard]] std::vector<Term> alike(const Scanned& mine, const std::vector<Scanned>& scanned,
                                        const ModelFit& at) const {
    constexpr double kSameMomentS = 1;
    const auto fit_with = [&](const Scanned& one) {
      std::vector<Term> all = model_with_effect(one, at);
      all.push_back(one.term);
      return std::pair{regression_.fit(all), all};
    };
    const auto [chosen, terms] = fit_with(mine);
    const double energy =
        weighted_energy(data_, mine.term, chosen.coefficients.back(), chosen.joint_weights);
    std::vector<Term> all;
    for (Scanned other : scanned) {
      const bool same_effect =
          other.term.effect == mine.term.effect && other.term.joint == mine.term.joint;
      const bool elsewhere =
          other.recorded != mine.recorded ||
          std::abs(other.term.during->from_s - mine.term.during->from_s) > kSameMomentS;
      if (same_effect || elsewhere) continue;
      refine(other, at);
      if (as_good(data_, chosen, fit_with(other).first, energy)) all.push_back(other.term);
    }
    return all;
  }

  const Regression& regression_;
  const Data& data_;
  std::vector<Term> terms_;
  SearchOptions options_;
  std::vector<Recorded> recorded_;
  std::vector<std::vector<VectorXd>> rows_;  // per recording and moment: behind it
  std::vector<Term> candidates_;
  std::vector<FoundChange> found_;
};

}  // namespace

std::vector<FoundChange> changes_beside(const Regression& regression, std::vector<Term> terms,
                                        const SearchOptions& options) {
  return ChangeFinder(regression, std::move(terms), options).run();
}

std::vector<Term> terms_of(const std::vector<FoundChange>& changes) {
  std::vector<Term> terms;
  for (const FoundChange& one : changes) terms.push_back(one.term);
  return terms;
}

bool predicts_better(const Regression& regression, const FoundModel& with,
                     const Regression& regression_without, const FoundModel& without) {
  const auto held_out = [](const Regression& of, const FoundModel& model) {
    const HoldOut parts(of, nullptr);
    return parts.rms(parts.residual(model.terms(), model.fit));
  };
  const VectorXd after = held_out(regression, with);
  const VectorXd before = held_out(regression_without, without);
  double likely = 0;
  for (Index joint = 0; joint < after.size(); ++joint) {
    if (!(before[joint] > 0) || !(after[joint] > 0)) continue;
    likely +=
        with.fit.remainder.independent_samples[joint] * std::log(before[joint] / after[joint]);
  }
  return likely > kClearly;
}

}  // namespace offnominal::desk
