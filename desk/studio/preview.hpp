#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "explain/data_fault.hpp"
#include "robot/robot.hpp"
#include "studio/given_recording.hpp"

// What channels make of a recording, before a session stands on it.

namespace offnominal::desk::studio {

/// {error, remarks, sampling, signals: [{quantity, joint, unit, low, high, t_s, values, derived}]}:
/// every signal in SI units at the joint, as every verb would read it, lowest and highest point of
/// each of `pixels` pixels; `derived`: of a velocity that was measured the derivative of the
/// position, [] for others. A hold map has no velocities, its time counts readings. Where the
/// recording cannot be read so, `error` says why, and the signals are those columns that there are,
/// each by itself. `map` may lack channels.
[[nodiscard]] nlohmann::ordered_json preview_of(const GivenRecording& recording,
                                                const RobotDescription& robot,
                                                const ChannelMap& map, std::size_t pixels);

/// {error, faults: [...], joints: [{joint, error_percent, t_s, model}]}: what the doctor finds, as
/// to_json has it with `spoils` and `certain` beside, and how well the robot file meets the
/// torques, as `compare` of this recording alone says it; `error`: why it says nothing. Throws
/// InputError where the recording cannot be read so.
[[nodiscard]] nlohmann::ordered_json findings_of(const GivenRecording& recording,
                                                 const RobotDescription& robot,
                                                 const ChannelMap& map,
                                                 const std::vector<KeepFault>& keep,
                                                 std::size_t pixels);

/// Throws InputError where the recording cannot be read so.
void check_readable(const GivenRecording& recording, const RobotDescription& robot,
                    const ChannelMap& map);

}  // namespace offnominal::desk::studio
