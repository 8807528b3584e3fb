#include "explain/any_shape.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "explain/alternatives.hpp"
#include "explain/remainder.hpp"

namespace offnominal::desk {

using Eigen::Index;

namespace {

// As leave_out_stand_ins() has them: what is left is looked at where it stands so far above the
// noise, and this share of it follows the variable; what has a name takes so much of what a free
// function takes.
constexpr double kFarAboveNoise = 1.5;
constexpr double kFollowing = 0.15;
constexpr double kAlmostAll = 0.9;
constexpr double kNearlyTheCurve = 0.95;
// Of the error's energy: a name that leaves so many times what a curve leaves is another's.
constexpr double kFarMore = 10;
// Of the curve's, what something simpler may leave that takes nearly as much.
constexpr double kAboutAsLittle = 1.5;
// How much more likely, in log-likelihood, it has to make the recordings than anything simpler.
constexpr double kMoreLikely = 3;

std::optional<Term> curve_of(const Data& data, const EffectCandidate& effect, Index joint) {
  Term term{&effect, joint, {}, effect.shapes(data.recordings, joint)};
  for (const ShapeRange& range : term.ranges) {
    if (range.grid.empty()) return std::nullopt;
    term.shape.push_back(range.grid.front());
  }
  return term;
}

double energy_on(const Data& data, const ModelFit& fit, Index joint) {
  return std::pow(data.layout.rms(fit.residual)[joint], 2);
}

double explained_on(const Data& data, const ModelFit& before, const ModelFit& after, Index joint) {
  return energy_on(data, before, joint) - energy_on(data, after, joint);
}

// The terms but those.
std::vector<Term> without(std::vector<Term> terms, const std::vector<std::size_t>& which) {
  for (std::size_t i = which.size(); i-- > 0;) {
    terms.erase(terms.begin() + static_cast<std::ptrdiff_t>(which[i]));
  }
  return terms;
}

class Curve {
 public:
  Curve(const Search& search, const Regression& regression, const FoundModel& found, Term curve)
      : search_(search),
        regression_(regression),
        data_(regression.data()),
        found_(found),
        terms_(found.terms()),
        curve_(std::move(curve)) {
    for (std::size_t i = 0; i < terms_.size(); ++i) {
      if (terms_[i].joint != curve_.joint) continue;
      const bool is_held = is_nested(data_, found_.baseline, terms_[i], curve_);
      if (is_held) held_.push_back(i);
      if (is_held || terms_[i].effect->info().traits.follows == variable()) own_.push_back(i);
    }
  }

  [[nodiscard]] std::optional<AnyShape> judged() const {
    AnyShape shape = in_place_of(own_);
    if (energy(shape.proposal.fit) >= energy(found_.fit)) shape = in_place_of(held_);
    const double taken = explained_on(data_, shape.without, shape.proposal.fit, curve_.joint);
    const double more =
        energy(shape.proposal.fit) * share_of(structure_of(data_, shape.proposal.fit.residual),
                                              curve_.joint, name_of(variable()));
    if (!(taken > 0) || taken < kAlmostAll * (taken + more)) return std::nullopt;
    if (!describe_replaced(taken, shape) || !beats_the_simpler(shape.proposal)) return std::nullopt;
    if (variable() != EffectVariable::kPosition) return shape;
    if (is_a_stop(taken, shape)) return std::nullopt;
    if (auto ripple = as_a_ripple(taken, shape)) {
      shape.proposal = std::move(*ripple);
      shape.words.clear();
    }
    return shape;
  }

 private:
  [[nodiscard]] EffectVariable variable() const { return curve_.effect->info().traits.follows; }
  [[nodiscard]] double energy(const ModelFit& fit) const {
    return energy_on(data_, fit, curve_.joint);
  }

  [[nodiscard]] AnyShape in_place_of(std::vector<std::size_t> replaced) const {
    std::vector<Term> terms = without(terms_, replaced);
    AnyShape shape{{}, regression_.fit(terms), std::move(replaced), {}};
    terms.push_back(curve_);
    shape.proposal = search_.proposal_of(terms, terms.size() - 1);
    return shape;
  }

  // A ripple that takes as much as the curve with two numbers instead of many, and leaves about as
  // little, if there is one. Ripples are searched from two periods per range on, as less than one
  // is any curve.
  [[nodiscard]] std::optional<Proposal> as_a_ripple(double taken, const AnyShape& shape) const {
    std::vector<Term> terms = without(terms_, shape.replaced);
    std::optional<Term> ripple = best_ripple(terms, Judge(shape.without.remainder));
    if (!ripple) return std::nullopt;
    terms.push_back(std::move(*ripple));
    regression_.refine(terms, terms.size() - 1);
    Proposal proposal = search_.proposal_of(terms, terms.size() - 1);
    const double of_ripple = explained_on(data_, shape.without, proposal.fit, curve_.joint);
    const bool as_little = energy(proposal.fit) <= kAboutAsLittle * energy(shape.proposal.fit);
    if (of_ripple < kNearlyTheCurve * taken || !as_little || !proposal.physical)
      return std::nullopt;
    return proposal;
  }

  // Of one to a little more than two periods over the range, beside these terms.
  [[nodiscard]] std::optional<Term> best_ripple(const std::vector<Term>& terms,
                                                const Judge& judge) const {
    constexpr std::array kPeriods{1.0, 1.1, 1.2, 1.3, 1.4, 1.5, 1.6, 1.7, 1.8, 1.9, 2.0, 2.1, 2.2};
    const std::vector<Term> ripples = ripples_of(data_, curve_.joint, kPeriods);
    ShapeRange orders;
    for (const Term& one : ripples) {
      if (one.effect == ripples.front().effect) orders.grid.push_back(one.shape[0]);
    }
    std::optional<Term> best;
    double most = 0;
    for (const Term& ripple : ripples) {
      if (has_effect(data_, terms, ripple.effect->kind(), curve_.joint)) continue;
      const double gain = evidence_for(judge, data_, ripple).gain;
      if (gain <= most) continue;
      most = gain;
      best = ripple;
      best->ranges = {orders};
    }
    return best;
  }

  // Whether a stop, which acts on one side of a place and is proportional to how far beyond, takes
  // as much as the curve, and leaves about as little: what has a kink is no smooth curve, however
  // well one goes round it.
  [[nodiscard]] bool is_a_stop(double taken, const AnyShape& shape) const {
    const Judge judge(shape.without.remainder);
    const double of_stop = most_of_a_stop(judge) / evidence_for(judge, data_, curve_).gain;
    if (of_stop < kNearlyTheCurve) return false;
    const double left = energy(shape.without) - of_stop * taken;
    return left <= kAboutAsLittle * energy(shape.proposal.fit);
  }

  // What the best stop takes, wherever it is: on a grid first, then about the best of that.
  [[nodiscard]] double most_of_a_stop(const Judge& judge) const {
    constexpr int kPlaces = 60;
    constexpr int kFiner = 10;
    const auto [low, high] = positions_seen(data_.recordings, curve_.joint);
    const double step = (high - low) / kPlaces;
    double most = 0;
    for (const double side : {1.0, -1.0}) {
      double best = low + step;
      double of_best = 0;
      const auto try_at = [&](double place) {
        const double gain = judge.gain(beyond(side, place));
        if (gain > of_best) {
          of_best = gain;
          best = place;
        }
      };
      for (int i = 1; i < kPlaces; ++i) try_at(low + step * i);
      const double about = best;
      for (int i = 1 - kFiner; i < kFiner; ++i) try_at(about + step * i / kFiner);
      most = std::max(most, of_best);
    }
    return most;
  }

  // How far the joint is beyond a place, on one side of it, stacked.
  [[nodiscard]] Eigen::VectorXd beyond(double side, double place) const {
    std::vector<Regressor> beyond;
    for (const Workspace& at : data_.recordings) {
      const Eigen::ArrayXd q = at.motion.q.col(curve_.joint).array();
      beyond.push_back({{curve_.joint, (side * (q - place)).max(0.0).matrix()}});
    }
    return data_.layout.stack(data_.recordings, beyond);
  }

  // What the replaced are of what the curve takes, in words; false where one of them is nearly all,
  // and does not leave far more than the curve.
  [[nodiscard]] bool describe_replaced(double taken, AnyShape& shape) const {
    const char* name = nullptr;
    double most = 0;
    for (const std::size_t i : shape.replaced) {
      std::vector<Term> alone = without(terms_, shape.replaced);
      alone.push_back(terms_[i]);
      const ModelFit fit = regression_.fit(alone);
      const double own = explained_on(data_, shape.without, fit, curve_.joint) / taken;
      const bool leaves_far_more = energy(fit) > kFarMore * energy(shape.proposal.fit);
      if (own >= kAlmostAll && !leaves_far_more) return false;
      if (name != nullptr && own <= most) continue;
      most = own;
      name = terms_[i].effect->name();
    }
    if (name != nullptr) shape.words = fmt::format("{} is {:.0f} % of it", name, 100 * most);
    return true;
  }

  [[nodiscard]] bool beats_the_simpler(const Proposal& curve) const {
    const auto joint = static_cast<std::size_t>(curve_.joint);
    std::vector<char> open(static_cast<std::size_t>(data_.layout.joint_count()), 0);
    open[joint] = 1;
    auto proposals =
        search_.propose_per_joint(terms_, found_.fit, search_.screen(terms_, found_.fit), open);
    std::vector<Proposal>& all = proposals[joint];
    all.push_back(curve);
    search_.rank(all);
    double own = 0;
    double best = -std::numeric_limits<double>::infinity();
    for (const Proposal& one : all) {
      if (one.terms.back().effect == curve_.effect) {
        own = one.score;
      } else {
        best = std::max(best, one.score);
      }
    }
    return own >= best + kMoreLikely;
  }

  const Search& search_;
  const Regression& regression_;
  const Data& data_;
  const FoundModel& found_;
  std::vector<Term> terms_;
  Term curve_;
  // Of the terms on the joint: those that the curve can be (a spring, a constant torque), and with
  // them those of its variable.
  std::vector<std::size_t> held_;
  std::vector<std::size_t> own_;
};

}  // namespace

std::optional<AnyShape> any_shape_on(Index joint, const Search& search,
                                     const Regression& regression, const FoundModel& found) {
  const Data& data = regression.data();
  if (data.recordings[0].at_rest) return std::nullopt;
  const double left = data.layout.rms(found.fit.residual)[joint];
  if (!(left > kFarAboveNoise * noise_floor_of(data, found.fit.residual)[joint]))
    return std::nullopt;
  const std::vector<StructureShare> structure = structure_of(data, found.fit.residual);
  for (const auto& effect : all_candidates()) {
    const EffectTraits& traits = effect->info().traits;
    const char* variable = name_of(traits.follows);
    if (!traits.has_any_shape || share_of(structure, joint, variable) < kFollowing) continue;
    if (has_effect(data, found.terms(), effect->kind(), joint)) continue;
    std::optional<Term> term = curve_of(data, *effect, joint);
    if (!term) continue;
    auto shape = Curve(search, regression, found, std::move(*term)).judged();
    if (shape) return shape;
  }
  return std::nullopt;
}

const EffectInfo* any_shape_over(std::string_view variable) {
  for (const EffectInfo& info : kAllEffectInfos) {
    if (info.traits.has_any_shape && name_of(info.traits.follows) == variable) return &info;
  }
  return nullptr;
}

}  // namespace offnominal::desk
