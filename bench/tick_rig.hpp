#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstddef>
#include <offnominal/control/computed_torque.hpp>
#include <offnominal/monitor.hpp>
#include <stdexcept>

// A monitor of an arm with what it is fed, for timing its tick.

namespace offnominal::bench {

inline constexpr std::size_t kSamples = 1024;  // a power of two; about one second of the motion

inline void require(Status status) {
  if (status != Status::kOk) throw std::runtime_error(name_of(status));
}

// The paper's two-link arm, and with more joints the same that goes on.
template <int N, typename Scalar>
MonitorConfig<N, Scalar> arm() {
  MonitorConfig<N, Scalar> config;
  config.chain.gravity_m_s2 = {0, static_cast<Scalar>(-9.81), 0};
  for (Joint<Scalar>& joint : config.chain.joints) {
    joint.centre_of_mass_m = {1, 0, 0};
    joint.origin_m = {1, 0, 0};
    joint.mass_kg = 2;
  }
  config.chain.joints[0].origin_m = {0, 0, 0};
  config.chain.joints[0].mass_kg = Scalar(0.5);
  config.bound.kind = BoundKind::kScaledNorm;
  config.bound.scale = static_cast<Scalar>(4.4);
  config.bound.matrix[0] = 2;
  config.bound.matrix[1] = -6;
  config.torque_signal = TorqueSignal::kHeld;
  config.max_compensation.fill(50);
  return config;
}

// The paper's motion with the torque that the model asks for, plus `extra_torque` on all joints: 0
// leaves the estimator in its dead-zone, 60 N m keeps it adapting.
template <int N, typename Scalar>
std::array<JointSample<N, Scalar>, kSamples> samples(const RigidBodyModel<N, Scalar>& model,
                                                     Scalar extra_torque) {
  std::array<JointSample<N, Scalar>, kSamples> result;
  for (std::size_t k = 0; k < kSamples; ++k) {
    const double t = 0.001 * static_cast<double>(k);
    Vector<N, Scalar> ddq;
    for (Eigen::Index i = 0; i < N; ++i) {
      const double amplitude = 0.18 + 0.03 * static_cast<double>(i);
      const double w = 2 + static_cast<double>(i);
      result[k].q[i] = static_cast<Scalar>(amplitude * std::sin(w * t));
      result[k].dq[i] = static_cast<Scalar>(amplitude * w * std::cos(w * t));
      ddq[i] = static_cast<Scalar>(-amplitude * w * w * std::sin(w * t));
    }
    result[k].tau = inverse_dynamics(model, result[k].q, result[k].dq, ddq, 0.0);
    result[k].tau.array() += extra_torque;
  }
  return result;
}

template <int N, int L, typename Scalar>
class TickRig {
 public:
  // As after one second. Throws std::runtime_error where it has then not found a fault that
  // `expect_adapting` says is there, or the other way round.
  TickRig(Scalar extra_torque, bool expect_adapting) {
    MonitorConfig<N, Scalar> config = arm<N, Scalar>();
    config.estimator.hidden_units = L;
    require(Watch::create(config, monitor_));
    samples_ = samples<N, Scalar>(monitor_.model(), extra_torque);
    require(monitor_.reset(samples_[0], state_));
    for (std::size_t k = 1; k < kSamples; ++k) require(step(k));
    if (output_.detector.latched != expect_adapting) throw std::runtime_error("not as expected");
  }

  [[nodiscard]] EIGEN_ALWAYS_INLINE Status step(std::size_t k) {
    return monitor_.step(samples_[k], state_, output_);
  }
  [[nodiscard]] const MonitorOutput<N, Scalar>& output() const { return output_; }

 private:
  using Watch = Monitor<N, L, Scalar>;
  Watch monitor_;
  typename Watch::State state_;
  typename Watch::Output output_;
  std::array<JointSample<N, Scalar>, kSamples> samples_;
};

}  // namespace offnominal::bench
