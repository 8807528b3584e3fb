#include "motion/contender.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <string_view>

#include "common/error.hpp"
#include "common/nearest.hpp"

namespace offnominal::desk::motion {

using Eigen::Index;

namespace {

[[noreturn]] void refuse(const std::string& option, const std::string& found,
                         const std::string& allowed, const std::string& mend = {}) {
  throw InputError({"offnominal motion", option, found, allowed, mend});
}

const EffectCandidate& effect_named(const std::string& name, const std::string& option) {
  std::vector<std::string> names;
  for (const auto& candidate : all_candidates()) {
    if (name == candidate->name()) return *candidate;
    names.emplace_back(candidate->name());
  }
  const std::string meant = nearest(name, names);
  refuse(option, "\"" + name + "\"", list_of(names), meant.empty() ? "" : "write " + meant);
}

// In the robot file already, where it is one of a kind: then its numbers are fitted anyway.
bool is_known(const RobotDescription& robot, const Contender& one) {
  if (one.effect->spectrum() != EffectCandidate::Spectrum::kNone) return false;
  return std::any_of(robot.effects.begin(), robot.effects.end(), [&](const RobotEffect& known) {
    return known.joint == one.joint && known.kind == one.effect->kind();
  });
}

// Whether the effect can act on the joint once it moves.
bool can_act(const RobotDescription& robot, const Contender& one) {
  Workspace moving;
  moving.rigid = robot;
  const auto joints = static_cast<Index>(robot.joint_count());
  moving.motion.q = Eigen::MatrixXd::Zero(1, joints);
  moving.top_speed = Eigen::VectorXd::Ones(joints);
  return one.effect->applies(moving, one.joint);
}

}  // namespace

std::string text_of(const Contender& contender) {
  return fmt::format("{}@{}", contender.effect->name(), contender.joint + 1);
}

Contender contender_of(const std::string& text, const RobotDescription& robot,
                       const std::string& option) {
  const auto at = text.find('@');
  Contender one;
  one.effect = &effect_named(text.substr(0, at), option);
  const int joints = robot.joint_count();
  const std::string allowed =
      fmt::format("{}@JOINT with a joint from 1 to {}", one.effect->name(), joints);
  if (at != std::string::npos) {
    int number = 0;
    const char* begin = text.data() + at + 1;
    const char* end = text.data() + text.size();
    const auto [last, error] = std::from_chars(begin, end, number);
    if (error != std::errc{} || last != end || number < 1 || number > joints) {
      refuse(option, "\"" + text + "\"", allowed);
    }
    one.joint = number - 1;
  } else {
    std::vector<Index> possible;
    for (Index joint = 0; joint < joints; ++joint) {
      const Contender here{one.effect, joint};
      if (can_act(robot, here) && !is_known(robot, here)) possible.push_back(joint);
    }
    if (possible.size() > 1) {
      refuse(option, "\"" + text + "\", which may be on several joints", allowed,
             "say on which joint");
    }
    if (!possible.empty()) one.joint = possible[0];
  }
  if (!can_act(robot, one)) {
    refuse(option, text_of(one), "an effect that can act on that joint of this robot");
  }
  if (is_known(robot, one)) {
    refuse(option, text_of(one) + ", which the robot file has already",
           "an effect that the model lacks",
           "`offnominal explain` fits its numbers; nothing is to be told apart");
  }
  return one;
}

std::vector<Contender> contenders_on(const RobotDescription& robot,
                                     const std::vector<Index>& joints) {
  std::vector<Contender> all;
  for (const auto& candidate : all_candidates()) {
    for (const Index joint : joints) {
      const Contender one{candidate.get(), joint};
      if (can_act(robot, one) && !is_known(robot, one)) all.push_back(one);
    }
  }
  return all;
}

}  // namespace offnominal::desk::motion
