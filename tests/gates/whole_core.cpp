#include "whole_core.hpp"

#include <cmath>
#include <limits>
#include <offnominal/diagnosis/detectability.hpp>
#include <offnominal/diagnosis/isolation.hpp>
#include <offnominal/model/mass_matrix.hpp>

namespace offnominal::gates {

namespace {

// What is measured at time t on a motion that follows its reference.
template <int N, int L, typename Scalar>
JointSample<N, Scalar> sample_at(const Controller<N, L, Scalar>& controller, Scalar t,
                                 Scalar fault_nm) {
  Reference<N, Scalar> reference;
  size_for(controller.monitor.model().bodies.size(), reference.q, reference.dq, reference.ddq);
  for (Eigen::Index i = 0; i < reference.q.size(); ++i) {
    const Scalar w = Scalar(2) + static_cast<Scalar>(i) / Scalar(4);
    reference.q[i] = Scalar(0.2) * (Scalar(1) - std::cos(w * t));
    reference.dq[i] = Scalar(0.2) * w * std::sin(w * t);
    reference.ddq[i] = Scalar(0.2) * w * w * std::cos(w * t);
  }
  JointSample<N, Scalar> sample;
  sample.q = reference.q;
  sample.dq = reference.dq;
  sample.tau = computed_torque(controller.monitor.model(), controller.gains, reference, sample.q,
                               sample.dq, static_cast<double>(t));
  sample.tau.array() += fault_nm;
  return sample;
}

}  // namespace

template <int N, int L, typename Scalar>
Status start(const MonitorConfig<N, Scalar>& config, const ComputedTorqueGains<N, Scalar>& gains,
             Controller<N, L, Scalar>& controller) {
  Status status = validate(gains);
  if (status != Status::kOk) return status;
  controller.gains = gains;
  status = Monitor<N, L, Scalar, WithMemory>::create(config, controller.monitor);
  if (status != Status::kOk) return status;
  return controller.monitor.reset(sample_at(controller, Scalar(0), Scalar(0)), controller.state);
}

template <int N, int L, typename Scalar>
Status run(Controller<N, L, Scalar>& controller, std::uint32_t ticks, Scalar fault_nm) {
  const Scalar period = controller.monitor.config().estimator.period_s;
  for (std::uint32_t tick = 0; tick < ticks; ++tick) {
    const Scalar t = static_cast<Scalar>(controller.state.tick + 1) * period;
    const JointSample<N, Scalar> sample = sample_at(controller, t, fault_nm);
    if (tick % 1000 == 999) {
      JointSample<N, Scalar> spoilt = sample;
      spoilt.dq[spoilt.dq.size() - 1] = std::numeric_limits<Scalar>::quiet_NaN();
      const Status refused = controller.monitor.step(spoilt, controller.state, controller.output);
      if (refused != Status::kNonFiniteVelocity) return refused;
    }
    const Status status = controller.monitor.step(sample, controller.state, controller.output);
    if (status != Status::kOk) return status;
    controller.last_torque = sample.tau[0] + controller.output.compensation.torque[0];
  }
  return Status::kOk;
}

template <int N, int L, typename Scalar>
double call_the_rest(const Controller<N, L, Scalar>& controller, const Vector<N, Scalar>& q) {
  const RigidBodyModel<N, Scalar>& model = controller.monitor.model();
  double sum = static_cast<double>(mass_matrix(model, q).trace());
  sum += static_cast<double>(bias_torque(model, q, q, 0.0).sum());
  sum += static_cast<double>(squared_norm(controller.state.estimator.weights));
  sum += detection_guaranteed(controller.output.error_norm, controller.output.threshold) ? 1 : 0;

  DetectorState<Scalar> detector = controller.state.detector;
  clear_latch(detector);
  sum += detector.latched ? 1 : 0;

  FaultClass fault;
  fault.margin = margin_for_constant_signs(4, static_cast<int>(model.bodies.size()));
  double delay_s = 0;
  if (detection_delay_bound(fault, delay_s) == Status::kOk) sum += delay_s;

  for (const Effect<Scalar>& effect : controller.monitor.config().chain.effects.view()) {
    const EffectInfo* info = info_of(effect.kind);
    if (info != nullptr) sum += static_cast<double>(info->parameters.size());
  }
  sum += static_cast<double>(*name_of(validate(controller.monitor.config().chain)));
  return sum;
}

#define OFFNOMINAL_GATE(N, L, Scalar)                                                  \
  template Status start<N, L, Scalar>(const MonitorConfig<N, Scalar>&,                 \
                                      const ComputedTorqueGains<N, Scalar>&,           \
                                      Controller<N, L, Scalar>&);                      \
  template Status run<N, L, Scalar>(Controller<N, L, Scalar>&, std::uint32_t, Scalar); \
  template double call_the_rest<N, L, Scalar>(const Controller<N, L, Scalar>&,         \
                                              const Vector<N, Scalar>&);

OFFNOMINAL_GATE(2, 35, float)
OFFNOMINAL_GATE(2, 35, double)
OFFNOMINAL_GATE(6, 35, float)
OFFNOMINAL_GATE(7, 64, float)
OFFNOMINAL_GATE(kRuntimeJoints, 35, double)

}  // namespace offnominal::gates

template class offnominal::Monitor<2, 35, float, offnominal::WithMemory>;
template class offnominal::Monitor<7, 64, float, offnominal::WithMemory>;
template class offnominal::Monitor<2, 35, float>;
template class offnominal::Monitor<2, 35, double>;
template class offnominal::Monitor<6, 35, float>;
template class offnominal::Monitor<7, 64, float>;
template class offnominal::Monitor<7, 64, float, offnominal::WithoutMemory,
                                   offnominal::TorqueSpace>;
template class offnominal::Monitor<2, 35, double, offnominal::WithMemory, offnominal::TorqueSpace>;
template class offnominal::Isolation<7, float>;
template class offnominal::Isolation<2, double>;
template class offnominal::Isolation<offnominal::kRuntimeJoints, double>;
