#pragma once

#include <linux/can.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <offnominal/hal/bus/frame.hpp>
#include <offnominal/hal/bus/socketcan.hpp>
#include <offnominal/hal/status.hpp>

namespace offnominal::hal {

inline constexpr std::size_t kMostFilters = 64;

// Closes the socket that it was given, when it ends.
class OwnedSocket {
 public:
  explicit OwnedSocket(int socket) : socket_(socket) {}
  OwnedSocket(const OwnedSocket&) = delete;
  OwnedSocket& operator=(const OwnedSocket&) = delete;
  OwnedSocket(OwnedSocket&&) = delete;
  OwnedSocket& operator=(OwnedSocket&&) = delete;
  ~OwnedSocket();
  [[nodiscard]] int get() const { return socket_; }

 private:
  int socket_;
};

// Microseconds of one of the system's clocks.
[[nodiscard]] Microseconds clock_us(int clock);

// The frame in the kernel's words; returns the size to be written.
[[nodiscard]] std::size_t to_kernel(const Frame& frame, canfd_frame& raw);
// False for what is none: another size, a length beyond what there is.
[[nodiscard]] bool from_kernel(const canfd_frame& raw, std::size_t size, Frame& frame);

// Opens a raw socket on the interface, non-blocking, with everything set that SocketCan needs.
// kOk: `socket` is open. Otherwise it is -1, and errno tells why.
[[nodiscard]] Status open_raw_socket(const SocketCanConfig& config, int& socket);

// Whether the interface is up; whether it takes CAN FD.
[[nodiscard]] bool is_interface_up(int socket, const char* interface);
[[nodiscard]] bool takes_can_fd(int socket, const char* interface);

}  // namespace offnominal::hal
