#pragma once

#include <offnominal/hal/bus/frame.hpp>
#include <string>

namespace offnominal::desk {

/// One line as `candump -l` writes it, with its end: "(12.000345) vcan0 181#2A366C2BBA", "##1" for
/// CAN FD with the bit rate switched, "#R8" for a request.
[[nodiscard]] std::string candump_line(const hal::Frame& frame, hal::Microseconds time_us,
                                       const std::string& interface);

}  // namespace offnominal::desk
