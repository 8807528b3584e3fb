#include <linux/can/error.h>
#include <net/if.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <offnominal/hal/bus/can_listener.hpp>

#include "raw_socket.hpp"
#include "receive_batch.hpp"

namespace offnominal::hal {

class CanListener::Port {
 public:
  Port(int socket, const char* interface) : socket_(socket) {
    std::strncpy(interface_.data(), interface, IFNAMSIZ - 1);
    // Seconds of a full bus, where this process may ask for so much; else what the system allows.
    constexpr int kRoom = 8 << 20;
    if (::setsockopt(socket, SOL_SOCKET, SO_RCVBUFFORCE, &kRoom, sizeof kRoom) != 0) {
      static_cast<void>(::setsockopt(socket, SOL_SOCKET, SO_RCVBUF, &kRoom, sizeof kRoom));
    }
    is_up_ = is_interface_up(socket_.get(), interface_.data());
  }

  std::size_t receive(std::span<ReceivedFrame> into, Microseconds patience_us) {
    std::size_t count = fetch(into);
    if (count > 0) return count;
    constexpr int kUsPerMs = 1000;
    // A socket whose interface is down is ready at once, to say so: then time passes otherwise.
    pollfd ready{is_up_ ? socket_.get() : -1, POLLIN, 0};
    static_cast<void>(::poll(&ready, 1, static_cast<int>(patience_us / kUsPerMs)));
    count = fetch(into);
    if (count == 0) is_up_ = is_interface_up(socket_.get(), interface_.data());
    return count;
  }
  [[nodiscard]] bool is_up() const { return is_up_; }
  [[nodiscard]] std::uint32_t overflow() const { return batch_.lost(); }

 private:
  std::size_t fetch(std::span<ReceivedFrame> into) {
    std::size_t count = 0;
    while (count < into.size()) {
      const std::size_t most = std::min(into.size() - count, ReceiveBatch::kMost);
      int error = 0;
      const std::size_t got = batch_.fetch(socket_.get(), most, error);
      for (std::size_t i = 0; i < got; ++i) {
        const RawArrival arrival = batch_.arrival(i);
        const bool is_report = (arrival.raw->can_id & CAN_ERR_FLAG) != 0;
        ReceivedFrame received;
        if (is_report || !from_kernel(*arrival.raw, arrival.size, received.frame)) continue;
        received.time_us = arrival.time_us;
        into[count++] = received;
      }
      if (error != 0) is_up_ = false;
      if (got < most) break;
    }
    return count;
  }

  OwnedSocket socket_;
  std::array<char, IFNAMSIZ> interface_{};
  ReceiveBatch batch_;
  bool is_up_ = false;
};

CanListener::CanListener() = default;
CanListener::~CanListener() = default;

Status CanListener::open(const char* interface) {
  int socket = -1;
  const Status status = open_raw_socket({.interface = interface}, socket);
  if (status != Status::kOk) {
    error_number_ = errno;
    return status;
  }
  port_ = std::make_unique<Port>(socket, interface);
  return Status::kOk;
}

Microseconds CanListener::now() const { return clock_us(CLOCK_MONOTONIC); }

std::size_t CanListener::receive(std::span<ReceivedFrame> into, Microseconds patience_us) {
  return port_ ? port_->receive(into, patience_us) : 0;
}

bool CanListener::is_up() const { return port_ && port_->is_up(); }
std::uint32_t CanListener::overflow() const { return port_ ? port_->overflow() : 0; }

}  // namespace offnominal::hal
