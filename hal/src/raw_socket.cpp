#include "raw_socket.hpp"

#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <ctime>

namespace offnominal::hal {
namespace {

ifreq request_for(const char* interface) {
  ifreq request{};
  // A name that is too long is cut, and then found nowhere.
  std::memcpy(request.ifr_name, interface, ::strnlen(interface, IFNAMSIZ - 1));
  return request;
}

template <typename T>
bool set_option(int socket, int level, int name, const T& value) {
  return ::setsockopt(socket, level, name, &value, sizeof value) == 0;
}

can_filter in_kernel_words(const IdFilter& filter) {
  const canid_t kind = filter.extended ? CAN_EFF_FLAG : 0U;
  const canid_t most = filter.extended ? CAN_EFF_MASK : CAN_SFF_MASK;
  return {(filter.id & most) | kind, (filter.mask & most) | CAN_EFF_FLAG};
}

bool set_filters(int socket, const SocketCanConfig& config) {
  if (config.receive.empty()) return true;
  std::array<can_filter, kMostFilters> filters;
  auto* end = std::transform(config.receive.begin(), config.receive.end(), filters.begin(),
                             in_kernel_words);
  end = std::transform(config.transmit.begin(), config.transmit.end(), end, in_kernel_words);
  const auto bytes =
      static_cast<socklen_t>(sizeof(can_filter) * static_cast<std::size_t>(end - filters.begin()));
  return ::setsockopt(socket, SOL_CAN_RAW, CAN_RAW_FILTER, filters.data(), bytes) == 0;
}

bool set_options(int socket, const SocketCanConfig& config) {
  constexpr int kOn = 1;
  constexpr can_err_mask_t kEveryError = CAN_ERR_MASK;
  // A second bound on what the kernel may hold, should its word on a frame ever be lost: it charges
  // a frame with less than a kilobyte, and doubles what it is told.
  const int room = static_cast<int>(config.in_kernel * 1024);
  return set_filters(socket, config) &&
         set_option(socket, SOL_CAN_RAW, CAN_RAW_ERR_FILTER, kEveryError) &&
         set_option(socket, SOL_CAN_RAW, CAN_RAW_RECV_OWN_MSGS, kOn) &&
         set_option(socket, SOL_CAN_RAW, CAN_RAW_FD_FRAMES, kOn) &&
         set_option(socket, SOL_SOCKET, SO_TIMESTAMPNS, kOn) &&
         set_option(socket, SOL_SOCKET, SO_RXQ_OVFL, kOn) &&
         set_option(socket, SOL_SOCKET, SO_SNDBUF, room);
}

Status status_of(int error) {
  switch (error) {
    case ENODEV:
    case ENXIO:
      return Status::kNoSuchInterface;
    case EPERM:
    case EACCES:
      return Status::kNotPermitted;
    default:
      return Status::kSystemError;
  }
}

bool set_up_socket(int socket, const SocketCanConfig& config) {
  ifreq request = request_for(config.interface);
  if (::ioctl(socket, SIOCGIFINDEX, &request) != 0 || !set_options(socket, config)) return false;
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = request.ifr_ifindex;
  return ::bind(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
}

}  // namespace

OwnedSocket::~OwnedSocket() { ::close(socket_); }

Microseconds clock_us(int clock) {
  timespec time{};
  ::clock_gettime(clock, &time);
  return Microseconds{time.tv_sec} * 1'000'000 + time.tv_nsec / 1000;
}

std::size_t to_kernel(const Frame& frame, canfd_frame& raw) {
  raw = {};
  raw.can_id = frame.id | (frame.extended ? CAN_EFF_FLAG : 0U) | (frame.remote ? CAN_RTR_FLAG : 0U);
  raw.len = frame.length;
  if (!frame.remote) std::memcpy(raw.data, frame.data.data(), frame.length);
  if (!frame.fd) return CAN_MTU;
  raw.flags = CANFD_BRS;
  return CANFD_MTU;
}

bool from_kernel(const canfd_frame& raw, std::size_t size, Frame& frame) {
  if (size != CAN_MTU && size != CANFD_MTU) return false;
  frame = {};
  frame.fd = size == CANFD_MTU;
  if (raw.len > (frame.fd ? kMaxFdLength : kMaxClassicLength)) return false;
  frame.extended = (raw.can_id & CAN_EFF_FLAG) != 0;
  frame.id = raw.can_id & (frame.extended ? CAN_EFF_MASK : CAN_SFF_MASK);
  frame.remote = (raw.can_id & CAN_RTR_FLAG) != 0;
  frame.length = raw.len;
  if (!frame.remote) std::memcpy(frame.data.data(), raw.data, raw.len);
  return true;
}

Status open_raw_socket(const SocketCanConfig& config, int& socket) {
  socket = -1;
  if (config.in_kernel < 1 || config.in_kernel > SocketCanConfig::kMostInKernel ||
      config.receive.size() + config.transmit.size() > kMostFilters) {
    errno = EINVAL;
    return Status::kSystemError;
  }
  if (std::strlen(config.interface) >= IFNAMSIZ) {
    errno = ENODEV;
    return Status::kNoSuchInterface;
  }
  const int opened = ::socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC | SOCK_NONBLOCK, CAN_RAW);
  if (opened < 0) return status_of(errno);
  if (!set_up_socket(opened, config)) {
    const int error = errno;
    ::close(opened);
    errno = error;
    return status_of(error);
  }
  socket = opened;
  return Status::kOk;
}

bool is_interface_up(int socket, const char* interface) {
  ifreq request = request_for(interface);
  return ::ioctl(socket, SIOCGIFFLAGS, &request) == 0 && (request.ifr_flags & IFF_UP) != 0;
}

bool takes_can_fd(int socket, const char* interface) {
  ifreq request = request_for(interface);
  return ::ioctl(socket, SIOCGIFMTU, &request) == 0 && request.ifr_mtu >= int{CANFD_MTU};
}

}  // namespace offnominal::hal
