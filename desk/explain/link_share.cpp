#include "explain/link_share.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "common/parallel.hpp"
#include "explain/excitation.hpp"
#include "explain/friction_family.hpp"
#include "explain/questions.hpp"

namespace offnominal::desk {

using Eigen::Index;
using Eigen::VectorXd;

namespace {

// Beyond CAD, far beyond it, little more than the geometry known, and a guess of the masses.
constexpr std::array kShares{0.12, 0.3, 0.6, 1.0};
constexpr double kUnknownShare = 2;
// Log-likelihood that a wider share has to gain, and the share of a joint's error.
constexpr double kClearly = 10;
constexpr double kRelevantFall = 0.05;
// Of a joint's torque: what less is said for one mass that is wrong.
constexpr double kLittleOfTorque = 0.01;

// How much more likely the errors that are left make the data, the largest fall of one, and whether
// those of most joints fall (links are off all over an arm) or that of any rises.
struct ShareGain {
  double log_likelihood = 0;
  double fall = 0;
  bool on_most = false;
  bool one_rises = false;
};

ShareGain gain_of(const VectorXd& before, const VectorXd& after, const VectorXd& samples) {
  constexpr double kClearChange = 0.1;
  ShareGain gain{growth_of_log_likelihood(before, after, samples), 0, false, false};
  int joints = 0;
  int fallen = 0;
  for (Index joint = 0; joint < before.size(); ++joint) {
    if (!(before[joint] > 0) || !(samples[joint] > 0)) continue;
    const double fall = 1 - after[joint] / before[joint];
    gain.fall = std::max(gain.fall, fall);
    ++joints;
    if (fall > kClearChange) ++fallen;
    if (fall < -kClearChange) gain.one_rises = true;
  }
  gain.on_most = 2 * fallen > joints;
  return gain;
}

// Of each joint, 0 of those that do not move: friction holds them at any torque within it, and wide
// links would follow that.
VectorXd samples_of_moving(const Data& data, VectorXd samples) {
  for (Index joint = 0; joint < samples.size(); ++joint) {
    if (!moves(data.recordings, joint)) samples[joint] = 0;
  }
  return samples;
}

struct ErrorsBeside {
  VectorXd rms;
  VectorXd samples;  // independent ones, per joint
};

ErrorsBeside held_out_of(const Data& data) {
  const Regression regression(data);
  std::vector<Term> terms = standard_friction(data);
  add_payload(regression, terms);
  const ModelFit fit = regression.fit(terms);
  const HoldOut parts(regression, nullptr);
  return {parts.rms(parts.residual(terms, fit)),
          samples_of_moving(data, fit.remainder.independent_samples)};
}

// Accepted effects that are a mass at a place, a torque constant that is off by no more than is
// fitted beside wide links, and the others.
struct Counted {
  std::size_t masses = 0;
  std::size_t constants = 0;
  std::size_t others = 0;
};

Counted counted(const FoundModel& found) {
  Counted count;
  for (std::size_t i = 0; i < found.accepted.size(); ++i) {
    const EffectCandidate& effect = *found.accepted[i].term.effect;
    if (effect.is_mass()) {
      ++count.masses;
    } else if (effect.is_torque_constant() &&
               std::abs(found.fit.coefficients[i][0]) <= kUsualConstantShare) {
      ++count.constants;
    } else {
      ++count.others;
    }
  }
  return count;
}

// Whether the mass of a link, or what is carried, is in the usual model where the wide one has
// links that are off everywhere, and nothing else more.
bool one_mass_explains(const FoundModel& wide, const FoundModel& usual) {
  return counted(usual).masses > counted(wide).masses &&
         counted(usual).others <= counted(wide).others;
}

// What is in one model and not in the other.
std::vector<const Accepted*> not_in(const FoundModel& one, const FoundModel& other) {
  std::vector<const Accepted*> missing;
  for (const Accepted& here : one.accepted) {
    const bool there =
        std::any_of(other.accepted.begin(), other.accepted.end(), [&](const Accepted& accepted) {
          return accepted.term.effect->kind() == here.term.effect->kind() &&
                 accepted.term.joint == here.term.joint;
        });
    if (!there) missing.push_back(&here);
  }
  return missing;
}

// Whether the wide model only adds to what the usual one names, or has taken masses into its links
// at the price of another joint: wider links blur the numbers of all else.
bool tells_no_better(const FoundModel& wide, const FoundModel& usual, const ShareGain& gain) {
  const auto lost = not_in(usual, wide);
  if (lost.empty()) return true;
  const bool only_masses = std::all_of(
      lost.begin(), lost.end(), [](const Accepted* one) { return one->term.effect->is_mass(); });
  return only_masses && gain.one_rises && not_in(wide, usual).empty();
}

}  // namespace

void add_payload(const Regression& regression, std::vector<Term>& terms) {
  const Data& data = regression.data();
  const Index last = data.layout.joint_count() - 1;
  if (data.recordings[0].knows(EffectKind::kTipPayload, last)) return;
  Term payload = first_on_grid(data, EffectKind::kTipPayload, last);
  const auto searched = std::count_if(payload.ranges.begin(), payload.ranges.end(),
                                      [](const ShapeRange& one) { return one.is_searched(); });
  if (searched < 3) return;
  terms.push_back(std::move(payload));
  refine_over_range(regression, terms, terms.size() - 1);
}

NuisanceOptions with_link_share(NuisanceOptions options, double share) {
  options.link_share = share;
  options.link_geometry = share > kCadShare;
  options.torque_constant = options.link_geometry ? kUsualConstantShare : 0;
  return options;
}

NuisanceOptions beside_wider_links(NuisanceOptions options) {
  if (options.link_geometry) {
    const auto* const wider = std::upper_bound(kShares.begin(), kShares.end(), options.link_share);
    options.link_share = wider == kShares.end() ? kUnknownShare : *wider;
  } else {
    options.link_share = std::max(options.link_share, kCadShare);
    options.link_geometry = true;
  }
  return options;
}

NuisanceOptions beside_unknown_links(NuisanceOptions options) {
  options.link_share = kUnknownShare;
  options.link_geometry = true;
  return options;
}

std::vector<double> wider_link_shares(const RobotDescription& robot, const Data& data,
                                      const NuisanceOptions& usual, int threads) {
  std::array<ErrorsBeside, 1 + kShares.size()> held;
  parallel_for(held.size(), threads, [&](std::size_t i) {
    if (i == 0) {
      held[i] = held_out_of(data);
      return;
    }
    held[i] = held_out_of(Data(data, robot, with_link_share(usual, kShares[i - 1])));
  });
  std::size_t best = 0;
  for (std::size_t i = 1; i < held.size(); ++i) {
    const ShareGain gain = gain_of(held[best].rms, held[i].rms, held[i].samples);
    if (gain.log_likelihood >= kClearly && gain.fall >= kRelevantFall) best = i;
  }
  return {kShares.begin(), kShares.begin() + static_cast<std::ptrdiff_t>(best)};
}

bool is_clearly_better(const HoldOut& hold_out, const FoundModel& wide, const FoundModel& usual,
                       bool both_wide) {
  const VectorXd after = hold_out.rms(wide.held_out_after);
  const VectorXd before = hold_out.rms(usual.held_out_after);
  const VectorXd samples =
      samples_of_moving(hold_out.data(), wide.fit.remainder.independent_samples);
  const ShareGain gain = gain_of(before, after, samples);
  if (gain.log_likelihood > kClearly && gain.fall > kRelevantFall) {
    const VectorXd torque = hold_out.data().layout.rms(hold_out.data().torque);
    const bool is_little =
        (samples.array() <= 0 || (before - after).array() < kLittleOfTorque * torque.array()).all();
    if (!is_little) return true;
    return both_wide ? gain.on_most || !tells_no_better(wide, usual, gain)
                     : !one_mass_explains(wide, usual);
  }
  constexpr std::size_t kManyEffects = 3;
  return gain.log_likelihood > -kClearly &&
         usual.accepted.size() - counted(usual).constants >= wide.accepted.size() + kManyEffects;
}

}  // namespace offnominal::desk
