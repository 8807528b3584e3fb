#pragma once

#include <Eigen/Core>

#include "common/parallel.hpp"
#include "compare/filter_plan.hpp"
#include "log/log.hpp"

namespace offnominal::desk {

// The motion of a recording at its full sampling rate. Rows: samples, columns: joints.
struct Motion {
  Eigen::VectorXd t_s;  // as recorded
  Eigen::MatrixXd q;    // low-passed position, rad or m
  Eigen::MatrixXd dq;   // central differences of q
  Eigen::MatrixXd ddq;  // central differences of dq

  [[nodiscard]] Eigen::Index sample_count() const { return t_s.size(); }
  // On average, of two samples or more.
  [[nodiscard]] double period_s() const {
    const Eigen::Index last = sample_count() - 1;
    return (t_s[last] - t_s[0]) / static_cast<double>(last);
  }
  // `count` samples from `first` on.
  [[nodiscard]] Motion part(Eigen::Index first, Eigen::Index count) const {
    return {t_s.segment(first, count), q.middleRows(first, count), dq.middleRows(first, count),
            ddq.middleRows(first, count)};
  }
};

// Calls work(first, count) for stretches of a motion for which a model is evaluated, side by side
// where it is long enough: a sample of an arm takes some microseconds.
template <typename Work>
void for_stretches(const Motion& motion, const Work& work) {
  constexpr Eigen::Index kMost = 1 << 12;    // of a stretch: no more is kept of what one needs
  constexpr Eigen::Index kWorthIt = 30'000;  // numbers, some milliseconds
  parallel_parts(motion.sample_count(), kMost, threads_for(motion.q.size(), kWorthIt), work);
}

// Velocity and acceleration both come from the low-passed position, whatever velocity the log has:
// then all three belong together, and none of them lags. Of a hold map: its positions, at rest.
Motion motion_of(const Log& log, const FilterPlan& plan);

// The same of one joint, one column each, and of every so many-th sample alone: of a long recording
// the whole motion is as large as the recording.
struct JointMotion {
  Eigen::VectorXd q, dq, ddq;
};
JointMotion motion_of_joint(const Log& log, const FilterPlan& plan, Eigen::Index joint);
Motion thin_motion_of(const Log& log, const FilterPlan& plan, Eigen::Index stride);

}  // namespace offnominal::desk
