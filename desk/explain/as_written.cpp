#include "explain/as_written.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "explain/doubts.hpp"

namespace offnominal::desk {

using Eigen::Index;
using Eigen::VectorXd;

const FileErrors& Judged::errors_of_file() const {
  if (!errors_of_file_) errors_of_file_ = errors_of(file_);
  return *errors_of_file_;
}

const FileErrors& Judged::held_out_errors_of_file() const {
  if (!held_out_errors_of_file_) held_out_errors_of_file_ = held_out_errors_of(file_);
  return *held_out_errors_of_file_;
}

FileErrors Judged::errors_of(const RobotDescription& robot) const {
  return file_errors(robot, logs_, plan_);
}

FileErrors Judged::held_out_errors_of(const RobotDescription& robot) const {
  return file_errors(robot, holdout_, plan_);
}

HeldOutErrors held_out_of(const Judged& by, const ImprovedRobot& improved) {
  if (by.holdout().empty()) {
    std::vector<Term> written;
    for (std::size_t i = 0; i < improved.added.size(); ++i) {
      if (improved.added[i] != kUnwritten) written.push_back(improved.last.terms[i]);
    }
    return held_out_errors(by.file(), improved, written);
  }
  const FileErrors& before = by.held_out_errors_of_file();
  const FileErrors after = by.held_out_errors_of(improved.robot);
  const auto vector = [](const std::vector<double>& of) -> VectorXd {
    return Eigen::Map<const VectorXd>(of.data(), static_cast<Index>(of.size()));
  };
  return {vector(before.rms_torque), vector(before.rms_error), vector(after.rms_error)};
}

void tell_errors_of_files(const Judged& by, const ImprovedRobot& improved, Explanation& result) {
  const FileErrors& before = by.errors_of_file();
  const FileErrors after = by.errors_of(improved.robot);
  for (std::size_t joint = 0; joint < result.joints.size(); ++joint) {
    result.joints[joint].rms_torque = before.rms_torque[joint];
    result.joints[joint].rms_before = before.rms_error[joint];
    result.joints[joint].rms_improved = after.rms_error[joint];
  }
  const HeldOutErrors held_out = held_out_of(by, improved);
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  for (JointErrors& joint : result.joints) {
    // Of a joint of which nothing is left there is no error.
    const bool is_there = held_out.torque[joint.joint] > 0;
    joint.holdout_before = is_there ? held_out.before[joint.joint] : kNone;
    joint.holdout_after = is_there ? held_out.after[joint.joint] : kNone;
  }
}

std::vector<Index> take_better_numbers(const Judged& by, const RobotDescription& other,
                                       const std::vector<char>& joints, RobotDescription& robot) {
  RobotDescription refitted = robot;
  // Several of a kind stand in the same order in both.
  std::vector<RobotEffect> numbers = other.effects;
  for (RobotEffect& effect : refitted.effects) {
    const EffectInfo& info = *info_of(effect.kind);
    if (effect.of_motor || joints[static_cast<std::size_t>(effect.joint)] == 0 ||
        info.action == EffectAction::kPointMass || info.acts_on_whole_drive()) {
      continue;
    }
    const auto same = std::find_if(numbers.begin(), numbers.end(), [&](const RobotEffect& one) {
      return one.kind == effect.kind && one.joint == effect.joint && !one.of_motor;
    });
    if (same == numbers.end()) continue;
    effect.parameters = same->parameters;
    numbers.erase(same);
  }
  const std::vector<double> as_it_was = by.errors_of(robot).rms_error;
  const std::vector<double> as_it_is = by.errors_of(refitted).rms_error;
  std::vector<Index> better;
  for (std::size_t joint = 0; joint < joints.size(); ++joint) {
    if (as_it_is[joint] < as_it_was[joint]) better.push_back(static_cast<Index>(joint));
  }
  for (std::size_t i = 0; i < robot.effects.size(); ++i) {
    const auto joint = static_cast<Index>(robot.effects[i].joint);
    if (std::find(better.begin(), better.end(), joint) == better.end()) continue;
    robot.effects[i].parameters = refitted.effects[i].parameters;
  }
  return better;
}

std::vector<Index> raised_by_links(const Judged& by, const ImprovedRobot& improved,
                                   const std::vector<char>& changed) {
  std::vector<Index> raised;
  if (!moves_links(improved)) return raised;
  const HeldOutErrors held_out = held_out_of(by, improved);
  for (Index joint = 0; joint < held_out.before.size(); ++joint) {
    const HeldOutSquares squares{std::pow(held_out.before[joint], 2),
                                 std::pow(held_out.after[joint], 2),
                                 std::pow(held_out.torque[joint], 2)};
    const bool is_changed = changed[static_cast<std::size_t>(joint)] != 0;
    if (!is_changed && is_doubted(squares, false)) raised.push_back(joint);
  }
  return raised;
}

}  // namespace offnominal::desk
