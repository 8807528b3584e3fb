#include "explain/doubts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "compare/before_after.hpp"

namespace offnominal::desk {

namespace {

// Share of the error that is gone; NaN where there was none.
double fall_of(const HeldOutSquares& joint) { return 1 - std::sqrt(joint.after / joint.before); }

bool falls(const HeldOutSquares& joint) {
  return rises(std::sqrt(joint.after), std::sqrt(joint.before), std::sqrt(joint.torque));
}

// Something of that joint's own is to be changed. What it carries is another matter: others may
// show it.
bool is_changed_itself(const Explanation& e, Eigen::Index joint) {
  return std::any_of(e.found.begin(), e.found.end(),
                     [&](const Finding& one) {
                       return one.what.joint == joint && is_written(e, one.what) &&
                              info_of(one.what.kind)->action != EffectAction::kPointMass;
                     }) ||
         std::any_of(e.shifts.begin(), e.shifts.end(),
                     [&](const Shift& one) { return one.joint == joint; });
}

// Of masses that no joint gains by.
void add_doubts_of_masses(const Explanation& e, const std::vector<HeldOutSquares>& joints,
                          std::vector<std::string>& doubts) {
  for (const Finding& one : e.found) {
    const bool is_mass = info_of(one.what.kind)->action == EffectAction::kPointMass;
    if (!is_mass || !is_written(e, one.what)) continue;
    bool gains = false;
    for (std::size_t joint = 0; joint < joints.size(); ++joint) {
      gains =
          gains || (shows_on(one.what, static_cast<Eigen::Index>(joint)) && falls(joints[joint]));
    }
    if (gains) continue;
    doubts.push_back(fmt::format(
        "on data not used for the fit the error of no joint that carries {} of joint {} "
        "falls clearly: these data do not support what was found",
        one.what.name(), one.what.joint + 1));
  }
}

}  // namespace

std::vector<HeldOutSquares> held_out_squares(const Explanation& e) {
  std::vector<HeldOutSquares> all;
  for (const JointErrors& joint : e.joints) {
    all.push_back({std::pow(joint.holdout_before, 2), std::pow(joint.holdout_after, 2),
                   std::pow(joint.rms_torque, 2)});
  }
  return all;
}

bool is_doubted(const HeldOutSquares& joint, bool is_changed) {
  if (is_changed) return !(fall_of(joint) > 0);
  return rises(std::sqrt(joint.before), std::sqrt(joint.after), std::sqrt(joint.torque));
}

std::vector<std::string> doubts_of(const Explanation& e,
                                   const std::vector<HeldOutSquares>& joints) {
  std::vector<std::string> doubts;
  for (std::size_t joint = 0; joint < joints.size(); ++joint) {
    const HeldOutSquares& squares = joints[joint];
    const bool asked = is_changed_itself(e, static_cast<Eigen::Index>(joint));
    if (!is_doubted(squares, asked)) continue;
    if (!(squares.before > 0)) {
      doubts.push_back(fmt::format(
          "no data that were not used for the fit say anything of joint {}", joint + 1));
      continue;
    }
    doubts.push_back(fmt::format(
        "on data not used for the fit the error of joint {} {}, by {:.1f} %: these "
        "data do not support what was found",
        joint + 1, asked ? "does not fall but rises" : "rises", -100 * fall_of(squares)));
  }
  add_doubts_of_masses(e, joints, doubts);
  return doubts;
}

std::vector<std::string> doubts_of(const Explanation& e) {
  if (e.at_rest || !changes_the_file(e)) return {};
  return doubts_of(e, held_out_squares(e));
}

}  // namespace offnominal::desk
