// Body of run_closed_loop(); included only where it is instantiated.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include "common/error.hpp"
#include "paper/closed_loop.hpp"

namespace offnominal::desk::paper {
namespace detail {

inline void require_ok(Status status, const std::string& place, const std::string& mend) {
  if (status == Status::kOk) return;
  throw InputError({.file = "offnominal paper",
                    .place = place,
                    .found = std::string("status ") + name_of(status),
                    .allowed = "",
                    .mend = mend});
}

// Computed torque and what is given beside it, held to what the joints' drives can give.
template <typename Scalar>
[[nodiscard]] Vector<2, Scalar> drive_torque(const ControllerSetup<Scalar>& setup,
                                             const RigidBodyModel<2, Scalar>& model, double time_s,
                                             const sim::DesiredMotion& desired,
                                             const sim::TwoLinkState& state,
                                             const Vector<2, Scalar>& beside) {
  const Reference<2, Scalar> reference{desired.q.cast<Scalar>(), desired.dq.cast<Scalar>(),
                                       desired.ddq.cast<Scalar>()};
  Vector<2, Scalar> tau =
      computed_torque<2, Scalar>(model, setup.gains, reference, state.q.cast<Scalar>(),
                                 state.dq.cast<Scalar>(), time_s) +
      beside;
  for (int i = 0; i < 2; ++i) {
    const Scalar limit = setup.monitor.chain.joints[static_cast<std::size_t>(i)].max_torque;
    tau[i] = std::clamp(tau[i], -limit, limit);
  }
  return tau;
}

}  // namespace detail

template <int Capacity, typename Scalar>
void run_closed_loop(const ControllerSetup<Scalar>& setup, const sim::TwoLinkPlant& plant,
                     const LoopTiming& timing, const DesiredAt& desired_at,
                     const TickObserver& observe) {
  using LoopMonitor = Monitor<2, Capacity, Scalar, WithMemory>;
  LoopMonitor monitor;
  detail::require_ok(LoopMonitor::create(setup.monitor, monitor), "robot and options",
                     "correct the setting that the status names");
  detail::require_ok(validate(setup.gains), "control gains", "give kp and kd of at least 0");

  sim::TwoLinkState state{desired_at(0.0).q, desired_at(0.0).dq};
  Vector<2, Scalar> tau = detail::drive_torque(setup, monitor.model(), 0.0, desired_at(0.0), state,
                                               Vector<2, Scalar>::Zero().eval());
  const auto monitor_state = std::make_unique<typename LoopMonitor::State>();
  typename LoopMonitor::Output output;
  detail::require_ok(
      monitor.reset({state.q.cast<Scalar>(), state.dq.cast<Scalar>(), tau}, *monitor_state),
      "start of the run", "use fewer hidden units, a smaller initial weight range or a larger M");

  for (std::int64_t tick = 1; tick <= timing.ticks; ++tick) {
    const double begin_s = static_cast<double>(tick - 1) * timing.period_s;
    TickRecord record;
    record.tick = tick;
    record.time_s = static_cast<double>(tick) * timing.period_s;
    record.tau = tau.template cast<double>();
    state = plant.step(begin_s, state, record.tau, timing.period_s, timing.plant_substeps);
    detail::require_ok(
        monitor.step({state.q.cast<Scalar>(), state.dq.cast<Scalar>(), tau}, *monitor_state,
                     output),
        "closed loop after " + std::to_string(tick) + " ticks",
        "the arm has left the range that the robot file gives it: take a shorter step, a "
        "smaller fault or wider joint limits");
    record.state = {state.q, state.dq};
    const sim::DesiredMotion desired = desired_at(record.time_s);
    record.q_desired = desired.q;
    record.psi = plant.fault_function(record.time_s, state, record.tau);
    record.psi_hat = output.psi_hat.template cast<double>();
    record.error_norm = static_cast<double>(output.error_norm);
    record.threshold = static_cast<double>(output.threshold);
    record.weight_norm =
        std::sqrt(static_cast<double>(squared_norm(monitor_state->estimator.weights)));
    record.detected = output.detector.latched;
    record.acts = output.detector.acts;
    observe(record);
    tau =
        detail::drive_torque<Scalar>(setup, monitor.model(), record.time_s, desired, state,
                                     output.compensation.torque + monitor_state->memory.remembered);
  }
}

#define OFFNOMINAL_INSTANTIATE_CLOSED_LOOP(capacity, Scalar)                                   \
  template void run_closed_loop<capacity, Scalar>(const ControllerSetup<Scalar>&,              \
                                                  const sim::TwoLinkPlant&, const LoopTiming&, \
                                                  const DesiredAt&, const TickObserver&)

}  // namespace offnominal::desk::paper
