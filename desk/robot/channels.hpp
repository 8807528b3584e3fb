#pragma once

#include <toml++/toml.h>

#include <filesystem>
#include <string>

#include "robot/robot.hpp"

// How the columns of a recording become t, q, dq and tau of the joints.
//
//   [channels]
//   time = "t"                             # a string stands for {source = "..."}; default "t".
//                                          # A list: one for each file that a recording has
//   # period_s = 0.001                     # instead of time, where no column has it
//   position = [{source = "qm"}]           # one entry per joint, in the joints' order
//   velocity = [{source = "vm"}]           # absent, or "" for one joint: derived from the position
//   torque = [{source = "vir", scale_source = "gtau", unit = "V"}]
//   [channels.extra]                       # further quantities, by the name they get
//   temp1 = {source = "T_motor", offset = -273.15}
//   dbc = "drive.dbc"                      # in [channels]: for logs of candump, see
//   candump_log.hpp
//
// payload = [{recording = "a.csv", mass_kg = 0.8, place_m = [0, 0, 0.1]}] says what the robot carried in
// which recording (payload.hpp).
//
// Hold maps (hold_map.hpp) have at_rest = true, a position and a torque, and nothing else.
//
// A channel's SI value is scale * scale_source * unit * source + offset: scale is 1, offset 0 and
// scale_source absent unless given; `unit` is the factor of the source's unit where units.hpp knows
// it, else 1. A unit that is none of the quantity's own (A where a torque is wanted) needs a scale,
// an offset or a scale_source. Where there is one joint the list's brackets may be left out.
// A source is a name, or the number of a column from 1. sum = [channel, channel, ...] takes the
// place of source: its terms have a source, scale, scale_source and unit each.

namespace offnominal::desk {

// The channels of a [channels] table. `file` names the table's file in messages; joint_count is the
// number of entries that position, velocity and torque must have. Throws InputError.
ChannelMap parse_channels(const toml::table& table, const std::string& file, int joint_count);

// The channels of a file that holds a [channels] table, or that table's keys at its top level.
// Throws InputError where the file cannot be read or is wrong.
ChannelMap read_channels_file(const std::filesystem::path& file, int joint_count);

}  // namespace offnominal::desk
