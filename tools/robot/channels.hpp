#pragma once

#include <toml++/toml.h>

#include <filesystem>
#include <string>

#include "robot/robot.hpp"

// How the columns of a recording become t, q, dq and tau of the joints.
//
//   [channels]
//   time = "t"                             # a string stands for {source = "..."}; default "t"
//   position = [{source = "qm"}]           # one entry per joint, in the joints' order
//   velocity = [{source = "vm"}]           # absent, or "" for one joint: derived from the position
//   torque = [{source = "vir", scale_source = "gtau", unit = "V"}]
//   [channels.extra]                       # further quantities, by the name they get
//   temp1 = {source = "T_motor", offset = -273.15}
//   dbc = "drive.dbc"                      # in [channels]: for logs of candump, see
//   candump_log.hpp
//
// Hold maps (hold_map.hpp) have at_rest = true, a position and a torque, and nothing else.
//
// A channel's SI value is scale * scale_source * source + offset: scale is 1, offset 0 and
// scale_source absent unless given. Where there is one joint the list's brackets may be left out.
// `unit` is the unit of the source; one that is not SI needs a scale, an offset or a scale_source.

namespace offnominal::tools {

// The channels of a [channels] table. `file` names the table's file in messages; joint_count is the
// number of entries that position, velocity and torque must have. Throws InputError.
ChannelMap parse_channels(const toml::table& table, const std::string& file, int joint_count);

// The channels of a file that holds a [channels] table, or that table's keys at its top level.
// Throws InputError where the file cannot be read or is wrong.
ChannelMap read_channels_file(const std::filesystem::path& file, int joint_count);

}  // namespace offnominal::tools
