#include <linux/can.h>
#include <linux/if_link.h>
#include <linux/netlink.h>
#include <linux/rtnetlink.h>
#include <net/if.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <offnominal/hal/bus/virtual_can.hpp>

#include "raw_socket.hpp"

namespace offnominal::hal {
namespace {

// One request to the kernel's table of links (rtnetlink(7)), put together piece by piece.
class LinkRequest {
 public:
  LinkRequest(std::uint16_t type, int flags, const ifinfomsg& link) {
    header().nlmsg_type = type;
    header().nlmsg_flags = static_cast<std::uint16_t>(flags | NLM_F_REQUEST | NLM_F_ACK);
    header().nlmsg_len = NLMSG_LENGTH(sizeof link);
    std::memcpy(NLMSG_DATA(&header()), &link, sizeof link);
  }

  void add(std::uint16_t type, const void* data, std::size_t size) {
    auto* attribute = reinterpret_cast<rtattr*>(end());
    attribute->rta_type = type;
    attribute->rta_len = static_cast<std::uint16_t>(RTA_LENGTH(size));
    if (size > 0) std::memcpy(RTA_DATA(attribute), data, size);
    header().nlmsg_len =
        NLMSG_ALIGN(header().nlmsg_len) + static_cast<std::uint32_t>(RTA_ALIGN(RTA_LENGTH(size)));
  }
  void add(std::uint16_t type, const std::string& text) {
    add(type, text.c_str(), text.size() + 1);
  }
  // An attribute that holds another.
  void add_within(std::uint16_t outer, std::uint16_t type, const std::string& text) {
    auto* around = reinterpret_cast<rtattr*>(end());
    add(outer, nullptr, 0);
    add(type, text);
    around->rta_len = static_cast<std::uint16_t>(end() - reinterpret_cast<std::uint8_t*>(around));
  }

  // The kernel's errno, 0 where it has done it.
  [[nodiscard]] int send() {
    const OwnedSocket socket(::socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC, NETLINK_ROUTE));
    if (socket.get() < 0) return errno;
    const std::uint32_t length = header().nlmsg_len;
    if (::send(socket.get(), buffer_.data(), length, 0) != static_cast<ssize_t>(length)) {
      return errno;
    }
    alignas(nlmsghdr) std::array<std::uint8_t, 1024> answer{};
    const ssize_t size = ::recv(socket.get(), answer.data(), answer.size(), 0);
    if (size < 0) return errno;
    const auto* come = reinterpret_cast<const nlmsghdr*>(answer.data());
    const bool whole = static_cast<std::size_t>(size) >= NLMSG_LENGTH(sizeof(nlmsgerr));
    if (!whole || come->nlmsg_type != NLMSG_ERROR) return EPROTO;
    nlmsgerr error{};
    std::memcpy(&error, answer.data() + NLMSG_LENGTH(0), sizeof error);
    return -error.error;
  }

 private:
  nlmsghdr& header() { return *reinterpret_cast<nlmsghdr*>(buffer_.data()); }
  std::uint8_t* end() { return buffer_.data() + NLMSG_ALIGN(header().nlmsg_len); }

  alignas(nlmsghdr) std::array<std::uint8_t, 256> buffer_{};
};

}  // namespace

Status VirtualCan::make(const std::string& interface) {
  if (::if_nametoindex(interface.c_str()) != 0) return Status::kOk;
  if (interface.empty() || interface.size() >= IFNAMSIZ) {
    error_number_ = EINVAL;
    return Status::kSystemError;
  }
  ifinfomsg link{};
  link.ifi_flags = IFF_UP;
  link.ifi_change = IFF_UP;
  LinkRequest request(RTM_NEWLINK, NLM_F_CREATE | NLM_F_EXCL, link);
  const std::uint32_t bytes = CANFD_MTU;
  request.add(IFLA_IFNAME, interface);
  request.add(IFLA_MTU, &bytes, sizeof bytes);
  request.add_within(IFLA_LINKINFO, IFLA_INFO_KIND, "vcan");
  error_number_ = request.send();
  switch (error_number_) {
    case 0:
      made_ = interface;
      return Status::kOk;
    case EEXIST:  // somebody else was quicker
      return Status::kOk;
    case EPERM:
    case EACCES:
      return Status::kNotPermitted;
    case EOPNOTSUPP:
    case EAFNOSUPPORT:
      return Status::kNoSuchInterface;
    default:
      return Status::kSystemError;
  }
}

VirtualCan::~VirtualCan() {
  if (made_.empty()) return;
  ifinfomsg link{};
  link.ifi_index = static_cast<int>(::if_nametoindex(made_.c_str()));
  if (link.ifi_index != 0) static_cast<void>(LinkRequest(RTM_DELLINK, 0, link).send());
}

}  // namespace offnominal::hal
