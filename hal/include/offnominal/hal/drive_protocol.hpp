#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <offnominal/hal/bus/frame.hpp>
#include <offnominal/hal/messages.hpp>
#include <offnominal/hal/source.hpp>
#include <offnominal/hal/status.hpp>
#include <span>

namespace offnominal::hal {

// What a controller knows of one joint.
struct JointFeedback {
  SourceState encoder = SourceState::kNeverSeen;
  SourceState drive = SourceState::kNeverSeen;
  Microseconds encoder_time_us = 0;  // when the newest reading came
  EncoderReading reading;
  DriveStatus status;
};

// Of what has come in since the start, as far as a protocol can tell; they wrap.
struct DriveCounts {
  std::uint64_t lost = 0;      // by the counters of accepted records
  std::uint64_t rejected = 0;  // wrong CRC, value or counter
};

// How drives speak on the bus, as the controller sees it. Nothing blocks, allocates or throws.
//
// take(f)                  A frame that has come. kOk: used. kUnknownId: none of this protocol's.
//                          Otherwise why it was refused; it has changed no more than the counters.
// feedback(j, now)         Joint j, from 0.
// outgoing(c, h, into)     The frames of one tick, one command per joint and, when it is due, the
//                          heartbeat; returns how many, at most kMaxOutgoing. A command that the
//                          protocol cannot carry is sent as DriveMode::kOff.
// report(d, into)          The frame that tells all others what a monitor found that judges by
//                          joint, or which fault it is; false where the protocol has none, or
//                          cannot carry it.
// drive_max_age_us()       How old a drive's status may be before it is stale: a change of its mode
//                          stays unseen no longer.
// stop_seen(), clear_stop()  Whether somebody has asked for an emergency stop; latched until
//                          cleared.
// counts()                 For reports; zero where frames carry neither counter nor CRC.
template <typename P>
concept DriveProtocol = requires(P& drives, const P& seen, const ReceivedFrame& received,
                                 std::size_t joint, Microseconds now_us,
                                 std::span<const TorqueCommand> commands,
                                 const Heartbeat& heartbeat, std::span<Frame> into,
                                 const Diagnosis& diagnosis, const FaultReport& fault,
                                 Frame& frame) {
  { P::kJoints } -> std::convertible_to<std::size_t>;
  { P::kMaxOutgoing } -> std::convertible_to<std::size_t>;
  { drives.take(received) } -> std::same_as<Status>;
  { seen.feedback(joint, now_us) } -> std::same_as<JointFeedback>;
  { drives.outgoing(commands, heartbeat, into) } -> std::same_as<std::size_t>;
  { drives.report(diagnosis, frame) } -> std::same_as<bool>;
  { drives.report(fault, frame) } -> std::same_as<bool>;
  { seen.drive_max_age_us() } -> std::same_as<Microseconds>;
  { seen.stop_seen() } -> std::same_as<bool>;
  { drives.clear_stop() } -> std::same_as<void>;
  { seen.counts() } -> std::same_as<DriveCounts>;
};

// One that serves somebody who only listens, too:
//
// overhear(f)              A frame of the controller's that tells what no drive says itself. As
//                          take(); kUnknownId where the protocol has none.
template <typename P>
concept OverheardProtocol = DriveProtocol<P> && requires(P& drives, const ReceivedFrame& received) {
  { drives.overhear(received) } -> std::same_as<Status>;
};

// A heartbeat goes out every so many ticks, and half as many later a diagnosis; where their 32 bits
// wrap, once in 49 days at 1 kHz, one comes earlier.
inline constexpr std::uint32_t kHeartbeatTicks = 10;
// The node number of the controller itself.
inline constexpr std::uint8_t kControllerNode = 31;

}  // namespace offnominal::hal
