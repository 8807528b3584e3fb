// The bus of a run in lock-step, with the controller at one end and the plant at the other.
#pragma once

#include <memory>
#include <string>

#include "loop/bus_port.hpp"

namespace offnominal::desk::sil {

/// Time of both ends is the run's, not the machine's: set_time() moves it. What one end has sent,
/// the other finds at its next receive(), on a real bus too: receive() waits until it is there.
class Wire {
 public:
  virtual ~Wire() = default;
  virtual BusPort& controller() = 0;
  virtual BusPort& plant() = 0;
  virtual void set_time(hal::Microseconds now_us) = 0;
};

inline constexpr const char* kInProcess = "in-process";

/// The in-process bus.
[[nodiscard]] std::unique_ptr<Wire> make_in_process_wire();

/// A CAN interface of the kernel, both ends in this program, each with its own socket. Nobody else
/// may send on it. Throws InputError where there is no such interface, and its ports do where it
/// carries nothing for two seconds.
[[nodiscard]] std::unique_ptr<Wire> make_socketcan_wire(const std::string& interface);

}  // namespace offnominal::desk::sil
