#pragma once

#include <cstdint>
#include <offnominal/controller/fault.hpp>
#include <offnominal/controller/sample_taker.hpp>
#include <offnominal/controller/takeover.hpp>
#include <offnominal/diagnosis/isolation_choice.hpp>
#include <offnominal/hal/messages.hpp>
#include <offnominal/monitor.hpp>

// All that a joint controller's tick changes.

namespace offnominal::controller {

using hal::ControllerState;

// Plain data, ready to be logged.
template <int N, int L, typename Scalar, typename Memory = WithoutMemory,
          typename Space = AccelerationSpace, typename Isolates = WithoutIsolation>
struct ControllerData : SampleData<N, Scalar>, TakeoverData<N, Scalar> {
  ControllerState state = ControllerState::kInit;
  Fault fault = Fault::kNone;
  std::uint64_t ticks = 0;           // since the start
  std::uint64_t run_ticks = 0;       // since time began
  std::uint32_t overruns = 0;        // ticks that began late, ever
  std::uint32_t missed_samples = 0;  // ticks without a fresh reading of every joint, ever
  std::uint32_t refused_frames = 0;  // that came with something wrong in them, ever
  std::uint32_t unsent_frames = 0;   // that the bus did not take, ever
  std::uint32_t late_ticks = 0;      // whole periods that this tick began too late
  std::uint16_t late_in_a_row = 0;   // ticks that did
  bool ends = false;                 // let_go() was called
  // Of `ticks`, the one in which the monitor came beyond the second level; 0: it has not.
  std::uint64_t act_tick = 0;
  bool slows = false;  // the reference, from slow_since of run_ticks until arm()
  std::uint64_t slow_since = 0;
  PerJoint<N, hal::TorqueCommand> commands{};
  JointTransforms<N, Scalar> transforms{};  // of the last sample that was watched
  MonitorState<N, L, Scalar, Memory, Space> monitor;
  MonitorOutput<N, Scalar, Space> output;
  [[no_unique_address]] typename Isolates::template Of<N, Scalar>::State isolation{};
};

}  // namespace offnominal::controller
