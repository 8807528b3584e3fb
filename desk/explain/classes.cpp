#include "explain/classes.hpp"

#include <algorithm>
#include <cstddef>

#include "common/parallel.hpp"
#include "explain/alternatives.hpp"
#include "explain/friction_family.hpp"
#include "explain/questions.hpp"

namespace offnominal::desk {

using Eigen::Index;
using Eigen::VectorXd;

namespace {

class Classes {
 public:
  Classes(const SearchSetting& setting, const std::vector<Excitation>& excitation)
      : setting_(setting), excitation_(excitation) {}

  [[nodiscard]] std::vector<std::vector<EffectAt>> of(FoundModel& found) const {
    constexpr std::size_t kMostAlike = 4;
    std::vector<std::vector<EffectAt>> classes;
    std::vector<Asked> asked = all_asked(found, {});
    for (std::size_t i = found.accepted.size(); i-- > 0;) {
      if (i > 0 && asked[i].same.size() > kMostAlike) {
        const VectorXd touched = torque_energy(found, i);
        found.accepted.erase(found.accepted.begin() + static_cast<std::ptrdiff_t>(i));
        order_and_hold_out(*setting_.regression, *setting_.hold_out, threads(), found);
        // Another order, and on the joints that it acted on other companions: there all are asked
        // anew. On the others what is left is as it was.
        std::erase_if(asked, [&](const Asked& one) { return touched[one.term.joint] > 0; });
        asked = all_asked(found, asked);
        classes.clear();
        i = found.accepted.size();
      } else if (asked[i].same.size() > 1) {
        classes.insert(classes.begin(), asked[i].same);
      }
    }
    return classes;
  }

 private:
  // An effect that was found, and what it could just as well be.
  struct Asked {
    Term term;
    std::vector<EffectAt> same;
  };

  // Per joint, of the torque of one that was found.
  [[nodiscard]] VectorXd torque_energy(const FoundModel& found, std::size_t i) const {
    const RowLayout& layout = setting_.data->layout;
    const VectorXd torque =
        columns_of(*setting_.data, found.accepted[i].term) * found.fit.coefficients[i];
    return layout.energy(layout.weighted(torque, found.fit.joint_weights));
  }

  // Every effect that was found, in their order, asked unless it has been already.
  [[nodiscard]] std::vector<Asked> all_asked(const FoundModel& found,
                                             const std::vector<Asked>& known) const {
    std::vector<Asked> asked(found.accepted.size());
    parallel_for(asked.size(), threads(), [&](std::size_t i) {
      const Term& term = found.accepted[i].term;
      const auto before = std::find_if(known.begin(), known.end(), [&](const Asked& one) {
        return one.term.effect == term.effect && one.term.joint == term.joint &&
               one.term.shape == term.shape;
      });
      asked[i] = before != known.end() ? *before : Asked{term, alike(found, i)};
    });
    return asked;
  }

  // An effect that was found, and what describes the recordings as well in its place.
  [[nodiscard]] std::vector<EffectAt> alike(const FoundModel& found, std::size_t i) const {
    const Term& mine = found.accepted[i].term;
    const std::vector<Term> others = found.terms_without(i);
    const ModelFit beside = setting_.regression->fit(others);
    const double own =
        weighted_energy(*setting_.data, mine, found.fit.coefficients[i], found.fit.joint_weights);
    Screening screening = setting_.search->screen(others, beside);
    // What takes far less than the best does not come as close as noise would let it.
    constexpr double kNear = 0.25;
    double most = 0;
    for (const Screened& one : screening.candidates) most = std::max(most, one.evidence.gain);
    std::erase_if(screening.candidates,
                  [&](const Screened& one) { return one.evidence.gain < kNear * most; });
    std::vector<EffectAt> same{{mine.effect->kind(), mine.joint}};
    for (const Proposal& other : setting_.search->propose(others, beside, screening)) {
      const Term& term = other.terms.back();
      const EffectAt name{term.effect->kind(), term.joint};
      const double energy =
          std::max(own, weighted_energy(*setting_.data, term, other.fit.coefficients.back(),
                                        found.fit.joint_weights));
      if (name == same[0] || repeats_with_motion(*setting_.data, term) ||
          !takes_its_place(beside, found.fit, other.fit) ||
          !as_good(*setting_.data, found.fit, other.fit, energy) ||
          is_nested(*setting_.data, found.baseline, mine, term) ||
          is_refuted_by_simpler(*setting_.data, mine, found.fit, term, other.fit)) {
        continue;
      }
      same.push_back(name);
    }
    const EffectTraits& traits = mine.effect->info().traits;
    const bool is_curve = traits.has_any_shape && traits.follows == EffectVariable::kPosition;
    const bool is_poor = excitation_[static_cast<std::size_t>(mine.joint)].is_poor();
    // Friction that every drive has and the file lacks is there: such a ripple, which on a poor
    // motion is any curve, would only be beside it.
    if (is_curve || (is_poor && !traits.every_drive_has)) {
      add_slow_ripples(found, mine, others, own, same);
    }
    return same;
  }

  // Whether another model takes at least half of what the chosen one takes, on the joint where that
  // is most: an offset of the torso is no friction of the elbow, however few samples that is worth.
  [[nodiscard]] bool takes_its_place(const ModelFit& without, const ModelFit& chosen,
                                     const ModelFit& other) const {
    constexpr double kOfIt = 0.5;
    const RowLayout& layout = setting_.data->layout;
    const auto energy_of = [&](const ModelFit& fit) {
      return layout.energy(layout.weighted(fit.residual, chosen.joint_weights));
    };
    const VectorXd before = energy_of(without);
    const VectorXd taken = before - energy_of(chosen);
    Index most = 0;
    taken.maxCoeff(&most);
    return (before - energy_of(other))[most] >= kOfIt * taken[most];
  }

  // Ripples slower than the range: a rich motion tells them from an offset or a spring, or has
  // none; a curve of any shape may be one on any motion.
  void add_slow_ripples(const FoundModel& found, const Term& mine, const std::vector<Term>& others,
                        double energy, std::vector<EffectAt>& same) const {
    for (const Term& ripple : slow_ripples(*setting_.data, mine.joint)) {
      std::vector<Term> terms = others;
      terms.push_back(ripple);
      const EffectAt name{ripple.effect->kind(), ripple.joint};
      if (!holds(same, name) &&
          as_good(*setting_.data, found.fit, setting_.regression->fit(terms), energy)) {
        same.push_back(name);
      }
    }
  }

  [[nodiscard]] int threads() const { return setting_.search->options().threads; }

  const SearchSetting& setting_;
  const std::vector<Excitation>& excitation_;
};

}  // namespace

std::vector<std::vector<EffectAt>> classes_of(const SearchSetting& setting,
                                              const std::vector<Excitation>& excitation,
                                              FoundModel& found) {
  return Classes(setting, excitation).of(found);
}

}  // namespace offnominal::desk
