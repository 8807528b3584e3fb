#include "paper/recorded_motion.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "common/error.hpp"
#include "log/csv_log.hpp"

namespace offnominal::desk::paper {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

RecordedMotion RecordedMotion::read(const std::filesystem::path& file, int joints) {
  const NamedColumns columns = read_csv(file, [](const std::string&) { return Need::kWelcome; });
  const auto column = [&](const std::string& name) -> const VectorXd& {
    const auto found = columns.columns.find(name);
    if (found == columns.columns.end()) {
      throw InputError({columns.file, "", "no column of numbers " + name,
                        fmt::format("t, and q, dq, ddq of joints 1 to {}", joints),
                        "write the motion with offnominal motion, for the same robot"});
    }
    return found->second;
  };
  int there = joints;
  while (columns.columns.contains("q" + std::to_string(there + 1))) ++there;
  if (there > joints) {
    throw InputError({columns.file, "",
                      fmt::format("q1 to q{}: the motion of another robot", there),
                      fmt::format("q, dq, ddq of joints 1 to {}, and no more", joints),
                      "write the motion with offnominal motion, for the same robot"});
  }
  RecordedMotion motion;
  motion.t_s_ = column("t").array() - column("t")[0];
  const auto of_all = [&](const std::string& name) {
    MatrixXd all(motion.t_s_.size(), joints);
    for (int joint = 0; joint < joints; ++joint) {
      all.col(joint) = column(name + std::to_string(joint + 1));
    }
    return all;
  };
  motion.q_ = of_all("q");
  motion.dq_ = of_all("dq");
  motion.ddq_ = of_all("ddq");
  for (Index i = 0; i < motion.t_s_.size(); ++i) {
    const bool ascends = i == 0 || motion.t_s_[i] > motion.t_s_[i - 1];
    if (ascends && motion.q_.row(i).allFinite() && motion.dq_.row(i).allFinite() &&
        motion.ddq_.row(i).allFinite()) {
      continue;
    }
    throw InputError({columns.file, columns.place_of(i),
                      ascends ? "a value that is not finite" : "a time that does not ascend",
                      "finite values, time ascending", ""});
  }
  if (motion.t_s_.size() < 2) {
    throw InputError({columns.file, "", "one row", "two or more", "give a whole motion"});
  }
  return motion;
}

RecordedMotion::Joint RecordedMotion::at(double t_s, int joint) const {
  const Index last = t_s_.size() - 1;
  if (t_s <= 0 || t_s >= t_s_[last]) return {q_(t_s <= 0 ? 0 : last, joint), 0, 0};
  const auto after = std::upper_bound(t_s_.begin(), t_s_.end(), t_s);
  const Index i = std::min<Index>(after - t_s_.begin(), last) - 1;
  const double h = t_s_[i + 1] - t_s_[i];
  const double s = (t_s - t_s_[i]) / h;
  const double q0 = q_(i, joint);
  const double q1 = q_(i + 1, joint);
  const double dq0 = dq_(i, joint);
  const double dq1 = dq_(i + 1, joint);
  return {(1 + 2 * s) * (1 - s) * (1 - s) * q0 + s * (1 - s) * (1 - s) * h * dq0 +
              s * s * (3 - 2 * s) * q1 + s * s * (s - 1) * h * dq1,
          6 * s * (1 - s) / h * (q1 - q0) + (1 - s) * (1 - 3 * s) * dq0 + s * (3 * s - 2) * dq1,
          (1 - s) * ddq_(i, joint) + s * ddq_(i + 1, joint)};
}

sim::DesiredMotion RecordedMotion::at(double t_s) const {
  sim::DesiredMotion desired;
  for (sim::JointVector* all : {&desired.q, &desired.dq, &desired.ddq}) all->resize(q_.cols());
  for (Index i = 0; i < q_.cols(); ++i) {
    const Joint joint = at(t_s, static_cast<int>(i));
    desired.q[i] = joint.q;
    desired.dq[i] = joint.dq;
    desired.ddq[i] = joint.ddq;
  }
  return desired;
}

}  // namespace offnominal::desk::paper
