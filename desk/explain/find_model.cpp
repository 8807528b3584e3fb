#include "explain/find_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/parallel.hpp"
#include "explain/alternatives.hpp"
#include "explain/any_shape.hpp"
#include "explain/confirm.hpp"
#include "explain/friction_family.hpp"
#include "explain/questions.hpp"
#include "explain/replay_null.hpp"

namespace offnominal::desk {

using Eigen::Index;
using Eigen::VectorXd;

namespace {

// Share of the energy of what is held out that has to go.
constexpr double kRelevantHeldOut = 0.05;

class Finder {
 public:
  Finder(const Search& search, const Regression& regression, const HoldOut& hold_out,
         const std::vector<Excitation>& excitation, const FindOptions& options,
         const OnProgress& on_progress)
      : search_(search),
        regression_(regression),
        hold_out_(hold_out),
        excitation_(excitation),
        options_(options),
        on_progress_(on_progress),
        joints_(excitation.size()) {}

  FoundModel run() {
    found_.baseline = regression_.fit({});
    found_.fit = found_.baseline;
    found_.unsure.assign(joints_.size(), 0);
    found_.held_out_before = hold_out_.residual({}, found_.baseline);
    found_.held_out_after = found_.held_out_before;
    while (options_.most_effects > 0 && round()) {
    }
    if (options_.most_effects > 0 && add_any_shapes()) {
      while (round()) {
      }
    }
    drop_what_is_not_needed();
    if (replace_several_by_one()) drop_what_is_not_needed();
    order_and_hold_out(regression_, hold_out_, threads(), found_);
    return std::move(found_);
  }

 private:
  [[nodiscard]] bool has_room_for(std::size_t more) const {
    return static_cast<int>(found_.accepted.size() + more) <= options_.room;
  }

  // How far the search has come on one joint.
  struct OfJoint {
    std::vector<std::vector<EffectKind>> failed;  // as the model now is
    int effects = 0;
    bool done = false;
  };

  void tell(const std::string& doing) const {
    if (on_progress_) on_progress_(doing);
  }

  [[nodiscard]] int threads() const { return search_.options().threads; }

  [[nodiscard]] Fall fall_of(const ModelFit& before, const ModelFit& after) const {
    const RowLayout& layout = regression_.data().layout;
    return best_fall(of_moving(layout.rms(before.residual)), layout.rms(after.residual));
  }

  // A joint that stands while others move has no say: friction holds it, and takes whatever torque
  // that is.
  [[nodiscard]] VectorXd of_moving(VectorXd rms) const {
    const auto moves = [](const Excitation& one) { return one.moves; };
    if (std::none_of(excitation_.begin(), excitation_.end(), moves)) return rms;
    for (Index joint = 0; joint < rms.size(); ++joint) {
      if (!excitation_[static_cast<std::size_t>(joint)].moves) rms[joint] = 0;
    }
    return rms;
  }

  // By how much the log-likelihood of all joints' recordings grows.
  [[nodiscard]] double more_likely(const ModelFit& before, const ModelFit& after) const {
    const RowLayout& layout = regression_.data().layout;
    return growth_of_log_likelihood(layout.rms(before.residual), layout.rms(after.residual),
                                    after.remainder.independent_samples);
  }

  // Whether it is more than nothing to the joint's torque, and more than what effects that were
  // found before leave of themselves: each of them is a simplification of something.
  [[nodiscard]] bool matters(const Fall& fall) const {
    const Data& data = regression_.data();
    const RowLayout& layout = data.layout;
    return fall.rms >= kRelevantTorque * layout.rms(data.torque)[fall.joint] &&
           fall.rms >= kLeftOfItself * layout.rms(found_.baseline.residual)[fall.joint];
  }

  [[nodiscard]] bool relevant(const ModelFit& before, const ModelFit& after) const {
    const Fall fall = fall_of(before, after);
    const RowLayout& layout = regression_.data().layout;
    const double torque = layout.rms(regression_.data().torque)[fall.joint];
    return is_worth_a_name(fall, torque) && matters(fall);
  }

  static std::vector<EffectKind> kinds_of(const Proposal& one) {
    std::vector<EffectKind> kinds;
    for (std::size_t i = one.terms.size() - one.added; i < one.terms.size(); ++i) {
      kinds.push_back(one.terms[i].effect->kind());
    }
    return kinds;
  }

  static std::string words_of(const Proposal& one) {
    std::string words;
    for (std::size_t i = one.terms.size() - one.added; i < one.terms.size(); ++i) {
      words += (words.empty() ? "" : " and ") + std::string(one.terms[i].effect->name());
    }
    return fmt::format("{} on joint {}", words, one.terms.back().joint + 1);
  }

  // An effect with a memory must bring the simulated motion closer too.
  [[nodiscard]] bool simulates_better(const Proposal& proposal) const {
    const Data& data = regression_.data();
    const Index joint = proposal.terms.back().joint;
    return simulated_position_error(data, proposal.fit.residual)[joint] <
           simulated_position_error(data, found_.fit.residual)[joint];
  }

  // Where nothing gets a name, what comes closest is worth a word if it takes a few per cent of the
  // error away, also of what is held out on the same joint. `p`: of the whole search, where known.
  void suspect(const Proposal& one, std::optional<double> p) {
    constexpr double kLikely = 0.05;
    constexpr double kWorthAWord = 0.02;
    // Regression only screens what remembers: its columns hold the noise that they explain.
    if (!found_.accepted.empty() || one.terms.back().effect->is_only_screened()) return;
    if (one.added > 1 || !motion_of(one.terms.back()).moves) return;
    const Fall fall = fall_of(found_.fit, one.fit);
    if (fall.share < kWorthAWord || !matters(fall)) return;
    const double before = hold_out_.rms(found_.held_out_after)[fall.joint];
    const double after = hold_out_.rms(hold_out_.residual(one.terms, one.fit))[fall.joint];
    if (!(explained_share(before, after) >= kWorthAWord)) return;
    if (!p) p = search_.family_p(one, found_.fit);
    if (*p > kLikely || (found_.suspected && found_.suspected->p <= *p)) return;
    found_.suspected = {one.terms.back(), *p, fall.share};
  }

  static std::size_t joint_of(const Proposal& one) {
    return static_cast<std::size_t>(one.terms.back().joint);
  }

  // The joint whose error says most of it: its own, or of a mass one that carries it.
  [[nodiscard]] std::size_t shown_on(const Proposal& one) const {
    if (!one.terms.back().effect->is_mass()) return joint_of(one);
    return static_cast<std::size_t>(fall_of(found_.fit, one.fit).joint);
  }

  // The motion that shows a term: of its joint, or of a mass the richest of those that carry it,
  // whether the joint of its own link moves or not.
  [[nodiscard]] const Excitation& motion_of(const Term& term) const {
    const auto own = excitation_.begin() + term.joint;
    if (!term.effect->is_mass()) return *own;
    return *std::max_element(
        excitation_.begin(), own + 1, [](const Excitation& a, const Excitation& b) {
          return std::pair{a.moves, a.separation} < std::pair{b.moves, b.separation};
        });
  }

  // Every joint that is not done, with what it may lack, best first.
  [[nodiscard]] std::vector<std::vector<Proposal>> proposals_of_joints() const {
    std::vector<char> open(joints_.size(), 0);
    for (std::size_t joint = 0; joint < joints_.size(); ++joint) {
      open[joint] = static_cast<char>(!joints_[joint].done);
    }
    const std::vector<Term> terms = found_.terms();
    const Screening screening = search_.screen(terms, found_.fit);
    auto proposals = search_.propose_per_joint(terms, found_.fit, screening, open);
    put_friction_first(search_, regression_, terms, open, proposals);
    return proposals;
  }

  // What a curve of any shape leaves of its own variable is how far it is from the true shape.
  [[nodiscard]] bool is_misfit_of_a_curve(const Term& term) const {
    return std::any_of(found_.accepted.begin(), found_.accepted.end(), [&](const Accepted& one) {
      const EffectTraits& traits = one.term.effect->info().traits;
      return traits.has_any_shape && one.term.joint == term.joint &&
             traits.follows == term.effect->info().traits.follows;
    });
  }

  // The best of a joint that has not failed; null where there is none.
  [[nodiscard]] const Proposal* best_of(std::size_t joint, const std::vector<Proposal>& list) {
    for (const Proposal& one : list) {
      const auto& failed = joints_[joint].failed;
      if (std::find(failed.begin(), failed.end(), kinds_of(one)) != failed.end()) continue;
      if (!has_room_for(one.added) || !relevant(found_.fit, one.fit)) continue;
      if (!motion_of(one.terms.back()).moves) continue;
      if (is_misfit_of_a_curve(one.terms.back())) continue;
      return &one;
    }
    return nullptr;
  }

  // Several effects at once, friction of a drive with an offset, leave the turn to each of them.
  static std::size_t tries_of_one(const OfJoint& of) {
    return static_cast<std::size_t>(std::count_if(
        of.failed.begin(), of.failed.end(), [](const auto& kinds) { return kinds.size() == 1; }));
  }

  // Searches every joint that is not done; false where nothing more was found on any.
  bool round() {
    constexpr std::size_t kMostTries = 4;  // of one joint, one after the other
    tell(fmt::format("searching, {} found so far", found_.accepted.size()));
    const auto proposals = proposals_of_joints();
    while (true) {
      std::vector<const Proposal*> best;
      for (std::size_t joint = 0; joint < joints_.size(); ++joint) {
        OfJoint& of = joints_[joint];
        if (of.done) continue;
        const Proposal* one =
            tries_of_one(of) < kMostTries ? best_of(joint, proposals[joint]) : nullptr;
        if (one != nullptr) {
          best.push_back(one);
          continue;
        }
        of.done = true;
        // What fell short of relevance may still be worth a word.
        if (of.failed.empty() && !proposals[joint].empty()) {
          suspect(proposals[joint].front(), std::nullopt);
        }
      }
      if (best.empty()) return false;
      if (accept_of(std::move(best))) return true;
    }
  }

  // The terms of the model and of all of these.
  [[nodiscard]] std::vector<Term> terms_with(const std::vector<const Proposal*>& more) const {
    std::vector<Term> terms = found_.terms();
    for (const Proposal* one : more) {
      terms.insert(terms.end(), one->terms.end() - static_cast<std::ptrdiff_t>(one->added),
                   one->terms.end());
    }
    return terms;
  }

  // Accepts those of the proposals, at most one per joint, that pass; the others are set aside.
  bool accept_of(std::vector<const Proposal*> best) {
    // What makes all joints together most likely comes first: a payload looks like another torque
    // constant to each of them.
    std::stable_sort(best.begin(), best.end(), [&](const Proposal* a, const Proposal* b) {
      return more_likely(found_.fit, a->fit) > more_likely(found_.fit, b->fit);
    });
    const std::vector<Term> all = terms_with(best);
    const ModelFit fit_of_all = best.size() == 1 ? best[0]->fit : regression_.fit(all);
    const NullOfSearch null = search_.null_of(all, fit_of_all, found_.fit);
    const VectorXd held_before = hold_out_.rms(found_.held_out_after);
    const VectorXd held_of_all = hold_out_.residual(all, fit_of_all);
    bool accepted = false;
    for (const Proposal* one : best) {
      OfJoint& of = joints_[joint_of(*one)];
      Proposal now = *one;
      if (accepted) {
        // What the ones before it have taken it need not bring again.
        constexpr double kStill = 0.8;
        const double alone = fall_of(found_.fit, now.fit).share;
        now = search_.proposal_of(terms_with({one}), found_.accepted.size());
        if (!now.physical || !relevant(found_.fit, now.fit) ||
            fall_of(found_.fit, now.fit).share < kStill * alone) {
          continue;
        }
      }
      if (has_room_for(now.added) && passes(now, null, held_before, held_of_all)) {
        accepted = true;
      } else {
        of.failed.push_back(kinds_of(*one));
      }
    }
    if (!accepted) return false;
    refine_shapes();
    refit();
    return true;
  }

  // Friction that every drive has and the file has not, and that takes most of the error away, also
  // of what no fit has seen: it was not found by searching among many, so that it needs not to
  // stand out among all that a search shows. What it leaves may be the rest of a drive's friction,
  // which is no noise to hold it against. The zero of a sensor that is found together with it is as
  // common.
  // `which` of its terms, beside the fit without that one.
  [[nodiscard]] bool is_plain(const Proposal& one, std::size_t which,
                              const ModelFit& without) const {
    constexpr double kMost = 0.5;    // of the energy
    constexpr double kOwnP = 0.001;  // as the only question
    const Term& term = one.terms[which];
    const bool is_beside_friction =
        one.added > 1 && term.effect->kind() == EffectKind::kTorqueOffset;
    if (!search_.is_asked_first(term) && !is_beside_friction) return false;
    const Data& data = regression_.data();
    const Index joint = term.joint;
    const auto takes_most = [&](const VectorXd& before, const VectorXd& after) {
      return explained_share(before[joint], after[joint]) >= kMost;
    };
    if (!takes_most(data.layout.rms(without.residual), data.layout.rms(one.fit.residual))) {
      return false;
    }
    const Evidence evidence = evidence_for(Judge(without.remainder), data, term);
    if (!evidence.usable || p_of_statistic(evidence.statistic, evidence.coefficients.size(),
                                           without.remainder.blocks.count) > kOwnP) {
      return false;
    }
    std::vector<Term> others = one.terms;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(which));
    return takes_most(hold_out_.rms(hold_out_.residual(others, without)),
                      hold_out_.rms(hold_out_.residual(one.terms, one.fit)));
  }

  // `model`: what it is judged beside, where that is not what was found.
  bool passes(const Proposal& one, const NullOfSearch& null, const VectorXd& held_before,
              const VectorXd& held_of_all, const ModelFit* model = nullptr) {
    constexpr double kReplayError = 0.05;
    const std::size_t first = one.terms.size() - one.added;
    std::vector<Accepted> fresh;
    for (std::size_t i = first; i < one.terms.size(); ++i) {
      ModelFit beside;  // of several new ones each beside the others
      if (one.added > 1) {
        std::vector<Term> others = one.terms;
        others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
        beside = regression_.fit(others);
        if (!relevant(beside, one.fit)) return false;
      }
      const ModelFit& without = one.added > 1 ? beside : model != nullptr ? *model : found_.fit;
      const double p = search_.family_p(one.terms[i], without, null);
      if (p > search_.options().family_error && (model != nullptr || !is_plain(one, i, without))) {
        suspect(one, p);
        return false;
      }
      if (!shown(regression_.data(), one.terms, i, one.fit, without)
               .is_enough(motion_of(one.terms[i]), one.terms[i].effect->kind()) ||
          repeats_with_motion(regression_.data(), one.terms[i])) {
        found_.unsure[shown_on(one)] = 1;
        return false;
      }
      if (!is_more_likely_at_any_speed(regression_.data(), without, one.fit,
                                       fall_of(without, one.fit).joint)) {
        return false;
      }
      fresh.push_back({one.terms[i], p, 1});
    }
    const auto joint = static_cast<Index>(joint_of(one));
    const VectorXd held_after = hold_out_.rms(held_of_all);
    if (!(explained_share(held_before[joint], held_after[joint]) >= kRelevantHeldOut)) {
      // An effect may show on another joint than the one it acts from.
      const VectorXd alone = hold_out_.rms(hold_out_.residual(one.terms, one.fit));
      if (best_fall(of_moving(held_before), alone).share < kRelevantHeldOut) {
        suspect(one, fresh.back().p);
        return false;
      }
    }
    if (one.terms.back().effect->is_only_screened() && !simulates_better(one)) return false;
    if (options_.replays > 0) {
      tell("playing the model without " + words_of(one));
      for (Accepted& term : fresh) {
        term.p_replay =
            replay_p(regression_.data(), model != nullptr ? *model : found_.fit, one.fit.residual,
                     term.term, options_.replays, search_.options().seed, threads());
        if (term.p_replay > kReplayError) return false;
      }
    }
    // The earlier shapes are as they were: only the new terms' were refined.
    OfJoint& of = joints_[joint_of(one)];
    for (Accepted& term : fresh) {
      found_.accepted.push_back(std::move(term));
      ++of.effects;
    }
    found_.fit = one.fit;
    // What failed or was done may be right beside what is new.
    for (OfJoint& joint_state : joints_) {
      if (&joint_state == &of) joint_state.failed.clear();
      joint_state.done = joint_state.effects >= options_.most_effects;
    }
    return true;
  }

  // Curves that could stand for anything, once everything else has been tried; false where none is
  // needed. What they make superfluous leaves the model.
  bool add_any_shapes() {
    bool added = false;
    for (std::size_t joint = 0; joint < joints_.size(); ++joint) {
      const Excitation& motion = excitation_[joint];
      // What is left of any effect on a poor motion is a curve over the position.
      if (!motion.sufficient || motion.is_poor() ||
          joints_[joint].effects >= options_.most_effects) {
        continue;
      }
      auto curve = any_shape_on(static_cast<Index>(joint), search_, regression_, found_);
      if (!curve || !relevant(curve->without, curve->proposal.fit)) continue;
      if (curve->replaced.empty() && !has_room_for(1)) continue;
      const Proposal& one = curve->proposal;
      const std::size_t before = found_.accepted.size();
      const VectorXd held_before = hold_out_.rms(found_.held_out_after);
      const VectorXd held_with_it = hold_out_.residual(one.terms, one.fit);
      const NullOfSearch null = search_.null_of(one.terms, one.fit, found_.fit);
      if (!passes(one, null, held_before, held_with_it, &curve->without)) continue;
      found_.accepted.at(before).stands_for = std::move(curve->words);
      for (std::size_t i = curve->replaced.size(); i-- > 0;) {
        found_.accepted.erase(found_.accepted.begin() +
                              static_cast<std::ptrdiff_t>(curve->replaced[i]));
      }
      added = true;
      found_.held_out_after = held_with_it;
    }
    if (!added) return false;
    drop_what_is_not_needed();
    refine_shapes();
    refit();
    return true;
  }

  void refit() {
    const std::vector<Term> terms = found_.terms();
    found_.fit = regression_.fit(terms);
    found_.held_out_after = hold_out_.residual(terms, found_.fit);
  }

  // Every shape anew beside all that is in the model now, over the whole of its range: which point
  // of it was best beside fewer terms need not be now. Joints by themselves: what one has hardly
  // touches another.
  void refine_shapes() {
    const std::vector<Term> before = found_.terms();
    std::vector<std::vector<Term>> refined(joints_.size(), before);
    parallel_for(joints_.size(), threads(), [&](std::size_t joint) {
      std::vector<Term>& terms = refined[joint];
      const auto here = [&](const Term& term) {
        return static_cast<std::size_t>(term.joint) == joint;
      };
      if (std::count_if(terms.begin(), terms.end(), here) < 2) return;
      for (std::size_t i = 0; i < terms.size(); ++i) {
        if (here(terms[i])) refine_over_range(regression_, terms, i);
      }
    });
    for (std::size_t i = 0; i < before.size(); ++i) {
      found_.accepted[i].term = refined[static_cast<std::size_t>(before[i].joint)][i];
    }
  }

  // Whether what is held out is predicted better with the model than without one of its effects, by
  // as much as when it was found, on the joints that it acts on: what wide links do elsewhere
  // meanwhile is not its doing.
  [[nodiscard]] bool predicts(const Term& term, const std::vector<Term>& terms_without,
                              const ModelFit& without, const VectorXd& held_out) const {
    const Data& data = regression_.data();
    const VectorXd before = hold_out_.rms(hold_out_.residual(terms_without, without));
    VectorXd samples = VectorXd::Zero(before.size());
    const ActingColumns acting(data.layout, columns_of(data, term));
    double most = 0;  // what it takes off the error of a joint
    for (const ActingColumns::Span& span : acting.spans()) {
      samples[span.joint] = found_.fit.remainder.independent_samples[span.joint];
      most = std::max(most, explained_share(before[span.joint], held_out[span.joint]));
    }
    return most >= kRelevantHeldOut && growth_of_log_likelihood(before, held_out, samples) > 0;
  }

  // Every accepted effect must still be needed beside all others, and predict what is held out:
  // what came later may have taken over from it. The one that is needed least goes first.
  void drop_what_is_not_needed() {
    if (found_.accepted.size() < 2) return;
    tell("trying to do without each effect again");
    while (found_.accepted.size() > 1) {
      std::vector<double> shares(found_.accepted.size());
      std::vector<char> needed(shares.size());
      const VectorXd held_out = hold_out_.rms(hold_out_.residual(found_.terms(), found_.fit));
      parallel_for(shares.size(), threads(), [&](std::size_t i) {
        const std::vector<Term> terms = found_.terms_without(i);
        const ModelFit without = regression_.fit(terms);
        shares[i] = fall_of(without, found_.fit).share;
        needed[i] = static_cast<char>(relevant(without, found_.fit) &&
                                      predicts(found_.accepted[i].term, terms, without, held_out));
      });
      std::size_t least = shares.size();
      for (std::size_t i = 0; i < shares.size(); ++i) {
        if (needed[i] == 0 && (least == shares.size() || shares[i] < shares[least])) least = i;
      }
      if (least == shares.size()) return;
      found_.accepted.erase(found_.accepted.begin() + static_cast<std::ptrdiff_t>(least));
      found_.fit = regression_.fit(found_.terms());
    }
  }

  [[nodiscard]] std::vector<Accepted> accepted_elsewhere(std::size_t joint) const {
    std::vector<Accepted> elsewhere = found_.accepted;
    std::erase_if(elsewhere, [&](const Accepted& one) {
      return static_cast<std::size_t>(one.term.joint) == joint;
    });
    return elsewhere;
  }

  // One effect that describes a joint as well as all that were found on it, one after the other,
  // is the simpler answer: a first one that was only close leaves what a second one then takes.
  // Not of the friction that every drive has, which is there.
  bool replace_several_by_one() {
    constexpr std::size_t kMostTries = 8;
    bool replaced = false;
    for (std::size_t joint = 0; joint < joints_.size(); ++joint) {
      const std::vector<Accepted> all = found_.accepted;
      std::vector<Accepted> elsewhere = accepted_elsewhere(joint);
      if (all.size() < elsewhere.size() + 2) continue;
      const auto of_every_drive = std::count_if(all.begin(), all.end(), [&](const Accepted& one) {
        return static_cast<std::size_t>(one.term.joint) == joint &&
               one.term.effect->info().traits.every_drive_has;
      });
      if (of_every_drive == static_cast<std::ptrdiff_t>(all.size() - elsewhere.size())) continue;
      tell(fmt::format("trying a single effect on joint {}", joint + 1));
      const ModelFit several = found_.fit;
      const VectorXd held_of_several = hold_out_.residual(found_.terms(), several);
      found_.accepted = std::move(elsewhere);
      refit();
      if (accept_instead(joint, several, held_of_several, of_every_drive > 0, kMostTries)) {
        replaced = true;
        continue;
      }
      found_.accepted = all;
      found_.fit = several;
      found_.held_out_after = held_of_several;
    }
    return replaced;
  }

  // Takes the best effect on a joint that is as good as `several`; false where there is none.
  // `own_friction`: the joint's own is among them, and no other joint's motion takes its place.
  bool accept_instead(std::size_t joint, const ModelFit& several, const VectorXd& held_of_several,
                      bool own_friction, std::size_t most_tries) {
    constexpr double kAsWell = 1.1;
    const Data& data = regression_.data();
    std::vector<char> open(joints_.size(), 0);
    open[joint] = 1;
    const std::vector<Term> terms = found_.terms();
    const auto proposals =
        search_.propose_per_joint(terms, found_.fit, search_.screen(terms, found_.fit), open);
    std::size_t tries = 0;
    for (const Proposal& one : proposals[joint]) {
      const EffectInfo& info = one.terms.back().effect->info();
      if (one.added > 1 || info.traits.has_any_shape) continue;
      if (own_friction && info.find(Quantity::kJointNumber) != nullptr) continue;
      if (++tries > most_tries) break;
      // Within chance, and not within what its formula simplifies: that may be the other ones.
      if (!as_good(data, several, one.fit, 0)) continue;
      const NullOfSearch null = search_.null_of(one.terms, one.fit, found_.fit);
      VectorXd held_out = hold_out_.residual(one.terms, one.fit);
      // What several predict clearly better is no chance.
      const auto which = static_cast<Index>(joint);
      if (hold_out_.rms(held_out)[which] > kAsWell * hold_out_.rms(held_of_several)[which])
        continue;
      if (passes(one, null, hold_out_.rms(found_.held_out_after), held_out)) {
        found_.held_out_after = std::move(held_out);
        return true;
      }
    }
    return false;
  }

  const Search& search_;
  const Regression& regression_;
  const HoldOut& hold_out_;
  const std::vector<Excitation>& excitation_;
  const FindOptions& options_;
  const OnProgress& on_progress_;
  std::vector<OfJoint> joints_;
  FoundModel found_;
};

}  // namespace

FoundModel find_model(const Search& search, const Regression& regression, const HoldOut& hold_out,
                      const std::vector<Excitation>& excitation, const FindOptions& options,
                      const OnProgress& on_progress) {
  return Finder(search, regression, hold_out, excitation, options, on_progress).run();
}

}  // namespace offnominal::desk
