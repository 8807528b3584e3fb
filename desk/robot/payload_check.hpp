#pragma once

#include <string>

#include "robot/robot.hpp"

// What a payload may be, and what to do where it is not: the words of whoever is told one.

namespace offnominal::desk {

/// Throws InputError, of the recording, for a mass below 0 or above kMostPayloadKg, or a place
/// further than kFurthestPayloadM.
void check_payload(const RecordingPayload& payload);

inline constexpr const char* kAllowedPayload = "a mass of 0 kg or more and a place in m";

/// "write a mass of 0 to 1e+05 kg, and numbers from -100 to 100 m"
[[nodiscard]] std::string mend_of_payload();

}  // namespace offnominal::desk
