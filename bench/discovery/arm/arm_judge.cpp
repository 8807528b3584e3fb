#include "arm_judge.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace offnominal::bench {

using desk::EffectAt;
using desk::Explanation;
using Eigen::Index;

namespace {

constexpr int kLargestClass = 3;
constexpr double kMomentS = 0.1;

EffectAt place_of(const ArmTrueEffect& one) { return {one.effect.kind, one.effect.joint}; }

double mass_of(const desk::Finding& finding) {
  for (const desk::Estimate& one : finding.parameters) {
    if (one.value.name == "mass") return one.value.value;
  }
  return 0;
}

class ArmJudge {
 public:
  ArmJudge(const ArmTruth& truth, const Explanation& told) : truth_(truth), told_(told) {
    for (const auto* effects : {&truth.effects, &truth.changes}) {
      for (const ArmTrueEffect& one : *effects) there_.push_back(place_of(one));
    }
  }

  ArmScore score() {
    for (std::size_t i = 0; i < truth_.stands.size(); ++i) {
      score_.joints.push_back({static_cast<Index>(i), false, true, false});
    }
    for (const ArmTrueEffect& one : truth_.effects) {
      if (one.is_asked_for) ask(one);
    }
    for (const desk::Finding& finding : told_.found) {
      if (!is_there(finding) && !is_excused(finding.what)) count_wrong(finding.what);
    }
    for (const auto& same : told_.ambiguous) {
      // The model's own numbers are off in every case.
      if (!may_be_own_numbers(told_, same) && !holds_one_that_is_there(same)) {
        count_wrong(same.front());
      }
    }
    for (const desk::Change& one : told_.changes) {
      if (!is_true(one)) count_wrong(one.what);
    }
    for (const desk::Push& one : told_.pushes) {
      if (is_true(one)) continue;
      for (const desk::Push::OnJoint& on : one.joints) at(on.joint).is_wrong = true;
      ++score_.false_pushes;
    }
    judge_moments();
    return std::move(score_);
  }

 private:
  ArmJointScore& at(Index joint) { return score_.joints.at(static_cast<std::size_t>(joint)); }

  void ask(const ArmTrueEffect& one) {
    ArmAsked asked{place_of(one), one.share, false, 0, {}};
    const auto finding =
        std::find_if(told_.found.begin(), told_.found.end(),
                     [&](const desk::Finding& found) { return found.what == asked.what; });
    for (const auto& same : told_.ambiguous) {
      if (!holds(same, asked.what)) continue;
      const int own = may_be_own_numbers(told_, same) ? 1 : 0;  // a member, too
      asked.class_size = static_cast<int>(same.size()) + own;
    }
    if (finding != told_.found.end() && asked.class_size == 0) {
      asked.named = true;
      asked.class_size = 1;
    }
    ArmJointScore& joint = at(asked.what.joint);
    joint.is_asked = true;
    joint.is_answered =
        joint.is_answered && asked.class_size > 0 && asked.class_size <= kLargestClass;
    if (asked.class_size == 0) asked.instead = answer_of(asked.what.joint);
    if (asked.what.kind == EffectKind::kTipPayload) {
      const double mass = finding == told_.found.end() ? 0 : mass_of(*finding);
      score_.payload = std::abs(mass - one.effect.number(0)) <= 0.1 * one.effect.number(0);
    }
    score_.asked.push_back(asked);
  }

  [[nodiscard]] std::string answer_of(Index joint) const {
    for (const desk::JointAnswer& one : told_.answers) {
      if (one.joint != joint) continue;
      std::string text = desk::name_of(one.verdict);
      for (const EffectAt& found : one.found) text += fmt::format(" {}", found.name());
      return text;
    }
    return desk::name_of(told_.verdict);
  }

  [[nodiscard]] bool holds_one_that_is_there(const std::vector<EffectAt>& same) const {
    return std::any_of(same.begin(), same.end(), [&](const EffectAt& one) {
      return holds(there_, one) || is_wrong_constant(one) || is_wrong_mass(one, 0);
    });
  }
  [[nodiscard]] bool is_there(const desk::Finding& finding) const {
    return holds(there_, finding.what) || is_wrong_constant(finding.what) ||
           is_wrong_mass(finding.what, mass_of(finding));
  }
  [[nodiscard]] bool is_excused(const EffectAt& named) const {
    return std::any_of(told_.ambiguous.begin(), told_.ambiguous.end(), [&](const auto& same) {
      return holds(same, named) &&
             (may_be_own_numbers(told_, same) || holds_one_that_is_there(same));
    });
  }
  [[nodiscard]] bool is_wrong_constant(const EffectAt& one) const {
    constexpr double kLeast = 0.01;
    return one.kind == EffectKind::kTorqueScale &&
           std::abs(truth_.torque_constant_error.at(static_cast<std::size_t>(one.joint))) >= kLeast;
  }
  // `mass` 0: not said which way.
  [[nodiscard]] bool is_wrong_mass(const EffectAt& one, double mass) const {
    if (one.kind != EffectKind::kLinkMass) return false;
    const auto joint = static_cast<std::size_t>(one.joint);
    constexpr double kLeast = 0.05;
    return std::abs(truth_.link_mass_error_share.at(joint)) >= kLeast &&
           truth_.link_mass_error_share[joint] * mass >= 0;
  }

  // A change of what is said, or of something that it is not told from, near that moment.
  [[nodiscard]] bool is_true(const desk::Change& told) const {
    constexpr double kNearS = 1;
    return std::any_of(truth_.changes.begin(), truth_.changes.end(), [&](const ArmTrueEffect& one) {
      const bool named =
          (told.what == place_of(one) && told.by.front().value.value * one.effect.number(0) > 0) ||
          holds(told.alike, place_of(one));
      return named && std::abs(told.at_s - one.effect.from_s) <= kNearS;
    });
  }

  // Something pushes half of that time or longer, on a link that the joint carries.
  [[nodiscard]] bool is_true(const desk::Push& told) const {
    return std::any_of(truth_.pushes.begin(), truth_.pushes.end(), [&](const ArmPush& one) {
      const double both_s = std::min(told.to_s, one.to_s) - std::max(told.from_s, one.from_s);
      return both_s >= (told.to_s - told.from_s) / 2 && told.joints.front().joint <= one.link;
    });
  }

  void count_wrong(const EffectAt& one) {
    at(one.joint).is_wrong = true;
    score_.wrong.push_back(one);
  }

  // Whether the answer tells of something on this joint that begins or ends then.
  [[nodiscard]] bool tells_of(double t_s, Index joint) const {
    const auto near = [&](double told_s) { return std::abs(told_s - t_s) <= kMomentS; };
    return std::any_of(told_.loud.begin(), told_.loud.end(),
                       [&](const desk::LoudSpan& span) {
                         return span.joint == joint && (near(span.from_s) || near(span.to_s));
                       }) ||
           std::any_of(told_.pushes.begin(), told_.pushes.end(),
                       [&](const desk::Push& one) {
                         const auto is_here = [&](const auto& on) { return on.joint == joint; };
                         return std::any_of(one.joints.begin(), one.joints.end(), is_here) &&
                                (near(one.from_s) || near(one.to_s));
                       }) ||
           std::any_of(told_.changes.begin(), told_.changes.end(), [&](const desk::Change& one) {
             return one.what.joint == joint && near(one.at_s);
           });
  }
  [[nodiscard]] bool tells_of_any(double t_s, Index last_joint) const {
    for (Index joint = 0; joint <= last_joint; ++joint) {
      if (tells_of(t_s, joint)) return true;
    }
    return false;
  }

  void judge_moments() {
    // A payload is felt on every joint, a push on those before the link.
    for (const ArmTrueEffect& one : truth_.changes) {
      const bool everywhere = one.effect.kind == EffectKind::kTipPayload;
      score_.moment = everywhere ? tells_of_any(one.effect.from_s, one.effect.joint)
                                 : tells_of(one.effect.from_s, one.effect.joint);
    }
    for (const ArmPush& push : truth_.pushes) {
      const bool told = tells_of_any(push.from_s, push.link) && tells_of_any(push.to_s, push.link);
      score_.moment = score_.moment.value_or(true) && told;
    }
  }

  const ArmTruth& truth_;
  const Explanation& told_;
  std::vector<EffectAt> there_;
  ArmScore score_;
};

}  // namespace

ArmScore arm_score_of(const ArmTruth& truth, const Explanation& told) {
  return ArmJudge(truth, told).score();
}

}  // namespace offnominal::bench
