#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "robot/robot.hpp"

// What a robot carries while it is recorded, where that is known: one recording with 0 kg, the next
// with 2 kg. It belongs to the recording, not to the robot: no file that is written holds it.

namespace offnominal::desk {

/// The robot with the payload on its last link: as one more effect, the last, tip_payload. The
/// robot itself where there is none.
[[nodiscard]] RobotDescription carrying(RobotDescription robot,
                                        const std::optional<Payload>& payload);

/// The payload of a recording, by its whole name or its name without folder; none where nothing is
/// said. Throws InputError where two entries say different things of it.
[[nodiscard]] std::optional<Payload> payload_of(const std::vector<RecordingPayload>& payloads,
                                                const std::string& recording);

/// Whether an entry speaks of a recording.
[[nodiscard]] bool is_of(const RecordingPayload& payload, const std::string& recording);

/// "LOG=KG@X,Y,Z", as --payload has it; nullopt where it is something else, a mass below 0 or above
/// kMostPayloadKg, or a place further than kFurthestPayloadM.
[[nodiscard]] std::optional<RecordingPayload> payload_of_text(std::string_view text);

/// The same text again.
[[nodiscard]] std::string text_of(const RecordingPayload& payload);

inline constexpr double kMostPayloadKg = 1e5;
inline constexpr double kFurthestPayloadM = 100;

/// "0.8 kg at [0, 0, 0.1] m of the last link"
[[nodiscard]] std::string words_of(const Payload& payload);

}  // namespace offnominal::desk
