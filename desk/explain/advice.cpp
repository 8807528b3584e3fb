#include "explain/advice.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "common/list_of_joints.hpp"
#include "compare/inverse_model.hpp"
#include "explain/any_shape.hpp"
#include "explain/link_share.hpp"
#include "explain/remains.hpp"

namespace offnominal::desk {
namespace {

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

}  // namespace

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

void advise_on_motion(Explanation& e) {
  for (std::size_t joint = 0; joint < e.excitation.size(); ++joint) {
    const Excitation& one = e.excitation[joint];
    const auto answer = std::find_if(
        e.answers.begin(), e.answers.end(),
        [&](const JointAnswer& of) { return of.joint == static_cast<Eigen::Index>(joint); });
    const bool answered = answer != e.answers.end() && answer->verdict != Verdict::kNotExcited;
    if (one.sufficient || answered) continue;
    e.advice.push_back(fmt::format("joint {}: {}", joint + 1, one.lack));
  }
}

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

void advise_on_friction(Explanation& e) {
  if (e.without_friction.empty() || e.at_rest) return;
  const auto is_found = [&](Eigen::Index joint) {
    return std::any_of(e.found.begin(), e.found.end(), [joint](const Finding& one) {
      return one.what.joint == joint && (one.what.kind == EffectKind::kCoulombFriction ||
                                         one.what.kind == EffectKind::kViscousFriction);
    });
  };
  std::vector<Eigen::Index> none_found;
  std::copy_if(e.without_friction.begin(), e.without_friction.end(), std::back_inserter(none_found),
               [&](Eigen::Index joint) { return !is_found(joint); });
  std::string advice = fmt::format("the robot file has no friction on {}, and every drive has some",
                                   list_of_joints(e.without_friction));
  if (!none_found.empty()) {
    advice += fmt::format(
        ": on {} none was found, and `[[effect]]` with kind = \"coulomb_friction\" and one with "
        "kind "
        "= \"viscous_friction\", `fitted = true`, is where to begin",
        list_of_joints(none_found));
  }
  e.advice.push_back(std::move(advice));
}

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
        "joint {}: `offnominal add {} --joint {} --robot {} --log LOG{} -o improved.toml` puts it "
        "into the model as {}",
        one.joint + 1, curve->name, one.joint + 1, e.robot_file, e.reading, curve->words));
  }
}

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

}  // namespace offnominal::desk
