#pragma once

#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <offnominal/hal/bus/socketcan.hpp>
#include <string>
#include <thread>
#include <vector>

#include "support/raw_can.hpp"

namespace offnominal::hal {

inline constexpr Microseconds kSecond = 1'000'000;

inline void open_or_fail(SocketCan& bus, const SocketCanConfig& config) {
  ASSERT_EQ(bus.open(config), Status::kOk)
      << config.interface << ": " << std::strerror(bus.error_number())
      << "; these tests run in ./dev vcan --controller, as ./dev test runs them";
}

inline Frame classic(std::uint32_t id, std::vector<int> data) {
  Frame frame;
  frame.id = id;
  frame.length = static_cast<std::uint8_t>(data.size());
  for (std::size_t i = 0; i < data.size(); ++i) frame.data[i] = static_cast<std::uint8_t>(data[i]);
  return frame;
}

// Calls receive() until as many frames have come as are wanted, or ten seconds have passed.
inline std::vector<ReceivedFrame> receive_some(SocketCan& bus, std::size_t wanted) {
  std::vector<ReceivedFrame> found;
  const Microseconds end_us = bus.now() + 10 * kSecond;
  while (found.size() < wanted && bus.now() < end_us) {
    std::array<ReceivedFrame, 7> frames;
    const std::size_t count = bus.receive(frames);
    found.insert(found.end(), frames.begin(), frames.begin() + static_cast<std::ptrdiff_t>(count));
    if (count == 0) std::this_thread::sleep_for(std::chrono::milliseconds{1});
  }
  return found;
}

// Calls receive() until the bus is in that mode, or ten seconds have passed.
[[nodiscard]] inline bool becomes(SocketCan& bus, BusMode mode) {
  const Microseconds end_us = bus.now() + 10 * kSecond;
  std::array<ReceivedFrame, 8> frames;
  while (bus.now() < end_us) {
    static_cast<void>(bus.receive(frames));
    if (bus.state().mode == mode) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds{1});
  }
  return false;
}

inline void run_command(const std::string& command) {
  ASSERT_EQ(std::system(command.c_str()), 0) << command;
}

// What a controller says of itself, as its driver would hand it up.
inline test::RawFrame error_report(canid_t kind, int controller = 0) {
  return test::raw_frame(CAN_ERR_FLAG | kind, {0, controller, 0, 0, 0, 0, 0, 0});
}

}  // namespace offnominal::hal
