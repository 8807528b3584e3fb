#include "recorded_run.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>

#include "offnominal/sim/trajectory.hpp"
#include "targets/arm_on_bus.hpp"

namespace offnominal::test {
namespace {

constexpr std::size_t kRecordedTicks = 20'000;

// What the encoders and drives have sent since the last call.
void take_frames(hal::InProcessNet<3>& net, cortex_m::ReplayTick& tick) {
  auto port = net.port(2);
  std::array<hal::ReceivedFrame, 16> frames;
  const std::size_t count = port.receive(frames);
  for (std::size_t i = 0; i < count; ++i) {
    const hal::Frame& frame = frames[i].frame;
    hal::Address address;
    if (address_of(frame, address) != hal::Status::kOk) continue;
    const bool measured = address.kind == hal::MessageKind::kEncoder ||
                          address.kind == hal::MessageKind::kDriveStatus;
    if (!measured) continue;
    if (tick.frame_count == tick.frames.size()) throw std::logic_error("too many frames");
    cortex_m::ReplayFrame& into = tick.frames[tick.frame_count++];
    into.id = frame.id;
    into.length = frame.length;
    std::copy_n(frame.data.begin(), into.data.size(), into.data.begin());
  }
}

void set_reference(double time_s, cortex_m::ReplayTick& tick) {
  const sim::DesiredMotion desired = sim::paper_trajectory(time_s);
  for (std::size_t j = 0; j < cortex_m::kReplayJoints; ++j) {
    const auto i = static_cast<Eigen::Index>(j);
    tick.q[j] = desired.q[i];
    tick.dq[j] = desired.dq[i];
    tick.ddq[j] = desired.ddq[i];
  }
}

}  // namespace

std::vector<cortex_m::ReplayTick> recorded_run(sim::FaultKind kind) {
  ArmOnBus arm({.kind = kind});
  std::vector<cortex_m::ReplayTick> run;
  // Armed in the tick after which it is passive, as ReplayRun does.
  for (bool armed = false; run.size() < kRecordedTicks;) {
    cortex_m::ReplayTick& tick = run.emplace_back();
    const double time_s = armed ? 0.001 * static_cast<double>(arm.data->run_ticks + 1) : 0.0;
    set_reference(arm.data->monitor.initialised ? time_s : 0.0, tick);
    arm.tick();
    take_frames(arm.net, tick);
    if (!armed && arm.data->state == hal::ControllerState::kPassive) {
      armed = arm.arm() == controller::Fault::kNone;
    }
  }
  if (arm.data->state != hal::ControllerState::kArmed) throw std::logic_error("not armed");
  return run;
}

}  // namespace offnominal::test
