#include "sil/open_bus.hpp"

#include <cstring>

#include "common/error.hpp"

namespace offnominal::desk::sil {

void make_if_missing(const std::string& interface, hal::VirtualCan& made) {
  if (!interface.starts_with("vcan")) return;
  const hal::Status status = made.make(interface);
  if (status == hal::Status::kOk) return;
  std::string mend = "./dev vcan COMMAND runs a command where there is one";
  if (status == hal::Status::kNotPermitted) {
    mend = "as root: ip link add " + interface + " type vcan && ip link set " + interface +
           " mtu 72 up; or " + mend;
  }
  const char* found = status == hal::Status::kNoSuchInterface
                          ? "a kernel without virtual CAN"
                          : "no such interface, and none could be made";
  throw InputError({"--bus " + interface, "",
                    std::string(found) + " (" + std::strerror(made.error_number()) + ")",
                    "a CAN interface that is up", mend});
}

void open_bus(const std::string& interface, hal::SocketCanConfig config, hal::SocketCan& bus) {
  config.interface = interface.c_str();
  const hal::Status status = bus.open(config);
  if (status == hal::Status::kOk) return;
  throw InputError(
      {"--bus " + interface, "",
       std::string(hal::name_of(status)) + " (" + std::strerror(bus.error_number()) + ")",
       "a CAN interface that is up",
       "make one: ip link add vcan0 type vcan && ip link set vcan0 mtu 72 up; where "
       "the kernel has no CAN: ./dev vcan COMMAND"});
}

}  // namespace offnominal::desk::sil
