#include "explain/expected_torque.hpp"

#include <algorithm>
#include <cmath>

#include "compare/inverse_model.hpp"
#include "compare/motion.hpp"

namespace offnominal::desk {

using Eigen::Index;

ExpectedTorque::ExpectedTorque(const Log& even, const RobotDescription& robot, Index most_samples)
    : samples_(even.sample_count()),
      stride_(std::max<Index>(1, even.sample_count() / most_samples)),
      from_s_(even.t_s[0]),
      period_s_(even.period_s) {
  FilterPlan plan;
  plan.sample_rate_hz = even.sample_rate_hz();
  plan.position_cutoff_hz = cutoff_hz(even);
  torque_ = model_torque(robot, thin_motion_of(even, plan, stride_));
}

double ExpectedTorque::cutoff_hz(const Log& even) {
  constexpr double kHz = 10;
  constexpr double kOfRate = 0.2;
  return std::min(kHz, kOfRate * even.sample_rate_hz());
}

double ExpectedTorque::at(double t_s, Index joint) const {
  return torque_(std::min(sample_at(t_s) / stride_, torque_.rows() - 1), joint);
}

Eigen::VectorXd ExpectedTorque::torque_beyond(const Log& log, Index joint) const {
  Eigen::VectorXd beyond = log.tau.col(joint);
  for (Index i = 0; i < beyond.size(); ++i) beyond[i] -= at(log.t_s[i], joint);
  return beyond;
}

double ExpectedTorque::change_during(double from_s, double to_s, Index joint) const {
  const Index first = std::min(sample_at(from_s) / stride_ + 1, torque_.rows() - 1);
  const Index last = std::min(sample_at(to_s) / stride_, torque_.rows() - 1);
  if (last <= first) return 0;
  const auto during = torque_.col(joint).segment(first, last + 1 - first);
  return during.maxCoeff() - during.minCoeff();
}

double ExpectedTorque::lasting_change_during(double from_s, double to_s, Index joint) const {
  constexpr Index kParts = 8;
  const Index first = std::min(sample_at(from_s) / stride_ + 1, torque_.rows() - 1);
  const Index count = std::min(sample_at(to_s) / stride_, torque_.rows() - 1) + 1 - first;
  if (count < kParts) return change_during(from_s, to_s, joint);
  Eigen::Array<double, kParts, 1> means;
  for (Index part = 0; part < kParts; ++part) {
    const Index begin = first + part * count / kParts;
    const Index end = first + (part + 1) * count / kParts;
    means[part] = torque_.col(joint).segment(begin, end - begin).mean();
  }
  const auto inner = means.segment<kParts - 2>(1);
  return inner.maxCoeff() - inner.minCoeff();
}

Index ExpectedTorque::sample_at(double t_s) const {
  return std::clamp<Index>(std::lround((t_s - from_s_) / period_s_), 0, samples_ - 1);
}

}  // namespace offnominal::desk
