#include "explain/as_written.hpp"

#include <cmath>

#include "explain/doubts.hpp"
#include "identify/file_errors.hpp"

namespace offnominal::desk {

using Eigen::Index;
using Eigen::VectorXd;

HeldOutErrors held_out_of(const Judged& by, const ImprovedRobot& improved) {
  if (by.holdout.empty()) {
    std::vector<Term> written;
    for (std::size_t i = 0; i < improved.added.size(); ++i) {
      if (improved.added[i] != kUnwritten) written.push_back(improved.last.terms[i]);
    }
    return held_out_errors(by.file, improved, written);
  }
  const FileErrors before = file_errors(by.file, by.holdout, by.plan);
  const FileErrors after = file_errors(improved.robot, by.holdout, by.plan);
  const auto vector = [](const std::vector<double>& of) -> VectorXd {
    return Eigen::Map<const VectorXd>(of.data(), static_cast<Index>(of.size()));
  };
  return {vector(before.rms_torque), vector(before.rms_error), vector(after.rms_error)};
}

void tell_errors_of_files(const Judged& by, const ImprovedRobot& improved, Explanation& result) {
  const FileErrors before = file_errors(by.file, by.logs, by.plan);
  const FileErrors after = file_errors(improved.robot, by.logs, by.plan);
  for (std::size_t joint = 0; joint < result.joints.size(); ++joint) {
    result.joints[joint].rms_torque = before.rms_torque[joint];
    result.joints[joint].rms_before = before.rms_error[joint];
    result.joints[joint].rms_improved = after.rms_error[joint];
  }
  const HeldOutErrors held_out = held_out_of(by, improved);
  for (JointErrors& joint : result.joints) {
    joint.holdout_before = held_out.before[joint.joint];
    joint.holdout_after = held_out.after[joint.joint];
  }
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
