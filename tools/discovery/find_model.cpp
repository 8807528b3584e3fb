#include "discovery/find_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "discovery/alternatives.hpp"
#include "discovery/confirm.hpp"
#include "discovery/replay_null.hpp"

namespace offnominal::tools::discovery {

using Eigen::Index;
using Eigen::VectorXd;

std::vector<Term> FoundModel::terms() const {
  std::vector<Term> terms;
  for (const Accepted& one : accepted) terms.push_back(one.term);
  return terms;
}

std::vector<Term> FoundModel::terms_without(std::size_t left_out) const {
  std::vector<Term> others = terms();
  others.erase(others.begin() + static_cast<std::ptrdiff_t>(left_out));
  return others;
}

namespace {

void hold_out_anew(const Regression& regression, const HoldOut& hold_out, FoundModel& found) {
  found.held_out.resize(1);
  std::vector<Term> first;
  for (const Accepted& one : found.accepted) {
    first.push_back(one.term);
    found.held_out.push_back(hold_out.residual(first, regression.fit(first)));
  }
}

}  // namespace

void leave_out(std::size_t which, const Regression& regression, const HoldOut& hold_out,
               FoundModel& found) {
  found.accepted.erase(found.accepted.begin() + static_cast<std::ptrdiff_t>(which));
  found.fit = regression.fit(found.terms());
  hold_out_anew(regression, hold_out, found);
}

namespace {

// Share of the energy of what is held out that has to go.
constexpr double kRelevantHeldOut = 0.05;

// What goes of an error on the joint where the largest share of its energy goes.
struct Fall {
  Index joint = 0;
  double share = -1;  // of the energy
  double rms = 0;     // of what goes
};

Fall best_fall(const VectorXd& before, const VectorXd& after) {
  Fall best;
  for (Index joint = 0; joint < before.size(); ++joint) {
    if (!(before[joint] > 0)) continue;
    const double share = explained_share(before[joint], after[joint]);
    if (share > best.share) best = {joint, share, before[joint] * std::sqrt(std::max(0.0, share))};
  }
  return best;
}

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
        on_progress_(on_progress) {}

  FoundModel run() {
    found_.baseline = regression_.fit({});
    found_.fit = found_.baseline;
    found_.held_out = {hold_out_.residual({}, found_.baseline)};
    while (found_.accepted.size() < static_cast<std::size_t>(options_.most_effects) && add_one()) {
    }
    drop_what_is_not_needed();
    order_by_size();
    return std::move(found_);
  }

 private:
  void tell(const std::string& doing) const {
    if (on_progress_) on_progress_(doing);
  }

  [[nodiscard]] Fall fall_of(const ModelFit& before, const ModelFit& after) const {
    const RowLayout& layout = regression_.data().layout;
    return best_fall(layout.rms(before.residual), layout.rms(after.residual));
  }

  // Whether it is more than nothing to the joint's torque.
  [[nodiscard]] bool matters(const Fall& fall) const {
    const Data& data = regression_.data();
    return fall.rms >= kRelevantTorque * data.layout.rms(data.torque)[fall.joint];
  }

  [[nodiscard]] bool relevant(const ModelFit& before, const ModelFit& after) const {
    const Fall fall = fall_of(before, after);
    return fall.share >= kRelevantShare && matters(fall);
  }

  // An effect with a memory must bring the simulated motion closer too.
  [[nodiscard]] bool simulates_better(const Proposal& proposal) const {
    const Data& data = regression_.data();
    const Index joint = proposal.terms.back().joint;
    return simulated_position_error(data, proposal.fit.residual)[joint] <
           simulated_position_error(data, found_.fit.residual)[joint];
  }

  [[nodiscard]] double played_p(const Proposal& proposal) const {
    if (options_.replays == 0) return 1;
    tell(fmt::format("playing the model without {}", proposal.terms.back().effect->name()));
    return replay_p(regression_.data(), found_.fit, proposal.fit.residual, proposal.terms.back(),
                    options_.replays, search_.options().seed, search_.options().threads);
  }

  // Where nothing gets a name, what comes closest is worth a word if it takes a few per cent of the
  // error away, also of what is held out on the same joint. `p`: of the whole search, where known.
  void suspect(const Proposal& one, std::optional<double> p) {
    constexpr double kLikely = 0.05;
    constexpr double kWorthAWord = 0.02;
    // Regression only screens what remembers: its columns hold the noise that they explain.
    if (!found_.accepted.empty() || one.terms.back().effect->is_only_screened()) return;
    if (!all_sufficient(excitation_)) return;
    const Fall fall = fall_of(found_.fit, one.fit);
    if (fall.share < kWorthAWord || !matters(fall)) return;
    const double before = hold_out_.rms(found_.held_out.back())[fall.joint];
    const double after = hold_out_.rms(hold_out_.residual(one.terms, one.fit))[fall.joint];
    if (explained_share(before, after) < kWorthAWord) return;
    if (!p) p = search_.family_p(one, found_.fit);
    if (*p <= kLikely) found_.suspected = {one.terms.back(), *p, fall.share};
  }

  bool add_one() {
    constexpr double kReplayError = 0.05;
    tell(fmt::format("searching for effect {}", found_.accepted.size() + 1));
    const std::vector<Term> terms = found_.terms();
    const Screening screening = search_.screen(terms, found_.fit);
    const std::vector<Proposal> proposals = search_.propose(terms, found_.fit, screening);
    const auto best_relevant =
        std::find_if(proposals.begin(), proposals.end(),
                     [this](const Proposal& one) { return relevant(found_.fit, one.fit); });
    if (best_relevant == proposals.end()) {
      if (!proposals.empty()) suspect(proposals.front(), std::nullopt);
      return false;
    }
    const Proposal& best = *best_relevant;
    const Term& term = best.terms.back();
    const Data& data = regression_.data();
    if (!shows(data, excitation_[static_cast<std::size_t>(term.joint)], term)) return false;
    const double p = search_.family_p(best, found_.fit);
    if (p > search_.options().family_error) {
      suspect(best, p);
      return false;
    }
    const VectorXd residual = hold_out_.residual(best.terms, best.fit);
    const VectorXd before = hold_out_.rms(found_.held_out.back());
    if (best_fall(before, hold_out_.rms(residual)).share < kRelevantHeldOut) {
      suspect(best, p);
      return false;
    }
    if (term.effect->is_only_screened() && !simulates_better(best)) return false;
    const double p_replay = played_p(best);
    if (options_.replays > 0 && p_replay > kReplayError) return false;
    // The earlier shapes are as they were: only the new term's was refined.
    found_.accepted.push_back({term, p, p_replay});
    found_.fit = best.fit;
    found_.held_out.push_back(residual);
    return true;
  }

  // Every accepted effect must still be needed beside the later ones.
  void drop_what_is_not_needed() {
    for (std::size_t i = 0; i + 1 < found_.accepted.size();) {
      tell("trying to do without each effect again");
      if (relevant(regression_.fit(found_.terms_without(i)), found_.fit)) {
        ++i;
      } else {
        leave_out(i, regression_, hold_out_, found_);
      }
    }
  }

  // Largest first: of what is left each time, the effect that takes most away.
  void order_by_size() {
    if (found_.accepted.size() < 2) return;
    std::vector<Accepted> open = std::exchange(found_.accepted, {});
    Remainder left = found_.baseline.remainder;
    while (!open.empty()) {
      auto best = open.begin();
      double most = -1;
      for (auto one = open.begin(); one != open.end(); ++one) {
        const Evidence evidence = judge(left, columns_of(regression_.data(), one->term));
        if (!evidence.usable || evidence.gain <= most) continue;
        most = evidence.gain;
        best = one;
      }
      found_.accepted.push_back(std::move(*best));
      open.erase(best);
      found_.fit = regression_.fit(found_.terms());
      left = found_.fit.remainder;
    }
    hold_out_anew(regression_, hold_out_, found_);
  }

  const Search& search_;
  const Regression& regression_;
  const HoldOut& hold_out_;
  const std::vector<Excitation>& excitation_;
  const FindOptions& options_;
  const OnProgress& on_progress_;
  FoundModel found_;
};

}  // namespace

FoundModel find_model(const Search& search, const Regression& regression, const HoldOut& hold_out,
                      const std::vector<Excitation>& excitation, const FindOptions& options,
                      const OnProgress& on_progress) {
  return Finder(search, regression, hold_out, excitation, options, on_progress).run();
}

}  // namespace offnominal::tools::discovery
