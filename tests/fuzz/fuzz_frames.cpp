// Frames as they come off a bus on which anything may be: both ends take them one after the other.
// 5 bytes of input a frame at least: time step, flags, length, identifier, data. Nothing may be
// read beyond a frame, and what is taken has a right CRC by a division of its own. The CAN Simple
// driver, whose frames have none, takes the same: what it makes of them is finite.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <offnominal/hal/protocols/can_simple/can_simple.hpp>
#include <offnominal/hal/protocols/protected/protected_drives.hpp>

#include "hal/bitwise_crc.hpp"
#include "offnominal/sim/bus/joint_drives.hpp"

namespace {

using namespace offnominal::hal;

// The next frame of the input.
Frame frame_of(const std::uint8_t* data, std::size_t size, std::size_t& used) {
  Frame frame;
  const unsigned flags = data[1];
  frame.fd = (flags & 1U) != 0;
  frame.extended = (flags & 2U) != 0;
  frame.remote = (flags & 4U) != 0;
  frame.length = data[2];
  frame.id = data[3] | (static_cast<std::uint32_t>(data[4]) << 8U);
  used = 5 + std::min<std::size_t>({frame.length, frame.data.size(), size - 5});
  std::copy(data + 5, data + used, frame.data.begin());
  // A record of the input's own that is right, so that more than the CRC is tried.
  if ((flags & 8U) != 0) {
    Address address;
    if (address_of(frame, address) == Status::kOk) {
      for (std::size_t i = 0; i < address.count; ++i) {
        Content content;
        std::copy_n(frame.data.begin() + static_cast<std::ptrdiff_t>(8 * i), content.size(),
                    content.begin());
        const auto node = static_cast<std::uint8_t>(address.first_node + i);
        const Record record =
            seal(content, frame.data[8 * i + kCounterByte], data_id_of(address.kind, node));
        std::copy(record.begin(), record.end(),
                  frame.data.begin() + static_cast<std::ptrdiff_t>(8 * i));
      }
    }
  }
  return frame;
}

bool divides(const Frame& frame, const Address& address, std::size_t index) {
  const auto record = record_in(frame, index);
  const auto node = static_cast<std::uint8_t>(address.first_node + index);
  const unsigned check =
      offnominal::test::bitwise_crc(record.first<6>(), data_id_of(address.kind, node));
  return check == (static_cast<unsigned>(record[6]) << 8U | record[7]);
}

// What is decoded is what was encoded, to the bit.
template <typename Message>
void check_report(MessageKind kind, const Frame& frame, const Address& address) {
  if (address.kind != kind) return;
  const std::uint16_t id = data_id_of(address.kind, address.first_node);
  Message found;
  std::uint8_t counter = 0;
  if (decode(record_in(frame, 0), id, found, counter) != Status::kOk) return;
  Record again{};
  const bool encodes = encode(found, counter, id, again) == Status::kOk;
  if (!encodes || !std::equal(again.begin(), again.end(), frame.data.begin())) std::abort();
}

using Odrives = CanSimpleDrives<2>;

void check_odrives(const Frame& frame, Microseconds now_us, Odrives& drives) {
  static_cast<void>(drives.take({frame, now_us}));
  for (std::size_t j = 0; j < 2; ++j) {
    const JointFeedback feedback = drives.feedback(j, now_us);
    const bool finite = std::isfinite(feedback.reading.position) &&
                        std::isfinite(feedback.reading.velocity) &&
                        std::isfinite(feedback.status.applied_torque);
    if (!finite) std::abort();
  }
  const TorqueCommand command{(now_us & 1U) != 0 ? DriveMode::kTorque : DriveMode::kOff, 0.0F};
  std::array<Frame, Odrives::kMaxOutgoing> frames;
  const std::size_t count = drives.outgoing(std::array{command, command}, {}, frames);
  for (std::size_t i = 0; i < count; ++i) {
    if (!is_well_formed(frames[i])) std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr SourceConfig kSource{};
  ProtectedDrives<7> controller(kSource, kSource, FrameFormat::kFd);
  offnominal::sim::JointDrives drives(7, {}, FrameFormat::kFd);
  Odrives odrives({.torque_interval_us = 1000},
                  {{{0, 1.0F, CanSimpleFirmware::k05, 0.05F}, {1, -0.1F}}});
  Microseconds now_us = 0;
  while (size >= 5) {
    now_us += 101 * data[0];
    std::size_t used = 0;
    const Frame frame = frame_of(data, size, used);
    data += used;
    size -= used;
    const bool was_stopped = controller.stop_seen();
    std::uint32_t before = 0;
    std::uint32_t after = 0;
    for (std::size_t j = 0; j < 7; ++j) before += controller.encoder_source(j).accepted;
    const Status status = controller.take({frame, now_us});
    for (std::size_t j = 0; j < 7; ++j) after += controller.encoder_source(j).accepted;
    drives.take({frame, now_us});
    drives.tick(now_us);
    check_odrives(frame, now_us, odrives);
    Address address;
    const bool ours = address_of(frame, address) == Status::kOk;
    if (!ours && (status == Status::kOk || after != before)) std::abort();
    if (ours) {
      check_report<Diagnosis>(MessageKind::kDiagnosis, frame, address);
      check_report<FaultReport>(MessageKind::kFault, frame, address);
    }
    if (status == Status::kOk && address.kind == MessageKind::kEmergencyStop &&
        !divides(frame, address, 0)) {
      std::abort();
    }
    if (!was_stopped && controller.stop_seen() && address.kind != MessageKind::kEmergencyStop) {
      std::abort();
    }
    for (std::size_t j = 0; j < 7; ++j) {
      const JointFeedback feedback = controller.feedback(j, now_us);
      const bool finite = feedback.reading.position > -33.0F && feedback.reading.position < 33.0F;
      if (!finite) std::abort();
      if (!(drives.torque_nm(j, 0.0) >= -1000.0 && drives.torque_nm(j, 0.0) <= 1000.0))
        std::abort();
    }
  }
  return 0;
}
