#pragma once

#include <offnominal/controller/fault.hpp>
#include <string>

namespace offnominal::desk::live {

/// What a controller's fault means, and what to look at: "no fresh status of a drive, ...: cable,
/// drive or bus; number 162 of docs/troubleshooting.md". Numbers that no controller of this program
/// has get their number alone.
[[nodiscard]] std::string words_of(controller::Fault fault);

}  // namespace offnominal::desk::live
