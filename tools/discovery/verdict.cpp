#include "discovery/verdict.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <limits>
#include <utility>

#include "discovery/explain_report.hpp"
#include "discovery/find_model.hpp"

namespace offnominal::tools::discovery {
namespace {

// What is left counts as structure where it stands this far above the noise floor ...
constexpr double kAboveNoise = 1.5;
// ... and this share of it follows a variable on time that was not fitted.
constexpr double kStructured = 0.15;
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
constexpr std::array<VerdictRow, 8> kVerdicts = {{
    {Verdict::kExplained, "explained", report::Level::kGood, false},
    {Verdict::kFound, "found", report::Level::kGood, true},
    {Verdict::kAmbiguous, "ambiguous", report::Level::kWarn, false},
    {Verdict::kParameterShift, "parameter_shift", report::Level::kWarn, true},
    {Verdict::kUnknownStateDependent, "unknown_state_dependent", report::Level::kBad, false},
    {Verdict::kUnknownExternal, "unknown_external", report::Level::kBad, false},
    {Verdict::kNotExcited, "not_excited", report::Level::kWarn, false},
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

// The joint where what is left stands furthest above the noise floor, and is worth a name; null
// where none does.
const JointErrors* above_noise(const Explanation& e) {
  const JointErrors* loudest = nullptr;
  double worst = kAboveNoise;
  for (const JointErrors& joint : e.joints) {
    if (!(joint.rms_after > worst * joint.noise_floor)) continue;
    if (joint.rms_after < kRelevantTorque * joint.rms_torque) continue;
    worst = joint.rms_after / joint.noise_floor;
    loudest = &joint;
  }
  return loudest;
}

// The variable that what is left follows on the joint where it stands out most; null for noise.
const StructureShare* remaining_structure(const Explanation& e) {
  const StructureShare* state = nullptr;
  const StructureShare* time = nullptr;
  const JointErrors* loudest = above_noise(e);
  if (loudest == nullptr) return nullptr;
  for (const StructureShare& share : e.where) {  // largest first
    if (share.joint != loudest->joint) continue;
    const bool of_time = share.variable == "time";
    if (of_time && share.share >= kConcentrated) time = &share;
    if (!of_time && share.share >= kStructured && state == nullptr) state = &share;
  }
  if (time != nullptr && (state == nullptr || state->share < kFollowsState)) return time;
  return state;
}

void advise_on_classes(Explanation& e) {
  for (const auto& same : e.ambiguous) {
    std::vector<std::string> all;
    for (const EffectAt& one : same) {
      all.push_back(fmt::format("{}@{}", one.name(), one.joint + 1));
    }
    e.advice.push_back(fmt::format(
        "to tell {} from {}: {}; `offnominal motion --robot {} --separate {} -o motion.csv` "
        "writes such a motion",
        same[0].name(), same[1].name(), info_of(same[0].kind)->motion_hint, e.robot_file,
        fmt::join(all, ",")));
  }
}

void judge_ambiguous(Explanation& e) {
  e.verdict = Verdict::kAmbiguous;
  std::vector<std::string> possible;
  for (const EffectAt& one : e.ambiguous[0]) {
    possible.push_back(fmt::format("{} on {}", one.name(), at_joint(one.joint)));
  }
  std::vector<std::string> sure;
  for (const Finding& finding : e.found) {
    if (!holds_in_any(e.ambiguous, finding.what)) sure.push_back(words_of(finding));
  }
  e.words = sure.empty()
                ? "Something is missing"
                : fmt::format("Missing: {}. Something else is missing too", fmt::join(sure, ", "));
  e.words +=
      fmt::format(", but these recordings cannot tell which: {}.", fmt::join(possible, ", or "));
  advise_on_classes(e);
}

void judge_found(Explanation& e) {
  const bool shift = std::all_of(e.found.begin(), e.found.end(), [](const Finding& f) {
    return info_of(f.what.kind)->is_known_quantity();
  });
  e.verdict = shift ? Verdict::kParameterShift : Verdict::kFound;
  const Finding& first = e.found.front();
  const double fall =
      first.holdout_before > 0 ? 100 * (1 - first.holdout_after / first.holdout_before) : 0;
  e.words = fmt::format("{} {} ({}): the error on held-out data of that joint falls by {:.0f} %.",
                        shift ? "Another value of a known quantity:" : "Missing:", words_of(first),
                        first.words, fall);
  if (e.found.size() == 1) return;
  std::vector<std::string> others;
  std::transform(e.found.begin() + 1, e.found.end(), std::back_inserter(others), words_of);
  e.words += fmt::format(" Also: {}.", fmt::join(others, ", "));
}

// What was found on a joint explains nearly all that there was to explain there.
bool is_nearly_all(const JointErrors& joint) {
  constexpr double kLeft = 0.35;
  return joint.rms_after < kLeft * joint.rms_fitted_before;
}

// What was found stands by itself, whatever else is left: it explains nearly all of its
// own joints, and what acts on another one is another matter.
bool stands_beside_rest(const Explanation& e) {
  return !e.found.empty() && std::all_of(e.found.begin(), e.found.end(), [&](const Finding& f) {
    return is_nearly_all(e.joints[static_cast<std::size_t>(f.what.joint)]);
  });
}

bool judge_unknown(Explanation& e) {
  const StructureShare* left = remaining_structure(e);
  if (left == nullptr) return false;
  const JointErrors& joint = e.joints[static_cast<std::size_t>(left->joint)];
  const bool external = left->variable == "time";
  const bool found_there = std::any_of(e.found.begin(), e.found.end(), [&](const Finding& f) {
    return f.what.joint == joint.joint;
  });
  if ((found_there && is_nearly_all(joint)) || stands_beside_rest(e)) {
    e.advice.push_back(fmt::format(
        "joint {}: what is left, {:.3g} {}, {}: none of the known effects", joint.joint + 1,
        joint.rms_after, joint.unit,
        external ? "comes in a few stretches of time" : "still follows its " + left->variable));
    return false;
  }
  e.verdict = external ? Verdict::kUnknownExternal : Verdict::kUnknownStateDependent;
  e.words = fmt::format(
      "Something acts on {} that is none of the known effects: the error stands {:.1f} times above "
      "the noise and {}.",
      at_joint(left->joint), joint.rms_after / joint.noise_floor,
      external ? "comes in a few stretches of time" : "follows its " + left->variable);
  for (const Finding& finding : e.found) {
    e.advice.push_back(
        fmt::format("{} on {} explains a part, but stands for something else: do not add it",
                    finding.what.name(), at_joint(finding.what.joint)));
  }
  e.found.clear();
  e.ambiguous.clear();
  e.waterfall.resize(1);
  e.advice.push_back(external ? "look at the recording at these times: contact, a cable, a person"
                              : "see the map of the error over " + left->variable);
  return true;
}

// How small an effect cannot be named, beyond what the model's own numbers take up: a sentence.
std::string words_of_detectable(const Explanation& e) {
  double least = std::numeric_limits<double>::infinity();
  double most = 0;
  for (const Rejection& one : e.rejected) {
    const double torque = e.joints[static_cast<std::size_t>(one.what.joint)].rms_torque;
    if (!(torque > 0)) continue;
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
  e.suspected = one;
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

bool is_to_write(Verdict verdict) { return row_of(verdict).to_write; }

report::Level level_of(Verdict verdict) { return row_of(verdict).level; }

std::vector<std::string> verdict_names() {
  std::vector<std::string> names;
  for (const VerdictRow& row : kVerdicts) names.emplace_back(row.name);
  return names;
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

void judge_whole(Explanation& e) {
  e.advice.clear();
  const std::optional<Suspicion> suspected = std::exchange(e.suspected, std::nullopt);
  for (std::size_t joint = 0; joint < e.excitation.size(); ++joint) {
    const Excitation& one = e.excitation[joint];
    if (one.sufficient) continue;
    e.advice.push_back(fmt::format("joint {}: {}", joint + 1, one.lack));
  }
  const bool poor = !all_sufficient(e.excitation);
  if (!e.data_faults.empty()) {
    e.verdict = Verdict::kDataFault;
    e.words = "The recording itself is at fault: " + e.data_faults[0].words + ".";
    for (const DataFault& fault : e.data_faults) e.advice.push_back(fault.mend);
    e.found.clear();
    e.ambiguous.clear();
    e.waterfall.resize(std::min<std::size_t>(1, e.waterfall.size()));
    return;
  }
  if (!poor && judge_unknown(e)) return;
  if (!e.ambiguous.empty()) {
    judge_ambiguous(e);
    return;
  }
  if (!e.found.empty()) {
    judge_found(e);
    return;
  }
  if (!e.shifts.empty() && !poor) {
    e.verdict = Verdict::kParameterShift;
    e.words = fmt::format("A known quantity has another value: {} is off by {:+.0f} %.",
                          e.shifts[0].name, 100 * e.shifts[0].share);
    return;
  }
  if (poor) {
    e.verdict = Verdict::kNotExcited;
    e.words = "These motions excite too little to judge the model by them.";
    e.advice.emplace_back(
        e.at_rest ? kMorePositions
                  : fmt::format("`offnominal motion --robot {} -o motion.csv` writes a motion that "
                                "excites what the robot may have",
                                e.robot_file));
    return;
  }
  const JointErrors* loudest = above_noise(e);
  // What stands above the noise without following anything is told as such.
  if (suspected && loudest == nullptr) {
    judge_suspected(*suspected, e);
    return;
  }
  e.verdict = Verdict::kExplained;
  e.words =
      loudest == nullptr
          ? "The model explains these recordings: what is left is noise, or less than a thousandth "
            "of the torque, and no known effect is missing." +
                words_of_detectable(e)
          : fmt::format(
                "No known effect stands out. What is left on {} stands {:.1f} times above the "
                "noise, and follows nothing that was looked at.",
                at_joint(loudest->joint), loudest->rms_after / loudest->noise_floor);
}

}  // namespace offnominal::tools::discovery
