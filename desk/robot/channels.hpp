#pragma once

#include <toml++/toml.h>

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "robot/robot.hpp"
#include "robot/units.hpp"

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
// payload = [{recording = "a.csv", mass_kg = 0.8, place_m = [0, 0, 0.1]}] says what the robot
// carried in which recording (payload.hpp).
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

// Instead of position and velocity there may be motor_position and motor_velocity, of the motors;
// instead of torque motor_torque, motor_current or sensor_torque. "" in one list is for a joint
// that another list has; sensor_torque may also stand beside the torque of the drive.

// The key of a quantity, "position", "velocity" or "torque", of that side.
[[nodiscard]] std::string channel_key(std::string_view quantity, ChannelOf of);

// What such a channel becomes.
[[nodiscard]] ChannelQuantity channel_quantity(std::string_view quantity, ChannelOf of);

// Of the joint with that index; all are of the joints where `of` is empty.
[[nodiscard]] inline ChannelOf side_at(const std::vector<ChannelOf>& of, std::size_t joint) {
  return joint < of.size() ? of[joint] : ChannelOf::kJoint;
}

// The channels of a [channels] table. `file` names the table's file in messages; joint_count is the
// number of entries that position, velocity and torque must have. Throws InputError.
ChannelMap parse_channels(const toml::table& table, const std::string& file, int joint_count);

// The channels of a file that holds a [channels] table, or that table's keys at its top level.
// Throws InputError where the file cannot be read or is wrong.
ChannelMap read_channels_file(const std::filesystem::path& file, int joint_count);

}  // namespace offnominal::desk
