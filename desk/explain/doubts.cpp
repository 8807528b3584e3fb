#include "explain/doubts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace offnominal::desk {

std::vector<HeldOutSquares> held_out_squares(const Explanation& e) {
  std::vector<HeldOutSquares> all;
  for (const JointErrors& joint : e.joints) {
    all.push_back({std::pow(joint.holdout_before, 2), std::pow(joint.holdout_after, 2)});
  }
  return all;
}

std::vector<std::string> doubts_of(const Explanation& e,
                                   const std::vector<HeldOutSquares>& joints) {
  constexpr double kRelevant = 0.05;
  std::vector<std::string> doubts;
  for (std::size_t joint = 0; joint < joints.size(); ++joint) {
    const HeldOutSquares& squares = joints[joint];
    const double fall = 1 - std::sqrt(squares.after / squares.before);
    const auto of_joint = [joint](Eigen::Index one) {
      return one == static_cast<Eigen::Index>(joint);
    };
    const bool asked = std::any_of(e.found.begin(), e.found.end(),
                                   [&](const Finding& one) { return of_joint(one.what.joint); }) ||
                       std::any_of(e.shifts.begin(), e.shifts.end(),
                                   [&](const Shift& one) { return of_joint(one.joint); });
    if (asked ? fall > 0 : !(fall < -kRelevant)) continue;
    if (!(squares.before > 0)) {
      doubts.push_back(fmt::format(
          "no data that were not used for the fit say anything of joint {}", joint + 1));
      continue;
    }
    doubts.push_back(
        fmt::format("on data not used for the fit the error of joint {} {}, by {:.1f} %: these "
                    "data do not support what was found",
                    joint + 1, asked ? "does not fall but rises" : "rises", -100 * fall));
  }
  return doubts;
}

std::vector<std::string> doubts_of(const Explanation& e) {
  if (e.at_rest || !changes_the_file(e)) return {};
  return doubts_of(e, held_out_squares(e));
}

}  // namespace offnominal::desk
