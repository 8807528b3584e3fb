#include "receive_batch.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "raw_socket.hpp"

namespace offnominal::hal {

ReceiveBatch::ReceiveBatch() {
  for (std::size_t i = 0; i < kMost; ++i) {
    parts_[i] = {&frames_[i], sizeof frames_[i]};
    messages_[i].msg_hdr.msg_iov = &parts_[i];
    messages_[i].msg_hdr.msg_iovlen = 1;
    messages_[i].msg_hdr.msg_control = controls_[i].bytes.data();
  }
}

std::size_t ReceiveBatch::fetch(int socket, std::size_t most, int& error) {
  most = std::min(most, kMost);
  for (std::size_t i = 0; i < most; ++i) {
    messages_[i].msg_hdr.msg_controllen = controls_[i].bytes.size();
  }
  const Microseconds before_us = clock_us(CLOCK_MONOTONIC);
  const int got =
      ::recvmmsg(socket, messages_.data(), static_cast<unsigned>(most), MSG_DONTWAIT, nullptr);
  error = got < 0 && errno != EAGAIN && errno != EINTR ? errno : 0;
  const Microseconds now_us = clock_us(CLOCK_MONOTONIC);
  const Microseconds real_us = clock_us(CLOCK_REALTIME);
  const std::size_t count = got < 0 ? 0 : static_cast<std::size_t>(got);
  for (std::size_t i = 0; i < count; ++i) {
    times_us_[i] = now_us;
    msghdr& header = messages_[i].msg_hdr;
    for (cmsghdr* part = CMSG_FIRSTHDR(&header); part != nullptr;
         part = CMSG_NXTHDR(&header, part)) {
      if (part->cmsg_level != SOL_SOCKET) continue;
      if (part->cmsg_type == SO_RXQ_OVFL) std::memcpy(&lost_, CMSG_DATA(part), sizeof lost_);
      if (part->cmsg_type != SO_TIMESTAMPNS) continue;
      timespec stamp{};
      std::memcpy(&stamp, CMSG_DATA(part), sizeof stamp);
      const Microseconds age_us =
          real_us - (Microseconds{stamp.tv_sec} * 1'000'000 + stamp.tv_nsec / 1000);
      // The stamp is on a clock that may be set meanwhile. The frame came after the queue was last
      // seen empty, whatever that clock says.
      times_us_[i] = std::clamp(now_us - age_us, last_empty_us_, now_us);
    }
  }
  if (count < most) last_empty_us_ = before_us;
  return count;
}

RawArrival ReceiveBatch::arrival(std::size_t index) const {
  return {&frames_[index], messages_[index].msg_len,
          (messages_[index].msg_hdr.msg_flags & MSG_CONFIRM) != 0, times_us_[index]};
}

}  // namespace offnominal::hal
