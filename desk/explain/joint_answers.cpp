#include "explain/joint_answers.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "common/amount.hpp"
#include "compare/before_after.hpp"
#include "explain/change_words.hpp"
#include "explain/remains.hpp"

namespace offnominal::desk {

bool is_all_written(const Explanation& e, Eigen::Index joint) {
  return std::all_of(e.found.begin(), e.found.end(), [&](const Finding& one) {
    return one.what.joint != joint || is_written(e, one.what);
  });
}

namespace {

// What stands above its noise and is more than this share of the torque is not explained, whatever
// it follows.
constexpr double kShareOfTorque = 0.02;

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
  const std::vector<Change> changes = changes_on(e, errors.joint);
  // A change is known as well as its moment and its law are: a little of it is left around every
  // reversal or start behind it.
  const bool of_change = !changes.empty() && !far;
  const bool unknown = (!answer.left.follows.empty() && !of_change) || far || !shapes.empty();
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
  if (!changes.empty()) {
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

}  // namespace

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

}  // namespace offnominal::desk
