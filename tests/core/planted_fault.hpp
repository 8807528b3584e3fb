#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <offnominal/diagnosis/isolation.hpp>
#include <offnominal/model/inverse_dynamics.hpp>
#include <offnominal/monitor.hpp>
#include <random>

#include "core/model/random_chain.hpp"

namespace offnominal::test {

inline constexpr double kPlantedAtS = 3;
inline constexpr double kPlantedPeriodS = 0.001;
inline constexpr double kPlantedBound = 0.5;  // N m or N

// Which fault a robot gets at kPlantedAtS; size as FaultKind says, of a contact per joint.
struct PlantedFault {
  FaultKind kind = FaultKind::kUnknown;
  Eigen::Index joint = 0;
  double size = 0;
};

// A chain on given sines whose drives give exactly what its model needs for them, and what the
// fault makes of it, but for a little noise.
template <int N>
class PlantedRobot {
 public:
  using Values = Vector<N, double>;

  PlantedRobot(std::mt19937_64& generator, const PlantedFault& fault)
      : fault_(fault), generator_(generator) {
    config.chain = random_chain<N, double>(generator);
    for (auto& joint : config.chain.joints) {
      joint.type = JointType::kRevolute;
      joint.max_velocity = 3;
    }
    config.chain.gravity_m_s2 = {0, 0, -9.81};
    config.estimator.period_s = kPlantedPeriodS;
    config.estimator.hidden_units = 6;
    for (auto& joint : config.bound.joints) joint.value[0] = kPlantedBound;
    model_ = make_model(config.chain);
    auto loaded = config.chain;
    EXPECT_TRUE(
        loaded.effects.add({EffectKind::kTipPayload, N - 1, {fault.size, 0.03, -0.02, 0.1}}));
    loaded_ = make_model(loaded);
    for (Eigen::Index i = 0; i < N; ++i) {
      rate_[i] = uniform(generator, 2, 5);
      phase_[i] = uniform(generator, 0, 2 * std::numbers::pi);
      push_[i] = uniform(generator, 0.6, 1) * (uniform(generator, -1, 1) > 0 ? 1 : -1);
    }
  }

  [[nodiscard]] JointSample<N, double> sample(std::uint64_t tick) {
    const double t = static_cast<double>(tick) * kPlantedPeriodS;
    Values q;
    Values dq;
    Values ddq;
    for (Eigen::Index i = 0; i < N; ++i) {
      const double angle = rate_[i] * t + phase_[i];
      q[i] = 0.4 * std::sin(angle);
      dq[i] = 0.4 * rate_[i] * std::cos(angle);
      ddq[i] = -0.4 * rate_[i] * rate_[i] * std::sin(angle);
    }
    const Values needed = inverse_dynamics(model_, q, dq, ddq, t);
    JointSample<N, double> sample{q, dq, needed};
    if (t >= kPlantedAtS && t < over_at_s) spoil(t, ddq, sample);
    if (t >= kPlantedAtS - 0.4) sample.tau[fault_.joint] += error_before;
    beside = needed - sample.tau;
    std::normal_distribution<double> noise(0, 0.01);
    for (double& torque : sample.tau) torque += noise(generator_);
    return sample;
  }

  // No joint moves, whatever happens.
  void stand() { rate_.setZero(); }

  MonitorConfig<N, double, TorqueSpace> config;
  // What acted on the joints beside the model at the last sample, N m or N; of a fault of the
  // encoder it means nothing.
  Values beside = Values::Zero();
  double over_at_s = 1e9;   // from when on the fault is gone
  double error_before = 0;  // of the model, from 0.4 s before the fault on, N m or N

 private:
  void spoil(double t, const Values& ddq, JointSample<N, double>& sample) {
    const Eigen::Index j = fault_.joint;
    switch (fault_.kind) {
      case FaultKind::kFriction:
        sample.tau[j] += fault_.size * (sample.dq[j] > 0 ? 1 : -1);
        break;
      case FaultKind::kLostTorque:
        sample.tau[j] /= 1 - fault_.size;
        break;
      case FaultKind::kOffset:
        sample.tau[j] -= fault_.size;
        break;
      case FaultKind::kPayload:
        sample.tau = inverse_dynamics(loaded_, sample.q, sample.dq, ddq, t);
        break;
      case FaultKind::kContact:
        if (t < kPlantedAtS + 0.2) sample.tau.head(j + 1) -= fault_.size * push_.head(j + 1);
        break;
      case FaultKind::kEncoderJump:
        sample.q[j] += fault_.size;
        break;
      case FaultKind::kEncoderStuck:
        stop(sample);
        break;
      case FaultKind::kLockedJoint:
        lock(t, ddq, sample);
        break;
      case FaultKind::kUnknown:
        // Friction of two joints at once.
        sample.tau[j] += fault_.size * (sample.dq[j] > 0 ? 1 : -1);
        sample.tau[j / 2] += fault_.size * (sample.dq[j / 2] > 0 ? 1 : -1);
        break;
    }
  }
  void stop(JointSample<N, double>& sample) {
    if (!stopped_) held_ = sample.q[fault_.joint];
    stopped_ = true;
    sample.q[fault_.joint] = held_;
    sample.dq[fault_.joint] = 0;
  }
  // Brought to rest within ten ticks; the others do as before, and their drives what that takes.
  void lock(double t, Values ddq, JointSample<N, double>& sample) {
    constexpr double kStopsWithinS = 0.01;
    const Eigen::Index j = fault_.joint;
    const double given = sample.tau[j] + fault_.size * (t - kPlantedAtS);
    if (!stopped_) {
      held_ = sample.q[j];
      speed_ = sample.dq[j];
      stopped_ = true;
    }
    const double s = std::min(t - kPlantedAtS, kStopsWithinS);
    sample.q[j] = held_ + speed_ * (s - s * s / (2 * kStopsWithinS));
    sample.dq[j] = speed_ * (1 - s / kStopsWithinS);
    ddq[j] = s < kStopsWithinS ? -speed_ / kStopsWithinS : 0;
    sample.tau = inverse_dynamics(model_, sample.q, sample.dq, ddq, t);
    sample.tau[j] = given;
  }

  PlantedFault fault_;
  std::mt19937_64& generator_;
  RigidBodyModel<N, double> model_;
  RigidBodyModel<N, double> loaded_;
  Values rate_ = Values::Zero();
  Values phase_ = Values::Zero();
  Values push_ = Values::Zero();
  bool stopped_ = false;
  double held_ = 0;
  double speed_ = 0;
};

}  // namespace offnominal::test
