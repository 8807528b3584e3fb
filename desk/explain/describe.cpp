#include "explain/describe.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <string>

#include "common/parallel.hpp"
#include "compare/inverse_model.hpp"
#include "explain/confirm.hpp"
#include "explain/questions.hpp"
#include "explain/remainder.hpp"

namespace offnominal::desk {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

const char* effort_unit(const RobotDescription& robot, Index joint) {
  return offnominal::unit_of(Quantity::kEffort,
                             robot.joints[static_cast<std::size_t>(joint)].joint.type);
}

void describe_joints(const SearchResult& from, Explanation& to) {
  const Data& data = from.regression.data();
  const VectorXd torque = data.layout.rms(data.torque);
  const VectorXd before = data.layout.rms(data.target);
  const VectorXd fitted = data.layout.rms(from.found.baseline.residual);
  const VectorXd after = data.layout.rms(from.found.fit.residual);
  const VectorXd held_before = from.hold_out.rms(from.found.held_out_before);
  const VectorXd held_after = from.hold_out.rms(from.found.held_out_after);
  const VectorXd floor = noise_floor_of(data, from.found.fit.residual);
  const VectorXd held_floor = noise_floor_of(from.hold_out.data(), from.found.held_out_after);
  for (Index joint = 0; joint < data.layout.joint_count(); ++joint) {
    to.joints.push_back({joint, effort_unit(from.robot, joint), torque[joint], before[joint],
                         after[joint], fitted[joint], after[joint], held_before[joint],
                         held_after[joint], held_after[joint], floor[joint], held_floor[joint]});
  }
}

// Which joint's error says most of it, relative to that joint's torque: its own, or one that moves.
Index seen_on(const EffectAt& what, const VectorXd& without, const VectorXd& with,
              const VectorXd& torque, const std::vector<Excitation>& excitation) {
  Index joint = what.joint;
  const auto moves = [&](Index of) { return excitation[static_cast<std::size_t>(of)].moves; };
  for (Index other = 0; other < torque.size() && !moves(joint); ++other) {
    if (moves(other) && shows_on(what, other)) joint = other;
  }
  const auto gain = [&](Index of) {
    return torque[of] > 0 ? (without[of] - with[of]) / torque[of] : 0;
  };
  for (Index other = 0; other < torque.size(); ++other) {
    if (moves(other) && shows_on(what, other) && gain(other) > gain(joint)) joint = other;
  }
  return joint;
}

void describe_findings(const SearchResult& from, Explanation& to) {
  const Data& data = from.regression.data();
  if (from.found.accepted.empty()) return;
  const VectorXd simulated_after = simulated_position_error(data, from.found.fit.residual);
  const VectorXd held_after = from.hold_out.rms(from.found.held_out_after);
  const VectorXd torque = data.layout.rms(data.torque);
  std::vector<Finding> findings(from.found.accepted.size());
  parallel_for(findings.size(), from.search.options().threads, [&](std::size_t i) {
    const Accepted& accepted = from.found.accepted[i];
    const EffectCandidate& effect = *accepted.term.effect;
    const std::vector<Term> without = from.found.terms_without(i);
    const ModelFit fit = from.regression.fit(without);
    Finding& finding = findings[i];
    finding.what = {effect.kind(), accepted.term.joint};
    finding.words = effect.info().words;
    if (!accepted.stands_for.empty()) finding.words += "; " + accepted.stands_for;
    finding.formula = effect.info().formula;
    finding.parameters = from.sizes.numbers[i];
    finding.p_value = accepted.p;
    finding.p_replay = accepted.p_replay;
    const VectorXd held_before = from.hold_out.rms(from.hold_out.residual(without, fit));
    finding.seen_on = seen_on(finding.what, held_before, held_after, torque, to.excitation);
    finding.holdout_before = held_before[finding.seen_on];
    finding.holdout_after = held_after[finding.seen_on];
    finding.simulated_before = simulated_position_error(data, fit.residual)[finding.seen_on];
    finding.simulated_after = simulated_after[finding.seen_on];
  });
  to.found = std::move(findings);
}

void describe_suspicion(const SearchResult& from, Explanation& to) {
  const auto& suspected = from.found.suspected;
  if (!suspected) return;
  const Term& term = suspected->term;
  to.suspected = {{term.effect->kind(), term.joint}, suspected->p, suspected->share};
}

void describe_rejections(const SearchResult& from, Explanation& to) {
  const Screening screening = from.search.screen(from.found.terms(), from.found.fit);
  const Data& data = from.regression.data();
  for (const Screened& one : screening.candidates) {
    const Index joint = one.term.joint;
    // What may be there is not among what does not show.
    if (holds_in_any(to.ambiguous, {one.term.effect->kind(), joint})) continue;
    const double p = std::min(
        1.0, std::pow(10.0, -one.log10_p) * static_cast<double>(screening.candidates.size()));
    to.rejected.push_back({{one.term.effect->kind(), joint},
                           p,
                           smallest_shown(data, from.found.fit, one),
                           effort_unit(from.robot, joint)});
  }
}

// Which joints' recordings would not show what any drive may have, and what of it.
void ask_each_joint(const SearchResult& from, Explanation& to) {
  constexpr std::array kAsked{EffectKind::kViscousFriction, EffectKind::kCoulombFriction,
                              EffectKind::kTorqueOffset, EffectKind::kJointStiffness};
  constexpr double kShareOfTorque = 0.2;  // an effect of this much should not stay unseen
  const VectorXd torque = from.regression.data().layout.rms(from.regression.data().torque);
  for (const Rejection& one : to.rejected) {
    const auto joint = static_cast<std::size_t>(one.what.joint);
    Excitation& of = to.excitation[joint];
    if (to.at_rest || !of.moves) continue;
    const bool asked = std::find(kAsked.begin(), kAsked.end(), one.what.kind) != kAsked.end();
    if (!asked || one.smallest_detectable <= kShareOfTorque * torque[one.what.joint]) continue;
    of.sufficient = false;
    of.lack += fmt::format("{}{}", of.lack.empty() ? "" : ", ", one.what.name());
    if (std::isfinite(one.smallest_detectable)) {
      of.lack += fmt::format(" below {:.2g} {}", one.smallest_detectable, one.unit);
    }
  }
  for (Excitation& one : to.excitation) {
    if (one.moves && !one.sufficient) one.lack += " would not show in these recordings";
  }
}

// Where the loudest stretches of what is left are, per joint.
void describe_loud(const SearchResult& from, Explanation& to) {
  const Data& data = from.regression.data();
  if (data.recordings[0].at_rest) return;
  for (Index joint = 0; joint < data.layout.joint_count(); ++joint) {
    for (const LoudWindow& one : loud_windows(data, from.found.fit.residual, joint)) {
      to.loud.push_back({joint, one.recording, one.from_s, one.to_s});
    }
  }
}

void describe_changes(const SearchResult& from, Explanation& to) {
  std::vector<std::string> files;  // in the order of the recordings
  for (const Workspace& at : from.regression.data().recordings) {
    if (std::find(files.begin(), files.end(), at.file) == files.end()) files.push_back(at.file);
  }
  const auto place_of = [](const Term& term) { return EffectAt{term.effect->kind(), term.joint}; };
  for (const FoundChange& one : from.changes) {
    Change change;
    change.what = place_of(one.term);
    std::transform(one.alike.begin(), one.alike.end(), std::back_inserter(change.alike), place_of);
    change.recording = static_cast<std::size_t>(
        std::find_if(files.begin(), files.end(),
                     [&](const std::string& file) { return one.term.during->is_of(file); }) -
        files.begin());
    change.is_between = !one.term.during->begins();
    if (!change.is_between) change.at_s = one.term.during->from_s;
    change.at_ci95_s = one.at_s;
    if (one.until_s) {
      change.until_s = one.term.during->to_s;
      change.until_ci95_s = *one.until_s;
    }
    // How a sign is smoothed does not change.
    std::copy_if(
        one.numbers.begin(), one.numbers.end(), std::back_inserter(change.by),
        [](const Estimate& number) { return number.value.name != effects::kSmoothing.name; });
    change.p_value = one.p;
    to.changes.push_back(std::move(change));
  }
}

void describe_friction_of_file(const SearchResult& from, Explanation& to) {
  for (Index joint = 0; joint < from.regression.data().layout.joint_count(); ++joint) {
    const auto& known = from.robot.effects;
    const bool has = std::any_of(known.begin(), known.end(), [&](const RobotEffect& one) {
      return info_of(one.kind)->traits.is_friction && acts_on_joint(from.robot, one, joint);
    });
    if (!has) to.without_friction.push_back(joint);
  }
}

void describe_hold_friction(const SearchResult& from, Explanation& to) {
  const Data& data = from.regression.data();
  for (std::size_t i = 0; i < data.nuisance.terms.size(); ++i) {
    const NuisanceTerm& term = data.nuisance.terms[i];
    if (term.kind != NuisanceTerm::Kind::kApproach) continue;
    to.hold_friction.push_back({term.joint, from.found.fit.nuisance[static_cast<Index>(i)],
                                effort_unit(from.robot, term.joint)});
  }
}

// "a.csv"; "a.csv, 30 to 64 s" where not all of it was searched.
std::string name_of_recording(const Data& data, std::size_t recording) {
  const Workspace& at = data.recordings[recording];
  const auto of_file = std::count_if(data.recordings.begin(), data.recordings.end(),
                                     [&](const Workspace& one) { return one.file == at.file; });
  if (of_file == 1) return at.file;
  const VectorXd& t_s = at.motion.t_s;
  return fmt::format("{}, {:.4g} to {:.4g} s", at.file, t_s[0], t_s[t_s.size() - 1]);
}

Explanation::Series series_of(const Data& data, const VectorXd& residual, std::size_t recording) {
  const Workspace& at = data.recordings[recording];
  const Index n = data.layout.samples(recording);
  Explanation::Series series;
  series.name = name_of_recording(data, recording);
  series.t_s = kept_samples(at.plan, at.motion.t_s);
  for (MatrixXd* matrix : {&series.measured, &series.model_before, &series.model_after, &series.q,
                           &series.dq, &series.load}) {
    matrix->resize(n, data.layout.joint_count());
  }
  for (Index joint = 0; joint < data.layout.joint_count(); ++joint) {
    const Index begin = data.layout.begin(recording, joint);
    const VectorXd measured = data.torque.segment(begin, n);
    series.measured.col(joint) = measured;
    series.model_before.col(joint) = measured - data.target.segment(begin, n);
    series.model_after.col(joint) = measured - residual.segment(begin, n);
    series.q.col(joint) = kept_samples(at.plan, at.motion.q.col(joint));
    series.dq.col(joint) = kept_samples(at.plan, at.motion.dq.col(joint));
    series.load.col(joint) = kept_samples(at.plan, at.load_torque.col(joint));
  }
  return series;
}

void describe_series(const SearchResult& from, Explanation& to) {
  const Data& fitted = from.regression.data();
  for (std::size_t r = 0; r < fitted.recordings.size(); ++r) {
    to.series.push_back(series_of(fitted, from.found.fit.residual, r));
  }
  if (!from.hold_out.is_apart()) return;
  const Data& held_out = from.hold_out.data();
  const VectorXd residual = from.hold_out.residual(from.found.terms(), from.found.fit);
  for (std::size_t r = 0; r < held_out.recordings.size(); ++r) {
    to.series.push_back(series_of(held_out, residual, r));
    to.series.back().name += " (held out)";
  }
}

}  // namespace

void describe(const SearchResult& result, Explanation& to) {
  describe_joints(result, to);
  describe_findings(result, to);
  describe_suspicion(result, to);
  describe_rejections(result, to);
  ask_each_joint(result, to);
  describe_hold_friction(result, to);
  describe_loud(result, to);
  describe_changes(result, to);
  describe_friction_of_file(result, to);
  describe_series(result, to);
  to.where = structure_of(result.regression.data(), result.found.fit.residual);
  to.waterfall = result.found.waterfall;
}

}  // namespace offnominal::desk
