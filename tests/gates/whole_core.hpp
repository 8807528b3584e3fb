#pragma once

#include <cstdint>
#include <offnominal/control/computed_torque.hpp>
#include <offnominal/monitor.hpp>

namespace offnominal::gates {

// What a joint controller holds.
template <int N, int L, typename Scalar>
struct Controller {
  Monitor<N, L, Scalar, WithMemory> monitor;
  MonitorState<N, L, Scalar, WithMemory> state;
  MonitorOutput<N, Scalar> output;
  ComputedTorqueGains<N, Scalar> gains;
  Scalar last_torque{};  // of joint 1, after accommodation, N m
};

// Checks, creates and resets. The first refusal, else kOk.
template <int N, int L, typename Scalar>
[[nodiscard]] Status start(const MonitorConfig<N, Scalar>& config,
                           const ComputedTorqueGains<N, Scalar>& gains,
                           Controller<N, L, Scalar>& controller);

// Runs `ticks` ticks on a smooth motion that follows its reference; `fault_nm` is added to the
// applied torque of every joint. Samples that cannot be used are mixed in: every 1000th one is NaN.
// The first unexpected status, else kOk.
template <int N, int L, typename Scalar>
[[nodiscard]] Status run(Controller<N, L, Scalar>& controller, std::uint32_t ticks,
                         Scalar fault_nm);

// What a controller calls outside of its tick; the sum keeps the calls alive.
template <int N, int L, typename Scalar>
[[nodiscard]] double call_the_rest(const Controller<N, L, Scalar>& controller,
                                   const Vector<N, Scalar>& q);

}  // namespace offnominal::gates
