// A CAN interface of the kernel for one end of a run.
#pragma once

#include <offnominal/hal/bus/socketcan.hpp>
#include <offnominal/hal/bus/virtual_can.hpp>
#include <string>

namespace offnominal::desk::sil {

/// Makes the interface where its name begins with "vcan" and there is none; `made` removes it
/// again. Throws InputError where this kernel cannot, or this user may not.
void make_if_missing(const std::string& interface, hal::VirtualCan& made);

/// Opens `bus` on the interface, with everything else as in `config`. Throws InputError, with what
/// makes one, where there is none.
void open_bus(const std::string& interface, hal::SocketCanConfig config, hal::SocketCan& bus);

}  // namespace offnominal::desk::sil
