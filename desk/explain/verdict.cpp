#include "explain/verdict.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "common/amount.hpp"
#include "compare/before_after.hpp"
#include "compare/inverse_model.hpp"
#include "explain/any_shape.hpp"
#include "explain/change_words.hpp"
#include "explain/explain_report.hpp"
#include "explain/found_model.hpp"
#include "explain/link_share.hpp"
#include "explain/list_of_joints.hpp"

namespace offnominal::desk {
namespace {

// What is left counts as structure where it stands this far above the noise floor ...
constexpr double kAboveNoise = 1.5;
// ... and this share of it follows a variable on time that was not fitted.
constexpr double kStructured = 0.15;
// What stands above its noise and is more than this share of the torque is not explained, whatever
// it follows.
constexpr double kShareOfTorque = 0.02;
// A push or another event: this share of the energy is in a tenth of the time.
constexpr double kConcentrated = 0.5;
// ... unless this much follows a variable of the joint.
constexpr double kFollowsState = 0.4;

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

constexpr const char* kMorePositions = "hold it at more positions, approached from both sides";

std::string at_joint(Eigen::Index joint) { return fmt::format("joint {}", joint + 1); }

std::string words_of(const Finding& finding) {
  return fmt::format("{} on {}", title_of(finding), at_joint(finding.what.joint));
}

// "viscous_friction on joints 1, 2, rotor_inertia on joint 2": six joints that lack the same things
// are no list of eighteen.
std::string words_of(const std::vector<const Finding*>& findings) {
  std::vector<std::pair<std::string, std::vector<Index>>> by_title;
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

// What is left stands above the noise floor, and is worth a word.
bool stands_out(const JointErrors& joint) {
  return joint.rms_after > kAboveNoise * joint.noise_floor &&
         joint.rms_after >= kRelevantTorque * joint.rms_torque;
}

// The joint where what is left stands furthest above the noise floor, and is worth a name; null
// where none does.
const JointErrors* above_noise(const Explanation& e) {
  const JointErrors* loudest = nullptr;
  double worst = 0;
  for (const JointErrors& joint : e.joints) {
    if (!stands_out(joint) || !(joint.rms_after > worst * joint.noise_floor)) continue;
    worst = joint.rms_after / joint.noise_floor;
    loudest = &joint;
  }
  return loudest;
}

// The variable that what is left of a joint follows; null for noise.
const StructureShare* structure_on(const Explanation& e, const JointErrors& joint) {
  const StructureShare* state = nullptr;
  const StructureShare* time = nullptr;
  if (!stands_out(joint)) return nullptr;
  for (const StructureShare& share : e.where) {  // largest first
    if (share.joint != joint.joint) continue;
    const bool of_time = share.variable == "time";
    if (of_time && share.share >= kConcentrated) time = &share;
    if (!of_time && share.share >= kStructured && state == nullptr) state = &share;
  }
  if (time != nullptr && (state == nullptr || state->share < kFollowsState)) return time;
  return state;
}

const JointErrors& errors_of(const Explanation& e, Eigen::Index joint) {
  return *std::find_if(e.joints.begin(), e.joints.end(),
                       [&](const JointErrors& one) { return one.joint == joint; });
}

Remains remains_of(const Explanation& e, const JointErrors& joint) {
  Remains left;
  left.rms = joint.rms_after;
  left.share_of_torque = joint.rms_torque > 0 ? joint.rms_after / joint.rms_torque : 0;
  left.times_noise = joint.noise_floor > 0 ? joint.rms_after / joint.noise_floor : 0;
  const StructureShare* follows = structure_on(e, joint);
  if (follows == nullptr) return left;
  left.follows = follows->variable;
  left.share = follows->share;
  if (left.follows != "time") return left;
  std::copy_if(e.loud.begin(), e.loud.end(), std::back_inserter(left.when),
               [&](const LoudSpan& one) { return one.joint == joint.joint; });
  return left;
}

// "in recording 1 from 3.2 to 4.1 s"; the first few.
std::string words_of_times(const std::vector<LoudSpan>& when) {
  constexpr std::size_t kMost = 4;
  std::vector<std::string> spans;
  for (std::size_t i = 0; i < std::min(kMost, when.size()); ++i) {
    spans.push_back(fmt::format("{:.1f} to {:.1f} s of recording {}", when[i].from_s, when[i].to_s,
                                when[i].recording + 1));
  }
  std::string words = fmt::format("{}", fmt::join(spans, ", "));
  if (when.size() > kMost) words += fmt::format(" and {} more", when.size() - kMost);
  return words;
}

std::string words_of(const Remains& left, const std::string& unit) {
  std::string words =
      fmt::format("{:.3g} {}, {} % of the torque and {:.1f} times the noise", left.rms, unit,
                  significant(100 * left.share_of_torque, 2), left.times_noise);
  if (left.follows.empty()) return words + ", follows nothing that was looked at";
  if (left.follows != "time") {
    return words + fmt::format(", follows its {} by {:.0f} %", left.follows, 100 * left.share);
  }
  words += ", comes in a few stretches of time";
  return left.when.empty() ? words : words + ": " + words_of_times(left.when);
}

// "a torque over position of a shape that no known effect has; joint_stiffness is 60 % of it".
std::string words_of(const OverVariable& shape) {
  std::vector<std::string> names;
  for (const EffectAt& one : shape.stand_ins) names.emplace_back(one.name());
  if (names.empty()) {
    return fmt::format("a torque over {} of a shape that no known effect has beside what was found",
                       shape.variable);
  }
  return fmt::format(
      "a torque over {} of a shape that no known effect has; {} {} {:.0f} % of what such a torque "
      "takes",
      shape.variable, fmt::join(names, " and "), names.size() == 1 ? "is" : "are",
      100 * std::max(0.0, shape.share));
}

std::string words_of_place(const EffectAt& one) {
  return fmt::format("{} on {}", one.name(), at_joint(one.joint));
}

void advise_on_classes(Explanation& e) {
  for (const auto& same : e.ambiguous) {
    std::vector<std::string> all;
    for (const EffectAt& one : same) {
      all.push_back(fmt::format("{}@{}", one.name(), one.joint + 1));
    }
    if (e.at_rest) {
      e.advice.push_back(fmt::format("to tell them apart, {}", kMorePositions));
      continue;
    }
    const bool alone = same.size() == 1;
    e.advice.push_back(fmt::format(
        "to tell {} from {}: {}; `offnominal motion --robot {} --{} {} -o motion.csv` writes such "
        "a motion",
        words_of_place(same[0]), alone ? kOwnNumbers : words_of_place(same[1]),
        info_of(same[0].kind)->motion_hint, e.robot_file, alone ? "excite" : "separate",
        fmt::join(all, ",")));
  }
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

// Whether the new robot file has all that was found of a joint.
bool is_all_written(const Explanation& e, Eigen::Index joint) {
  return std::all_of(e.found.begin(), e.found.end(), [&](const Finding& one) {
    return one.what.joint != joint || is_written(e, one.what);
  });
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

std::vector<std::string> names_of(const std::vector<EffectAt>& effects, Eigen::Index joint) {
  std::vector<std::string> names;
  std::transform(effects.begin(), effects.end(), std::back_inserter(names),
                 [&](const EffectAt& one) { return name_seen_from(joint, one); });
  return names;
}

// How much of the torque the model explains before and after: as the new file has it, or where that
// lacks what was found, as it would with it.
std::string words_of_gain(const JointErrors& errors, bool is_in_the_file) {
  if (!(errors.rms_torque > 0)) return "";
  const double before = 100 * errors.rms_before / errors.rms_torque;
  const double left = is_in_the_file ? errors.rms_improved : errors.rms_after;
  const double after = 100 * left / errors.rms_torque;
  constexpr double kSame = 0.02;
  if (std::abs(left - errors.rms_before) <= kSame * errors.rms_before) {
    return fmt::format(" The joint's own error stays at {:.3g} {}, {} % of the torque.", left,
                       errors.unit, significant(after, 2));
  }
  const bool falls = left <= errors.rms_before;
  const char* goes = is_in_the_file ? (falls ? "falls" : "rises")
                     : falls        ? "would fall"
                                    : "would rise";
  return fmt::format(" The error {} from {:.3g} to {:.3g} {}, {} to {} % of the torque.", goes,
                     errors.rms_before, left, errors.unit, significant(before, 2),
                     significant(after, 2));
}

JointAnswer judge_joint(const Explanation& e, const JointErrors& errors) {
  JointAnswer answer;
  answer.joint = errors.joint;
  answer.left = remains_of(e, errors);
  for (const Finding& one : e.found) {
    if (one.what.joint == errors.joint) answer.found.push_back(one.what);
  }
  for (const auto& same : e.ambiguous) {
    if (same.front().joint == errors.joint) answer.ambiguous.push_back(same);
  }
  const auto which = static_cast<std::size_t>(errors.joint);
  const bool poor = which < e.excitation.size() && !e.excitation[which].sufficient;
  const bool unsure = std::find(e.unsure.begin(), e.unsure.end(), errors.joint) != e.unsure.end();
  const bool stands = which < e.excitation.size() && !e.excitation[which].moves;
  std::vector<std::string> shapes;
  for (const OverVariable& one : e.over_variable) {
    if (one.joint == errors.joint) shapes.push_back(words_of(one));
  }
  std::vector<std::string> shifts;
  for (const Shift& one : e.shifts) {
    if (one.joint == errors.joint) shifts.push_back(words_of(one));
  }
  const bool known = std::all_of(answer.found.begin(), answer.found.end(), [](const EffectAt& one) {
    return info_of(one.kind)->is_known_quantity();
  });
  std::vector<EffectAt> sure = answer.found;
  std::erase_if(sure, [&](const EffectAt& one) { return holds_in_any(answer.ambiguous, one); });
  const bool far = stands_out(errors) && errors.rms_after > kShareOfTorque * errors.rms_torque;
  const bool unknown = !answer.left.follows.empty() || far || !shapes.empty();
  if (!answer.ambiguous.empty() || !answer.found.empty()) {
    answer.verdict = !answer.ambiguous.empty() ? Verdict::kAmbiguous
                     : known                   ? Verdict::kParameterShift
                                               : Verdict::kFound;
    if (!sure.empty())
      answer.words = fmt::format("{}.", fmt::join(names_of(sure, errors.joint), ", "));
    for (const auto& same : answer.ambiguous) {
      auto names = names_of(same, errors.joint);
      if (may_be_own_numbers(e, same)) names.emplace_back(kOwnNumbers);
      answer.words += fmt::format("{}{} cannot be told apart.", answer.words.empty() ? "" : " ",
                                  fmt::join(names, " or "));
    }
    if (!shifts.empty()) answer.words += fmt::format(" {}.", fmt::join(shifts, ", "));
    answer.words +=
        words_of_gain(errors, is_all_written(e, errors.joint) && answer.ambiguous.empty());
  } else if (!shifts.empty() && !stands) {
    answer.verdict = Verdict::kParameterShift;
    answer.words = fmt::format("{}.", fmt::join(shifts, ", ")) + words_of_gain(errors, true);
  } else if (unsure) {
    answer.verdict = Verdict::kNotExcited;
    answer.words =
        "something shows, and these recordings do not tell it from the model's own numbers.";
  } else if (unknown && !stands) {
    const bool state = !answer.left.follows.empty() && answer.left.follows != "time";
    answer.verdict =
        state || !shapes.empty() ? Verdict::kUnknownStateDependent : Verdict::kUnknownExternal;
    answer.words = "none of the known effects.";
  } else if (poor) {
    answer.verdict = Verdict::kNotExcited;
    answer.words = e.excitation[which].lack + ".";
  } else if (e.suspected && e.suspected->what.joint == errors.joint) {
    answer.verdict = Verdict::kNotExcited;
    answer.words = fmt::format("{} may hide in the noise.", e.suspected->what.name());
  } else if (gains_by_links(e, errors)) {
    answer.verdict = Verdict::kParameterShift;
    const char* const drives = e.torque_constants.empty() ? "" : ", or torque constants";
    answer.words = fmt::format("masses, centres of mass or inertias of the links{}.{}", drives,
                               words_of_gain(errors, true));
  } else {
    std::vector<EffectAt> carried;
    for (const Finding& one : e.found) {
      if (shows_on(one.what, errors.joint)) carried.push_back(one.what);
    }
    const bool gains =
        !carried.empty() && rises(errors.rms_improved, errors.rms_before, errors.rms_torque);
    answer.words = gains ? fmt::format("nothing is missing but {}.",
                                       fmt::join(names_of(carried, errors.joint), ", ")) +
                               words_of_gain(errors, true)
                         : "no known effect is missing.";
  }
  if (const auto changes = changes_on(e, errors.joint); !changes.empty()) {
    const bool alone = answer.verdict == Verdict::kExplained;
    if (alone) answer.verdict = Verdict::kChanged;
    answer.words = fmt::format("{}changes{}: {}.", alone ? "" : answer.words + " It ",
                               e.changes_between ? "" : " in the middle", words_of(changes));
  }
  for (const std::string& shape : shapes) answer.words += fmt::format(" It has {}.", shape);
  const char* left = stands_out(errors) ? " What is left: " : "";
  if (*left != '\0') answer.words += left + words_of(answer.left, errors.unit) + ".";
  return answer;
}

// Of a joint whose samples are all left out.
JointAnswer lost_joint(const JointErrors& errors) {
  JointAnswer answer;
  answer.joint = errors.joint;
  answer.verdict = Verdict::kNotExcited;
  answer.words = "nothing is left of its recordings that is free of faults.";
  return answer;
}

// Those that matter most first: by the share of their torque that was missing.
void judge_joints(Explanation& e) {
  e.answers.clear();
  for (const JointErrors& joint : e.joints) {
    // What is searched may be all at fault where the rest is not.
    const bool none_searched =
        joint.rms_before > 0 && !(joint.rms_fitted_before > 0) && !(joint.rms_after > 0);
    const bool lost = !std::isfinite(joint.rms_torque) || none_searched;
    e.answers.push_back(lost ? lost_joint(joint) : judge_joint(e, joint));
  }
  const auto share = [&](const JointAnswer& one) {
    const JointErrors& errors = errors_of(e, one.joint);
    return errors.rms_torque > 0 ? errors.rms_before / errors.rms_torque : 0;
  };
  std::stable_sort(e.answers.begin(), e.answers.end(),
                   [&](const JointAnswer& a, const JointAnswer& b) { return share(a) > share(b); });
}

// Links of which a file says so little are better sought by themselves.
constexpr double kHardlyKnown = 0.5;

// Joints most of whose torque nothing explains.
std::vector<Eigen::Index> hardly_explained(const Explanation& e) {
  constexpr double kMost = 0.5;
  std::vector<Eigen::Index> joints;
  for (const JointAnswer& one : e.answers) {
    const JointErrors& errors = errors_of(e, one.joint);
    if (one.verdict == Verdict::kUnknownStateDependent &&
        errors.rms_after > kMost * errors.rms_torque) {
      joints.push_back(one.joint);
    }
  }
  std::sort(joints.begin(), joints.end());
  return joints;
}

// How far the links were let off the file, where the recordings said so, or why they were not.
void advise_on_links(Explanation& e) {
  if (!e.links_kept_for.empty() && changes_the_file(e)) {
    std::vector<Eigen::Index> joints;
    for (const Eigen::Index joint : e.links_kept_for) joints.push_back(joint + 1);
    e.advice.push_back(fmt::format(
        "the links stay as the robot file has them: with other masses and inertias the error of "
        "joint {}, where nothing was found, would rise on data that were not fitted; "
        "`--link-share {:g}` fits them all the same",
        fmt::join(joints, ", "), e.link_share));
  }
  if (e.link_share_judged) {
    e.advice.push_back(fmt::format(
        "the links' masses, centres of mass and inertias{} are off the file by more than CAD "
        "usually is: they were fitted within {:.0f} % of it, which predicts time that was not "
        "fitted better; `--link-share 0.05` holds them{}",
        e.torque_constants.empty() ? "" : ", or the torque constants,", 100 * e.link_share,
        e.link_share < kHardlyKnown
            ? ""
            : ", and `offnominal identify` with these recordings finds them from the geometry "
              "alone: explain again with the file that it writes"));
  }
  const std::vector<Eigen::Index> hardly = hardly_explained(e);
  const bool said = e.link_share_judged && e.link_share >= kHardlyKnown;
  if (!hardly.empty() && !said && !e.at_rest) {
    e.advice.push_back(fmt::format(
        "nothing explains most of the torque of {}: where the file's masses are a guess, "
        "`offnominal identify` with these recordings finds the links from the geometry alone, and "
        "its error on what is held out tells whether they are what is missing",
        list_of_joints(hardly)));
  }
  if (e.torque_constants.empty()) return;
  std::vector<std::string> constants;
  for (const FittedConstant& one : e.torque_constants) {
    constants.push_back(fmt::format("joint {} {:+.1f} %", one.joint + 1, 100 * one.error));
  }
  e.advice.push_back(fmt::format(
      "torque constants were fitted beside the links, within {:.0f} %, and are written with them: "
      "{}; what is below that gets no name",
      100 * kUsualConstantShare, fmt::join(constants, ", ")));
}

// A file without any friction on a joint, in one sentence.
void advise_on_friction(Explanation& e) {
  if (e.without_friction.empty() || e.at_rest) return;
  std::vector<std::string> joints;
  for (const Eigen::Index joint : e.without_friction) joints.push_back(std::to_string(joint + 1));
  e.advice.push_back(fmt::format(
      "the robot file has no friction on joint {}, and every drive has some: `[[effect]]` with "
      "kind = \"coulomb_friction\" and one with kind = \"viscous_friction\" per joint, `fitted = "
      "true`, is where to begin",
      fmt::join(joints, ", ")));
}

// What a motor's own friction does shows on all joints that it moves, and is not looked for.
void advise_on_motors(Explanation& e) {
  const RobotDescription& robot = e.improved;
  if (!robot.transmission || e.at_rest) return;
  const auto is_open = [&](const MovedJoint& moved) {
    return std::any_of(e.answers.begin(), e.answers.end(), [&](const JointAnswer& one) {
      return one.joint == moved.joint && one.verdict != Verdict::kExplained &&
             one.verdict != Verdict::kFound && one.verdict != Verdict::kNotExcited;
    });
  };
  for (std::size_t motor = 0; motor < robot.joints.size(); ++motor) {
    const std::vector<MovedJoint> moved = joints_of_motor(robot, motor);
    const bool has_own =
        std::any_of(robot.effects.begin(), robot.effects.end(), [&](const RobotEffect& one) {
          return one.of_motor && one.joint == motor && info_of(one.kind)->traits.every_drive_has;
        });
    if (moved.size() < 2 || has_own || std::none_of(moved.begin(), moved.end(), is_open)) continue;
    std::vector<std::string> joints;
    for (const MovedJoint& one : moved) joints.push_back(std::to_string(one.joint + 1));
    e.advice.push_back(fmt::format(
        "joints {} share motor {}, whose own friction shows on each of them and is not looked for: "
        "`offnominal add coulomb_friction viscous_friction --motor {}` with these recordings fits "
        "it, then explain again",
        fmt::join(joints, " and "), motor + 1, motor + 1));
  }
}

// A torque over a variable that no other effect describes can be in the model as a curve.
void advise_on_shapes(Explanation& e) {
  for (const JointAnswer& one : e.answers) {
    std::string variable = one.left.follows;
    for (const OverVariable& shape : e.over_variable) {
      if (shape.joint == one.joint) variable = shape.variable;
    }
    const EffectInfo* curve = any_shape_over(variable);
    if (curve == nullptr || holds(one.found, {curve->kind, one.joint})) continue;
    const auto& known = e.improved.effects;
    const bool has = std::any_of(known.begin(), known.end(), [&](const RobotEffect& effect) {
      return effect.kind == curve->kind && acts_on_joint(e.improved, effect, one.joint);
    });
    if (has) continue;
    e.advice.push_back(fmt::format(
        "joint {}: `offnominal add {} --joint {} --robot {} --log LOG -o improved.toml` puts it "
        "into the model as {}",
        one.joint + 1, curve->name, one.joint + 1, e.robot_file, curve->words));
  }
}

// What is left beside what was found.
void advise_on_rest(Explanation& e) {
  for (const JointAnswer& one : e.answers) {
    const JointErrors& errors = errors_of(e, one.joint);
    const bool answered =
        one.verdict == Verdict::kUnknownExternal || one.verdict == Verdict::kUnknownStateDependent;
    if ((e.verdict == one.verdict && answered) || !stands_out(errors)) continue;
    if (one.left.follows.empty()) continue;
    e.advice.push_back(
        fmt::format("joint {}: what is left, {}", one.joint + 1, words_of(one.left, errors.unit)));
  }
}

// Empty where there are none.
std::string sentence_on_pushes(const Explanation& e) {
  if (e.pushes.empty()) return "";
  std::vector<std::string> all;
  std::transform(e.pushes.begin(), e.pushes.end(), std::back_inserter(all),
                 [](const Push& one) { return words_of(one); });
  return fmt::format("Something pushes the arm from outside: {}.", fmt::join(all, "; "));
}

}  // namespace

void judge_whole(Explanation& e) {
  e.advice.clear();
  e.answers.clear();
  std::optional<Suspicion> suspected = std::exchange(e.suspected, std::nullopt);
  if (!e.data_faults.empty()) {
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
    return;
  }
  bool poor = !all_sufficient(e.excitation);
  // What stands above the noise without following anything is told as such.
  if (suspected && !poor && above_noise(e) == nullptr) e.suspected = suspected;
  judge_joints(e);
  poor = std::any_of(e.answers.begin(), e.answers.end(), [&](const JointAnswer& one) {
    return one.verdict == Verdict::kNotExcited &&
           !(e.suspected && e.suspected->what.joint == one.joint);
  });
  for (std::size_t joint = 0; joint < e.excitation.size(); ++joint) {
    const Excitation& one = e.excitation[joint];
    const auto answer = std::find_if(
        e.answers.begin(), e.answers.end(),
        [&](const JointAnswer& of) { return of.joint == static_cast<Eigen::Index>(joint); });
    const bool answered = answer != e.answers.end() && answer->verdict != Verdict::kNotExcited;
    if (one.sufficient || answered) continue;
    e.advice.push_back(fmt::format("joint {}: {}", joint + 1, one.lack));
  }
  advise_on_links(e);
  advise_on_friction(e);
  advise_on_motors(e);
  const JointAnswer* unknown = worst_unknown(e);
  const std::string pushes = sentence_on_pushes(e);
  const auto shift = std::find_if(e.answers.begin(), e.answers.end(), [](const JointAnswer& one) {
    return one.verdict == Verdict::kParameterShift;
  });
  if (!e.ambiguous.empty()) {
    judge_ambiguous(e);
  } else if (!e.found.empty()) {
    judge_found(e);
  } else if (unknown != nullptr) {
    judge_unknown(*unknown, e);
  } else if (shift != e.answers.end()) {
    e.verdict = Verdict::kParameterShift;
    e.words = "A known quantity has another value: " + shift->words;
  } else if (!e.changes.empty()) {
    e.verdict = Verdict::kChanged;
    e.words = sentence_on_changes(e);
  } else if (!pushes.empty()) {
    e.verdict = Verdict::kUnknownExternal;
    e.words = pushes;
  } else if (poor) {
    e.verdict = Verdict::kNotExcited;
    e.words = e.unsure.empty()
                  ? "These motions excite too little to judge the model by them."
                  : fmt::format(
                        "Something shows on {} that these recordings do not tell from the "
                        "model's own numbers.",
                        at_joint(e.unsure.front()));
    e.advice.emplace_back(
        e.at_rest ? kMorePositions
                  : fmt::format("`offnominal motion --robot {} -o motion.csv` writes a motion that "
                                "excites what the robot may have",
                                e.robot_file));
  } else if (e.suspected) {
    judge_suspected(*e.suspected, e);
  } else {
    const JointErrors* loudest = above_noise(e);
    e.verdict = Verdict::kExplained;
    e.words =
        loudest == nullptr
            ? "The model explains these recordings: what is left is noise, or less than a "
              "thousandth of the torque, and no known effect is missing." +
                  words_of_detectable(e)
            : fmt::format(
                  "No known effect stands out. What is left on {} stands {:.1f} times above the "
                  "noise, and follows nothing that was looked at.",
                  at_joint(loudest->joint), loudest->rms_after / loudest->noise_floor);
  }
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
