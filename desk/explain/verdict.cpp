#include "explain/verdict.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "common/list_of_joints.hpp"
#include "compare/before_after.hpp"
#include "explain/advice.hpp"
#include "explain/change_words.hpp"
#include "explain/explain_report.hpp"
#include "explain/joint_answers.hpp"
#include "explain/remains.hpp"

namespace offnominal::desk {
namespace {

struct VerdictRow {
  Verdict verdict;
  const char* name;
  report::Level level;  // of its page
  bool to_write;
};
constexpr std::array<VerdictRow, 9> kVerdicts = {{
    {Verdict::kExplained, "explained", report::Level::kGood, false},
    {Verdict::kFound, "found", report::Level::kGood, true},
    {Verdict::kAmbiguous, "ambiguous", report::Level::kWarn, false},
    {Verdict::kParameterShift, "parameter_shift", report::Level::kWarn, true},
    {Verdict::kUnknownStateDependent, "unknown_state_dependent", report::Level::kBad, false},
    {Verdict::kUnknownExternal, "unknown_external", report::Level::kBad, false},
    {Verdict::kNotExcited, "not_excited", report::Level::kWarn, false},
    {Verdict::kChanged, "changed", report::Level::kWarn, false},
    {Verdict::kDataFault, "data_fault", report::Level::kBad, false},
}};

const VerdictRow& row_of(Verdict verdict) {
  return *std::find_if(kVerdicts.begin(), kVerdicts.end(),
                       [&](const VerdictRow& row) { return row.verdict == verdict; });
}

std::string words_of(const Finding& finding) {
  return fmt::format("{} on {}", title_of(finding), at_joint(finding.what.joint));
}

// "viscous_friction on joints 1, 2, rotor_inertia on joint 2": six joints that lack the same things
// are no list of eighteen.
std::string words_of(const std::vector<const Finding*>& findings) {
  std::vector<std::pair<std::string, std::vector<Eigen::Index>>> by_title;
  for (const Finding* one : findings) {
    const std::string title = title_of(*one);
    auto same = std::find_if(by_title.begin(), by_title.end(),
                             [&](const auto& other) { return other.first == title; });
    if (same == by_title.end()) same = by_title.insert(by_title.end(), {title, {}});
    same->second.push_back(one->what.joint);
  }
  std::vector<std::string> words;
  for (auto& [title, joints] : by_title) {
    std::sort(joints.begin(), joints.end());
    words.push_back(fmt::format("{} on {}", title, list_of_joints(joints)));
  }
  return fmt::format("{}", fmt::join(words, ", "));
}

void judge_ambiguous(Explanation& e) {
  e.verdict = Verdict::kAmbiguous;
  std::vector<std::string> possible;
  for (const EffectAt& one : e.ambiguous[0]) {
    possible.push_back(words_of_place(one));
  }
  std::vector<const Finding*> sure;
  for (const Finding& finding : e.found) {
    if (!holds_in_any(e.ambiguous, finding.what)) sure.push_back(&finding);
  }
  const std::string missing = sure.empty() ? "" : fmt::format("Missing: {}. ", words_of(sure));
  if (may_be_own_numbers(e, e.ambiguous[0])) {
    e.words = fmt::format("{}Something {}, and these recordings cannot tell what: {}, or {}.",
                          missing, sure.empty() ? "shows" : "else shows too",
                          fmt::join(possible, ", or "), kOwnNumbers);
  } else {
    e.words = fmt::format("{}Something {} missing{}, but these recordings cannot tell which: {}.",
                          missing, sure.empty() ? "is" : "else is", sure.empty() ? "" : " too",
                          fmt::join(possible, ", or "));
  }
  advise_on_classes(e);
}

// By how much the robot file that is written predicts a joint better, as the table has it.
std::string words_of_held_out(const Explanation& e, const Finding& finding) {
  const JointErrors& errors = errors_of(e, finding.seen_on);
  const double after =
      is_all_written(e, finding.what.joint) ? errors.holdout_after : errors.holdout_fitted;
  if (!(errors.holdout_before > 0)) return "";
  const double fall = 1 - after / errors.holdout_before;
  const std::string joint =
      finding.seen_on == finding.what.joint ? "that joint" : at_joint(finding.seen_on);
  return fmt::format(": the error on held-out data of {} {} by {:.0f} %", joint,
                     fall < 0 ? "rises" : "falls", 100 * std::abs(fall));
}

void judge_found(Explanation& e) {
  const bool shift = std::all_of(e.found.begin(), e.found.end(), [](const Finding& f) {
    return info_of(f.what.kind)->is_known_quantity();
  });
  e.verdict = shift ? Verdict::kParameterShift : Verdict::kFound;
  const Finding& first = e.found.front();
  e.words = fmt::format("{} {} ({}){}.",
                        shift ? "Another value of a known quantity:" : "Missing:", words_of(first),
                        first.words, words_of_held_out(e, first));
  if (e.found.size() == 1) return;
  std::vector<const Finding*> others;
  std::transform(e.found.begin() + 1, e.found.end(), std::back_inserter(others),
                 [](const Finding& one) { return &one; });
  e.words += fmt::format(" Also: {}.", words_of(others));
}

// The joint whose unknown part matters most; null where there is none.
const JointAnswer* worst_unknown(const Explanation& e) {
  const auto worst = std::find_if(e.answers.begin(), e.answers.end(), [](const JointAnswer& one) {
    return one.verdict == Verdict::kUnknownExternal ||
           one.verdict == Verdict::kUnknownStateDependent;
  });
  return worst == e.answers.end() ? nullptr : &*worst;
}

void judge_unknown(const JointAnswer& worst, Explanation& e) {
  e.verdict = worst.verdict;
  const bool external = worst.verdict == Verdict::kUnknownExternal;
  const std::string does =
      external && worst.left.follows == "time"
          ? "comes in a few stretches of time" +
                (worst.left.when.empty() ? std::string()
                                         : " (" + words_of_times(worst.left.when) + ")")
      : worst.left.follows.empty() ? "follows nothing that was looked at"
                                   : "follows its " + worst.left.follows;
  e.words = fmt::format(
      "Something acts on {} that is none of the known effects: the error stands {:.1f} times above "
      "the noise and {}.",
      at_joint(worst.joint), worst.left.times_noise, does);
  const auto shape =
      std::find_if(e.over_variable.begin(), e.over_variable.end(),
                   [&](const OverVariable& one) { return one.joint == worst.joint; });
  if (shape != e.over_variable.end()) {
    e.words += fmt::format(" It is {}.", words_of(*shape));
  }
  e.advice.push_back(external ? "look at the recording at these times: contact, a cable, a person"
                              : "see the map of the error over " + (shape != e.over_variable.end()
                                                                        ? shape->variable
                                                                        : worst.left.follows));
}

// How small an effect cannot be named, beyond what the model's own numbers take up: a sentence.
std::string words_of_detectable(const Explanation& e) {
  double least = std::numeric_limits<double>::infinity();
  double most = 0;
  for (const Rejection& one : e.rejected) {
    const double torque = e.joints[static_cast<std::size_t>(one.what.joint)].rms_torque;
    if (!(torque > 0) || !std::isfinite(one.smallest_detectable)) continue;
    least = std::min(least, 100 * one.smallest_detectable / torque);
    most = std::max(most, 100 * one.smallest_detectable / torque);
  }
  if (!(most > 0)) return "";
  const std::string low = fmt::format("{:.2g}", least);
  const std::string high = fmt::format("{:.2g}", most);
  return fmt::format(" No effect below {} % of a joint's torque can be named by them.",
                     low == high ? low : low + " to " + high);
}

// Something is there, and what it is cannot be said: noise, or an effect that this motion shows
// weakly.
void judge_suspected(const Suspicion& one, Explanation& e) {
  e.verdict = Verdict::kNotExcited;
  e.words = fmt::format(
      "No effect stands out enough to be named, yet chance alone is unlikely (p = {:.2g} over the "
      "whole search): {} on {} would explain {:.0f} % of a joint's squared error.",
      one.p_value, one.what.name(), at_joint(one.what.joint), 100 * one.share);
  e.advice.push_back(
      e.at_rest
          ? kMorePositions
          : fmt::format("`offnominal motion --robot {} --excite {}@{} -o motion.csv` writes a "
                        "motion that shows it if it is there; a longer recording helps too",
                        e.robot_file, one.what.name(), one.what.joint + 1));
}

}  // namespace

const char* name_of(Verdict verdict) { return row_of(verdict).name; }

std::string words_of(const Shift& shift) {
  const char* blank = shift.unit.empty() || shift.unit == "1" ? "" : " ";
  return fmt::format("{} is {:.3g}{}{}, not {:.3g}", shift.name, shift.came, blank,
                     *blank == '\0' ? "" : shift.unit, shift.file);
}

bool may_be_own_numbers(const Explanation& e, const std::vector<EffectAt>& same) {
  return same.size() == 1 || std::any_of(same.begin(), same.end(), [&](const EffectAt& one) {
           return holds(e.or_links, one);
         });
}

bool is_written(const Explanation& e, const EffectAt& finding) {
  return !holds_in_any(e.ambiguous, finding) && !holds_what_cannot_be(e.held, finding.joint);
}

bool gains_by_links(const Explanation& e, const JointErrors& joint) {
  constexpr double kHalf = 0.5;
  if (!e.link_share_judged || !all_sufficient(e.excitation)) return false;
  const bool another_loses = std::any_of(e.joints.begin(), e.joints.end(), [](const auto& one) {
    return rises(one.holdout_before, one.holdout_after, one.rms_torque);
  });
  return !another_loses && joint.holdout_after <= kHalf * joint.holdout_before &&
         rises(joint.holdout_after, joint.holdout_before, joint.rms_torque);
}

bool gains_by_links(const Explanation& e) {
  return std::any_of(e.joints.begin(), e.joints.end(),
                     [&](const JointErrors& joint) { return gains_by_links(e, joint); });
}

bool changes_the_file(const Explanation& e) {
  return !e.shifts.empty() || gains_by_links(e) ||
         std::any_of(e.found.begin(), e.found.end(),
                     [&](const Finding& one) { return is_written(e, one.what); });
}

bool is_to_write(Verdict verdict) { return row_of(verdict).to_write; }

report::Level level_of(Verdict verdict) { return row_of(verdict).level; }

std::vector<std::string> verdict_names() {
  std::vector<std::string> names;
  for (const VerdictRow& row : kVerdicts) names.emplace_back(row.name);
  return names;
}

std::string name_seen_from(Eigen::Index joint, const EffectAt& one) {
  return one.joint == joint ? std::string(one.name())
                            : fmt::format("{} of {}", one.name(), at_joint(one.joint));
}

bool shows_on(const EffectAt& one, Eigen::Index joint) {
  const bool is_mass = info_of(one.kind)->action == EffectAction::kPointMass;
  return one.joint == joint || (is_mass && joint < one.joint);
}

bool holds(const std::vector<EffectAt>& effects, const EffectAt& one) {
  return std::find(effects.begin(), effects.end(), one) != effects.end();
}

bool holds_in_any(const std::vector<std::vector<EffectAt>>& classes, const EffectAt& one) {
  return std::any_of(classes.begin(), classes.end(),
                     [&](const auto& same) { return holds(same, one); });
}

std::string title_of(const Finding& finding) {
  const ParameterInfo* order = info_of(finding.what.kind)->find(Quantity::kCyclesPerPosition);
  for (const Estimate& one : finding.parameters) {
    if (order != nullptr && one.value.name == order->name) {
      return fmt::format("{} of {} {:.4g}", finding.what.name(), order->name, one.value.value);
    }
  }
  return std::string(finding.what.name());
}

namespace {

// Empty where there are none.
std::string sentence_on_pushes(const Explanation& e) {
  if (e.pushes.empty()) return "";
  std::vector<std::string> all;
  std::transform(e.pushes.begin(), e.pushes.end(), std::back_inserter(all),
                 [](const Push& one) { return words_of(one); });
  return fmt::format("Something pushes the arm from outside: {}.", fmt::join(all, "; "));
}

// A recording at fault, or a file that is not its robot's, tells nothing of effects.
void judge_data_faults(Explanation& e) {
  e.verdict = Verdict::kDataFault;
  const bool of_file = e.data_faults[0].kind == DataFaultKind::kGravity ||
                       e.data_faults[0].kind == DataFaultKind::kJointZero;
  e.words = (of_file ? "The robot file is not of this recording: "
                     : "The recording itself is at fault: ") +
            e.data_faults[0].words + ".";
  for (const DataFault& fault : e.data_faults) e.advice.push_back(fault.mend);
  e.found.clear();
  e.ambiguous.clear();
  e.over_variable.clear();
  e.changes.clear();
  e.pushes.clear();
  e.waterfall.resize(std::min<std::size_t>(1, e.waterfall.size()));
}

// Some joint's motion is too poor to judge it by, other than by what may hide in its noise.
bool moves_too_little(const Explanation& e) {
  return std::any_of(e.answers.begin(), e.answers.end(), [&](const JointAnswer& one) {
    return one.verdict == Verdict::kNotExcited &&
           !(e.suspected && e.suspected->what.joint == one.joint);
  });
}

void judge_poor_motion(Explanation& e) {
  e.verdict = Verdict::kNotExcited;
  e.words = e.unsure.empty() ? "These motions excite too little to judge the model by them."
                             : fmt::format(
                                   "Something shows on {} that these recordings do not tell from "
                                   "the model's own numbers.",
                                   at_joint(e.unsure.front()));
  e.advice.emplace_back(
      e.at_rest ? kMorePositions
                : fmt::format("`offnominal motion --robot {} -o motion.csv` writes a motion that "
                              "excites what the robot may have",
                              e.robot_file));
}

void judge_explained(Explanation& e) {
  const JointErrors* loudest = above_noise(e);
  e.verdict = Verdict::kExplained;
  e.words = loudest == nullptr
                ? "The model explains these recordings: what is left is noise, or less than a "
                  "thousandth of the torque, and no known effect is missing." +
                      words_of_detectable(e)
                : fmt::format(
                      "No known effect stands out. What is left on {} stands {:.1f} times above "
                      "the noise, and follows nothing that was looked at.",
                      at_joint(loudest->joint), loudest->rms_after / loudest->noise_floor);
}

// A joint that stands still, and whose error is so large a share of its torque that nothing of the
// others comes near: what holds it matters more than what they leave. Null where there is none.
const JointErrors* held_with_error(const Explanation& e) {
  constexpr double kShare = 0.05;
  constexpr double kTimes = 3;
  const auto share_of = [](const JointErrors& one) {
    return one.rms_torque > 0 ? one.rms_before / one.rms_torque : 0.0;
  };
  const JointErrors* held = nullptr;
  double of_others = kShare / kTimes;
  for (const JointErrors& one : e.joints) {
    const auto joint = static_cast<std::size_t>(one.joint);
    const bool stands = joint < e.excitation.size() && !e.excitation[joint].moves;
    if (!stands) {
      of_others = std::max(of_others, share_of(one));
    } else if (held == nullptr || share_of(one) > share_of(*held)) {
      held = &one;
    }
  }
  return held != nullptr && share_of(*held) > kTimes * of_others ? held : nullptr;
}

std::string words_of_held(const JointErrors& held) {
  return fmt::format(
      "The largest error is that of {}, {:.3g} {} or {:.2g} % of its torque, and it does not move "
      "here: something holds or loads it, or its model is off, and a joint that stands does not "
      "say which. ",
      at_joint(held.joint), held.rms_before, held.unit, 100 * held.rms_before / held.rms_torque);
}

// By what matters most of the joints' answers.
void judge_by_joints(const std::string& pushes, Explanation& e) {
  const JointAnswer* unknown = worst_unknown(e);
  const auto shift = std::find_if(e.answers.begin(), e.answers.end(), [](const JointAnswer& one) {
    return one.verdict == Verdict::kParameterShift;
  });
  if (!e.ambiguous.empty()) {
    judge_ambiguous(e);
  } else if (!e.found.empty()) {
    judge_found(e);
  } else if (unknown != nullptr) {
    judge_unknown(*unknown, e);
    const JointErrors* held = e.at_rest ? nullptr : held_with_error(e);
    if (held != nullptr) e.words.insert(0, words_of_held(*held));
  } else if (shift != e.answers.end()) {
    e.verdict = Verdict::kParameterShift;
    e.words = "A known quantity has another value: " + shift->words;
  } else if (!e.changes.empty()) {
    e.verdict = Verdict::kChanged;
    e.words = sentence_on_changes(e);
  } else if (!pushes.empty()) {
    e.verdict = Verdict::kUnknownExternal;
    e.words = pushes;
  } else if (moves_too_little(e)) {
    judge_poor_motion(e);
  } else if (e.suspected) {
    judge_suspected(*e.suspected, e);
  } else {
    judge_explained(e);
  }
}

}  // namespace

void judge_whole(Explanation& e) {
  e.advice.clear();
  e.answers.clear();
  std::optional<Suspicion> suspected = std::exchange(e.suspected, std::nullopt);
  if (!e.data_faults.empty()) {
    judge_data_faults(e);
    return;
  }
  // What stands above the noise without following anything is told as such.
  if (suspected && all_sufficient(e.excitation) && above_noise(e) == nullptr) {
    e.suspected = suspected;
  }
  judge_joints(e);
  advise_on_motion(e);
  advise_on_links(e);
  advise_on_friction(e);
  advise_on_motors(e);
  const std::string pushes = sentence_on_pushes(e);
  judge_by_joints(pushes, e);
  if (!pushes.empty()) {
    if (e.words != pushes) e.words += " " + pushes;
    e.advice.emplace_back(
        "look at the recording at the times of the pushes: contact, a cable, a person");
  }
  const std::string changes = sentence_on_changes(e);
  if (e.verdict != Verdict::kChanged && !changes.empty()) e.words += " " + changes;
  advise_on_changes(e);
  advise_on_rest(e);
  advise_on_shapes(e);
}

}  // namespace offnominal::desk
