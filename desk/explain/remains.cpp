#include "explain/remains.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>

#include "common/amount.hpp"
#include "explain/found_model.hpp"

namespace offnominal::desk {
namespace {

// What is left counts as structure where it stands this far above the noise floor ...
constexpr double kAboveNoise = 1.5;
// ... and this share of it follows a variable on time that was not fitted.
constexpr double kStructured = 0.15;
// A push or another event: this share of the energy is in a tenth of the time.
constexpr double kConcentrated = 0.5;
// ... unless this much follows a variable of the joint.
constexpr double kFollowsState = 0.4;

}  // namespace

bool stands_out(const JointErrors& joint) {
  return joint.rms_after > kAboveNoise * joint.noise_floor &&
         joint.rms_after >= kRelevantTorque * joint.rms_torque;
}

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

namespace {

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

}  // namespace

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

}  // namespace offnominal::desk
