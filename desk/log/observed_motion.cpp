#include "log/observed_motion.hpp"

#include <fmt/format.h>

#include "common/error.hpp"
#include "log/part_of.hpp"

namespace offnominal::desk {

using Eigen::Index;

MotionObserver::MotionObserver(Index joints, double period_s)
    : config_(velocity_observer_config(period_s)), joints_(static_cast<std::size_t>(joints)) {
  size_for(joints_.size(), sample_.q, sample_.dq, sample_.tau);
}

const MotionObserver::Sample* MotionObserver::take(const Eigen::VectorXd& q,
                                                   const Eigen::VectorXd& tau) {
  bool settled = true;
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    const auto i = static_cast<Index>(j);
    ObservedMotion<double> motion;
    const Status status = observe(config_, q[i], tau[i], 0, joints_[j], motion);
    sample_.q[i] = motion.position;
    sample_.dq[i] = motion.velocity;
    sample_.tau[i] = motion.torque;
    settled = settled && status == Status::kOk && is_settled(config_, joints_[j].observer);
  }
  return settled ? &sample_ : nullptr;
}

Index MotionObserver::ticks_to_settle() const {
  VelocityObserverState<double> state;
  while (!is_settled(config_, state)) ++state.updates;
  return state.updates - 1;
}

Log as_observed(const Log& log) {
  MotionObserver observer(log.q.cols(), log.period_s);
  Log observed = log;
  observed.readings = log.q;
  Index first = 0;
  for (Index row = 0; row < log.sample_count(); ++row) {
    const auto* const sample = observer.take(log.q.row(row), log.tau.row(row));
    if (sample == nullptr) {
      first = row + 1;
      continue;
    }
    observed.q.row(row) = sample->q;
    observed.dq.row(row) = sample->dq;
    observed.tau.row(row) = sample->tau;
  }
  if (first >= log.sample_count()) {
    throw InputError({.file = log.file,
                      .place = "velocities",
                      .found = fmt::format("{} samples", log.sample_count()),
                      .allowed = fmt::format("more than {}, behind which an observer has settled",
                                             observer.ticks_to_settle()),
                      .mend = "take a longer recording, or the velocities as they were recorded"});
  }
  observed = part_of(observed, {first, log.sample_count() - 1});
  observed.dq_derived.assign(log.dq_derived.size(), false);
  observed.remarks.push_back(
      fmt::format("velocities as a controller observes them of positions, two poles at {:.4g} "
                  "rad/s; positions and torques behind the same poles",
                  observer.bandwidth_rad_s()));
  return observed;
}

}  // namespace offnominal::desk
