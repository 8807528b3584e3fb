#include "paper/recorded_motion.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "common/error.hpp"
#include "log/csv_log.hpp"

namespace offnominal::tools::paper {

using Eigen::Index;
using Eigen::MatrixX2d;
using Eigen::VectorXd;

RecordedMotion RecordedMotion::read(const std::filesystem::path& file) {
  const NamedColumns columns = read_csv(file, [](const std::string&) { return Need::kWelcome; });
  const auto column = [&](const std::string& name) -> const VectorXd& {
    const auto found = columns.columns.find(name);
    if (found == columns.columns.end()) {
      throw InputError({columns.file, "", "no column of numbers " + name,
                        "t, q1, q2, dq1, dq2, ddq1, ddq2",
                        "write the motion with offnominal motion, for a robot of two joints"});
    }
    return found->second;
  };
  RecordedMotion motion;
  motion.t_s_ = column("t").array() - column("t")[0];
  const auto pair = [&](const std::string& name) {
    MatrixX2d both(motion.t_s_.size(), 2);
    both.col(0) = column(name + "1");
    both.col(1) = column(name + "2");
    return both;
  };
  motion.q_ = pair("q");
  motion.dq_ = pair("dq");
  motion.ddq_ = pair("ddq");
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

sim::DesiredMotion RecordedMotion::at(double t_s) const {
  const Index last = t_s_.size() - 1;
  if (t_s <= 0 || t_s >= t_s_[last]) {
    const Index end = t_s <= 0 ? 0 : last;
    return {q_.row(end).transpose(), Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero()};
  }
  const auto after = std::upper_bound(t_s_.begin(), t_s_.end(), t_s);
  const Index i = std::min<Index>(after - t_s_.begin(), last) - 1;
  const double h = t_s_[i + 1] - t_s_[i];
  const double s = (t_s - t_s_[i]) / h;
  const Eigen::RowVector2d q =
      (1 + 2 * s) * (1 - s) * (1 - s) * q_.row(i) + s * (1 - s) * (1 - s) * h * dq_.row(i) +
      s * s * (3 - 2 * s) * q_.row(i + 1) + s * s * (s - 1) * h * dq_.row(i + 1);
  const Eigen::RowVector2d dq = 6 * s * (1 - s) / h * (q_.row(i + 1) - q_.row(i)) +
                                (1 - s) * (1 - 3 * s) * dq_.row(i) +
                                s * (3 * s - 2) * dq_.row(i + 1);
  const Eigen::RowVector2d ddq = (1 - s) * ddq_.row(i) + s * ddq_.row(i + 1);
  return {q.transpose(), dq.transpose(), ddq.transpose()};
}

}  // namespace offnominal::tools::paper
