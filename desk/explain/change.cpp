#include "explain/change.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <string>
#include <utility>

#include "common/parallel.hpp"
#include "explain/alternatives.hpp"
#include "explain/change_questions.hpp"
#include "explain/excitation.hpp"
#include "explain/moments.hpp"
#include "explain/pushes.hpp"
#include "explain/questions.hpp"
#include "identify/independent_samples.hpp"

namespace offnominal::desk {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr std::size_t kMostChanges = 4;
constexpr double kClearly = 10;  // log-likelihood

class ChangeFinder {
 public:
  ChangeFinder(const Regression& regression, std::vector<Term> terms, const SearchOptions& options,
               const std::optional<TimeSpan>& given)
      : regression_(regression),
        data_(regression.data()),
        terms_(std::move(terms)),
        options_(options),
        moments_(data_, given) {
    std::erase_if(terms_, [](const Term& term) { return term.effect->info().traits.counts_time; });
    for (const auto& effect : all_candidates()) {
      if (!effect->info().traits.may_change) continue;
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
    }
    if (effect.is_mass()) reach_to_centre(term);
    for (const ShapeRange& range : term.ranges) {
      term.shape.push_back(range.grid[range.grid.size() / 2]);
    }
    candidates_.push_back(std::move(term));
  }

  // What is missing all the time at the last link's own centre is another mass of it, and is looked
  // for as that; what comes later may be put there.
  void reach_to_centre(Term& term) const {
    const auto& centre = data_.recordings[0]
                             .rigid.joints[static_cast<std::size_t>(term.joint)]
                             .joint.centre_of_mass_m;
    for (std::size_t axis = 0; axis < term.ranges.size(); ++axis) {
      std::vector<double>& grid = term.ranges[axis].grid;
      if (std::find(grid.begin(), grid.end(), centre.at(axis)) != grid.end()) continue;
      grid.insert(std::lower_bound(grid.begin(), grid.end(), centre.at(axis)), centre.at(axis));
    }
  }

  [[nodiscard]] const Moments::Recorded& recorded(const Scanned& one) const {
    return moments_.recorded()[one.recorded];
  }

  // Columns of a term as it would be all the time.
  [[nodiscard]] MatrixXd whole(Term term) const {
    term.during.reset();
    return columns_of(data_, term);
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
  [[nodiscard]] Remainder beside_effect(const ModelFit& at, const Term& effect,
                                        const VectorXd& independent) const {
    Remainder beside = beside_columns(at.remainder, whole(effect));
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
    const MatrixXd columns = whole(effect);
    Scanned best{effect};
    for (std::size_t r = 0; r < moments_.recorded().size(); ++r) {
      const Moments::Recorded& in = moments_.recorded()[r];
      for (std::size_t m = 0; m < in.grid.size(); ++m) {
        const double likely = likelihood_of(judge, moments_.behind(columns, r, m));
        if (likely <= best.log_likelihood) continue;
        best = {effect, r, likely};
        best.term.during = moments_.span(r, m);
      }
    }
    return best;
  }

  // One end of where it acts.
  using End = double TimeSpan::*;

  // Moves that end to where the recordings are most likely, near where it is, in ever smaller
  // steps: to a few parts of a sample.
  void refine_end(Scanned& one, End end, const Judge& judge) const {
    constexpr double kParts = 6;  // of the time between two samples
    constexpr int kSteps = 6;     // to either side
    const Moments::Recorded& in = recorded(one);
    const MatrixXd columns = whole(one.term);
    double reach = 1.5 * in.step_s();
    one.log_likelihood = -std::numeric_limits<double>::infinity();
    while (reach > in.period_s() / kParts) {
      TimeSpan here = *one.term.during;
      const double middle = here.*end;
      for (int step = -kSteps; step <= kSteps; ++step) {
        here.*end = middle + reach * step / kSteps;
        const double likely = likelihood_of(judge, moments_.inside(columns, here));
        if (likely <= one.log_likelihood) continue;
        one.log_likelihood = likely;
        one.term.during = here;
      }
      reach *= 1.5 / kSteps;
    }
  }

  void refine_ends(Scanned& one, const ModelFit& at) const {
    const Remainder remainder = beside_effect(at, one.term, all_samples());
    const Judge judge(remainder);
    refine_end(one, &TimeSpan::from_s, judge);
    if (!one.term.during->ends()) return;
    refine_end(one, &TimeSpan::to_s, judge);
    refine_end(one, &TimeSpan::from_s, judge);
  }

  // When it acts, and the place of what is carried, each as the other has it.
  void refine(Scanned& one, const ModelFit& at) const {
    if (!moments_.are_given()) refine_ends(one, at);
    if (!one.term.is_searched()) return;
    std::vector<Term> all = model();
    all.push_back(one.term);
    regression_.refine(all, all.size() - 1);
    one.term = all.back();
    if (!moments_.are_given()) refine_ends(one, at);
  }

  // A body at a place where it is not may look like less than other changes together do: it stands
  // against them where it fits best.
  void look_for_place(Scanned& one, const ModelFit& at) const {
    if (!one.term.effect->is_mass() || !one.term.is_searched() || !one.term.during) return;
    Scanned there = one;
    refine(there, at);
    const Remainder remainder = beside_effect(at, there.term, all_samples());
    there.log_likelihood = likelihood_of(Judge(remainder), columns_of(data_, there.term));
    if (there.log_likelihood > one.log_likelihood) one = there;
  }

  // What comes and goes again: from or to the moment that was found, where that makes the
  // recordings clearly more likely.
  void end_it(Scanned& one, const ModelFit& at) const {
    if (moments_.are_given()) return;
    const Remainder remainder = beside_effect(at, one.term, all_samples());
    const Judge judge(remainder);
    const MatrixXd columns = whole(one.term);
    Scanned best = one;
    best.log_likelihood += kClearly;
    const double moment = one.term.during->from_s;
    for (const double other : recorded(one).grid) {
      if (std::abs(other - moment) < kLongestPushS) continue;
      const TimeSpan part{one.term.during->files, std::min(moment, other), std::max(moment, other)};
      const double likely = likelihood_of(judge, moments_.inside(columns, part));
      if (likely <= best.log_likelihood) continue;
      best.log_likelihood = likely;
      best.term.during = part;
    }
    if (!best.term.during->ends()) return;
    refine(best, at);
    one = best;
  }

  // 95 % of where an end is: as far as the likelihood stays near its top.
  [[nodiscard]] std::array<double, 2> interval_of(const Scanned& one, End end,
                                                  const Judge& judge) const {
    constexpr double kHalfChiSquared95 = 1.92;
    const Moments::Recorded& in = recorded(one);
    const MatrixXd columns = whole(one.term);
    const auto farthest = [&](double sign) {
      TimeSpan here = *one.term.during;
      // Within a sample the filter leaves no more to be told.
      while (here.*end > in.from_s && here.*end < in.to_s) {
        here.*end += sign * in.period_s();
        const double likely = likelihood_of(judge, moments_.inside(columns, here));
        if (likely < one.log_likelihood - kHalfChiSquared95) break;
      }
      return std::clamp(here.*end, in.from_s, in.to_s);
    };
    return {farthest(-1), farthest(1)};
  }

  bool add_one() {
    constexpr std::size_t kMostTries = 4;
    const ModelFit at = regression_.fit(model());
    std::vector<Scanned> scanned(candidates_.size());
    parallel_for(scanned.size(), options_.threads,
                 [&](std::size_t i) { scanned[i] = scan(candidates_[i], at); });
    for (Scanned& one : scanned) look_for_place(one, at);
    std::erase_if(scanned, [](const Scanned& one) { return one.log_likelihood < kClearly; });
    std::stable_sort(scanned.begin(), scanned.end(), [](const Scanned& a, const Scanned& b) {
      return a.log_likelihood > b.log_likelihood;
    });
    for (std::size_t i = 0; i < std::min(kMostTries, scanned.size()); ++i) {
      Scanned one = scanned[i];
      refine(one, at);
      end_it(one, at);
      if (auto change = judged(one, at)) {
        one.term = change->term;
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

  // An error with a change in it says little about its joint: when it was is asked once more with
  // the weights of what is left beside it.
  void settle(Scanned& one, const std::vector<Term>& without) const {
    if (moments_.are_given()) return;
    std::vector<Term> with = without;
    with.push_back(one.term);
    refine_ends(one, regression_.fit_weighted_as(regression_.fit(with), without));
  }

  [[nodiscard]] std::optional<FoundChange> judged(Scanned one, const ModelFit& at) const {
    constexpr double kFamilyError = 0.01;
    const std::vector<Term> without = model_with_effect(one, at);
    settle(one, without);
    std::vector<Term> with = without;
    with.push_back(one.term);
    const ModelFit fit = regression_.fit(with);
    const ModelFit beside = regression_.fit_weighted_as(fit, without);
    const ModelFit fit_without = regression_.fit(without);
    const Remainder remainder = beside_effect(beside, one.term, fit.remainder.independent_samples);
    const Judge judge(remainder);
    one.log_likelihood = likelihood_of(judge, columns_of(data_, one.term));
    if (one.log_likelihood < kClearly) return std::nullopt;
    const bool asks_when = !moments_.are_given();
    // Friction and a brake hold a joint that stands with any torque up to their own.
    if (asks_when && !one.term.effect->is_mass() && !moves(data_.recordings, one.term.joint)) {
      return std::nullopt;
    }
    const Fall fall =
        best_fall(data_.layout.rms(fit_without.residual), data_.layout.rms(fit.residual));
    if (!is_relevant(fall) ||
        (asks_when &&
         !is_sudden(moments_, one.recorded, whole(one.term), one.log_likelihood, judge)) ||
        !is_no_other_motion(data_, remainder, columns_of(data_, one.term))) {
      return std::nullopt;
    }
    FoundChange change;
    change.term = one.term;
    change.p = p_of(one, fit_without, fit);
    if (change.p > kFamilyError) return std::nullopt;
    // Physics of the file's own numbers does not matter to the size.
    const Estimates estimates = estimates_of(regression_, data_.recordings[0].rigid, with, fit);
    if (!(estimates.linear.back().from_nothing() >= 1)) return std::nullopt;
    change.numbers = estimates.terms.back();
    if (asks_when) change.at_s = interval_of(one, &TimeSpan::from_s, judge);
    if (one.term.during->ends()) change.until_s = interval_of(one, &TimeSpan::to_s, judge);
    return change;
  }

  [[nodiscard]] bool is_relevant(const Fall& fall) const {
    const RowLayout& layout = data_.layout;
    const ModelFit plain = regression_.fit({});
    const double torque = layout.rms(data_.torque)[fall.joint];
    return is_worth_a_name(fall, torque) && fall.rms >= kRelevantTorque * torque &&
           fall.rms >= kLeftOfItself * layout.rms(plain.residual)[fall.joint];
  }

  // Probability that such a search shows as much anywhere where nothing changes.
  [[nodiscard]] double p_of(const Scanned& one, const ModelFit& without,
                            const ModelFit& fit) const {
    constexpr double kBlocksBeside = 3;  // a moment needs them on both sides to be judged by
    ModelFit noise = fit;
    double block_s = kShortestBlockS;
    for (Index joint = 0; joint < data_.layout.joint_count(); ++joint) {
      block_s = std::max(block_s, independent_block_s(data_.layout, fit.residual, joint));
    }
    noise.remainder.blocks = data_.layout.blocks(block_s);
    const double edge_s = kBlocksBeside * block_s;
    const TimeSpan& during = *one.term.during;
    const auto may_be_at = [&](const Moments::Recorded& in, double t_s) {
      return moments_.are_given() || in.is_inside(t_s, edge_s);
    };
    if (!may_be_at(recorded(one), during.from_s)) return 1;
    if (during.ends() &&
        (!may_be_at(recorded(one), during.to_s) || during.to_s - during.from_s < edge_s)) {
      return 1;
    }
    std::vector<std::vector<Evidence>> of_candidates(candidates_.size());
    parallel_for(candidates_.size(), options_.threads, [&](std::size_t i) {
      const Remainder beside =
          beside_effect(noise, candidates_[i], noise.remainder.independent_samples);
      const Judge judge(beside);
      const MatrixXd columns = whole(candidates_[i]);
      for (std::size_t r = 0; r < moments_.recorded().size(); ++r) {
        const Moments::Recorded& in = moments_.recorded()[r];
        for (std::size_t m = 0; m < in.grid.size(); ++m) {
          if (!may_be_at(in, in.grid[m])) continue;
          of_candidates[i].push_back(judge.evidence(moments_.behind(columns, r, m)));
        }
      }
    });
    std::vector<Evidence> groups;
    for (auto& of_one : of_candidates) {
      std::move(of_one.begin(), of_one.end(), std::back_inserter(groups));
    }
    std::erase_if(groups, [](const Evidence& group) { return !group.usable; });
    const int blocks = noise.remainder.blocks.count;
    std::vector<double> largest = largest_without_effect(groups, blocks, options_.bootstrap_draws,
                                                         options_.seed, options_.threads);
    std::sort(largest.begin(), largest.end());
    Remainder before = without.remainder;
    before.blocks = noise.remainder.blocks;
    const Evidence evidence = Judge(before).evidence(columns_of(data_, one.term));
    if (!evidence.usable) return 1;
    const double p =
        p_of_statistic(evidence.statistic, evidence.coefficients.size(), before.blocks.count);
    return p_among(largest, -std::log10(std::max(p, 1e-300)));
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
      const auto is_at = [&](double end_s) {
        return moments_.are_given() || std::abs(other.term.during->from_s - end_s) <= kSameMomentS;
      };
      const bool elsewhere = other.recorded != mine.recorded ||
                             !(is_at(mine.term.during->from_s) || is_at(mine.term.during->to_s));
      if (same_effect || elsewhere) continue;
      other.term.during = mine.term.during;
      refine(other, at);
      if (as_good(data_, chosen, fit_with(other).first, energy)) all.push_back(other.term);
    }
    return all;
  }

  const Regression& regression_;
  const Data& data_;
  std::vector<Term> terms_;
  SearchOptions options_;
  Moments moments_;
  std::vector<Term> candidates_;
  std::vector<FoundChange> found_;
};

}  // namespace

std::vector<FoundChange> changes_beside(const Regression& regression, std::vector<Term> terms,
                                        const SearchOptions& options,
                                        const std::optional<TimeSpan>& given) {
  return ChangeFinder(regression, std::move(terms), options, given).run();
}

bool are_same(const std::vector<FoundChange>& a, const std::vector<FoundChange>& b) {
  constexpr double kSameS = 0.2;
  return std::is_permutation(
      a.begin(), a.end(), b.begin(), b.end(), [&](const FoundChange& x, const FoundChange& y) {
        const auto near = [&](double s, double t) { return s == t || std::abs(s - t) <= kSameS; };
        return x.term.effect == y.term.effect && x.term.joint == y.term.joint &&
               x.term.during->files == y.term.during->files &&
               near(x.term.during->from_s, y.term.during->from_s) &&
               near(x.term.during->to_s, y.term.during->to_s);
      });
}

std::vector<Term> terms_of(const std::vector<FoundChange>& changes) {
  std::vector<Term> terms;
  for (const FoundChange& one : changes) terms.push_back(one.term);
  return terms;
}

bool predicts_better(const std::vector<FoundChange>& changes, const Regression& regression,
                     const FoundModel& with, const Regression& regression_without,
                     const FoundModel& without) {
  const auto held_out = [](const Regression& of, const FoundModel& model) {
    const HoldOut parts(of, nullptr);
    return parts.rms(parts.residual(model.terms(), model.fit));
  };
  const Data& data = regression.data();
  VectorXd samples = VectorXd::Zero(data.layout.joint_count());
  for (const FoundChange& one : changes) {
    for (const Index joint :
         acting_joints(data, columns_of(data, one.term), with.fit.joint_weights)) {
      samples[joint] = with.fit.remainder.independent_samples[joint];
    }
  }
  const VectorXd after = held_out(regression, with);
  const VectorXd before = held_out(regression_without, without);
  return growth_of_log_likelihood(before, after, samples) > kClearly;
}

}  // namespace offnominal::desk
