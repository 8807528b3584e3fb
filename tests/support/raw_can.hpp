#pragma once

#include <gtest/gtest.h>
#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <initializer_list>
#include <optional>
#include <string>

namespace offnominal::test {

// What a raw socket reads and writes. `size`: CAN_MTU or CANFD_MTU.
struct RawFrame {
  canfd_frame frame{};
  std::size_t size = CAN_MTU;
};

[[nodiscard]] inline RawFrame raw_frame(canid_t id, std::initializer_list<int> data) {
  RawFrame made;
  made.frame.can_id = id;
  for (const int byte : data) made.frame.data[made.frame.len++] = static_cast<__u8>(byte);
  return made;
}

[[nodiscard]] inline RawFrame raw_fd_frame(canid_t id, std::size_t length, int fill) {
  RawFrame made;
  made.size = CANFD_MTU;
  made.frame.can_id = id;
  made.frame.len = static_cast<__u8>(length);
  std::memset(made.frame.data, fill, length);
  return made;
}

// Another node on a bus of the kernel, written with its bare calls: frames of every kind, error
// frames too, and nothing between.
class RawCan {
 public:
  // Fails the test where there is no such bus.
  explicit RawCan(const char* interface)
      : socket_(::socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC, CAN_RAW)) {
    const int on = 1;
    const can_err_mask_t every_error = CAN_ERR_MASK;
    ::setsockopt(socket_, SOL_CAN_RAW, CAN_RAW_FD_FRAMES, &on, sizeof on);
    ::setsockopt(socket_, SOL_CAN_RAW, CAN_RAW_ERR_FILTER, &every_error, sizeof every_error);
    sockaddr_can address{};
    address.can_family = AF_CAN;
    address.can_ifindex = static_cast<int>(::if_nametoindex(interface));
    if (address.can_ifindex == 0 ||
        ::bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
      ADD_FAILURE() << interface << ": " << std::strerror(errno)
                    << "; these tests run in ./dev vcan --controller, as ./dev test runs them";
    }
  }
  RawCan(const RawCan&) = delete;
  RawCan& operator=(const RawCan&) = delete;
  RawCan(RawCan&&) = delete;
  RawCan& operator=(RawCan&&) = delete;
  ~RawCan() { ::close(socket_); }

  [[nodiscard]] bool send(const RawFrame& sent) const {
    return ::write(socket_, &sent.frame, sent.size) == static_cast<ssize_t>(sent.size);
  }

  // The next frame, waited for as long as said; nothing when none came.
  [[nodiscard]] std::optional<RawFrame> receive(
      std::chrono::milliseconds patience = std::chrono::milliseconds{5000}) const {
    pollfd waiting{socket_, POLLIN, 0};
    if (::poll(&waiting, 1, static_cast<int>(patience.count())) != 1) return std::nullopt;
    RawFrame found;
    const ssize_t size = ::read(socket_, &found.frame, sizeof found.frame);
    if (size != CAN_MTU && size != CANFD_MTU) return std::nullopt;
    found.size = static_cast<std::size_t>(size);
    return found;
  }

 private:
  int socket_;
};

}  // namespace offnominal::test
