#pragma once

#include <optional>
#include <string>

#include "log/named_columns.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk {

// The number behind `prefix` where `name` is these two and no more, of up to three digits.
[[nodiscard]] std::optional<int> number_behind(const std::string& name, const std::string& prefix);

// The joint's number when `name` is `prefix` and a number from 1, else 0.
[[nodiscard]] int joint_of(const std::string& name, const std::string& prefix);

// t, q1 .., dq1 .., tau1 ..; or from 0 (zero_based.hpp)
[[nodiscard]] bool is_common_name(const std::string& name);

// What `channels` want of the file with that index (from 0) of a recording of so many, or the
// common header where there are none. Names may have the file's number before them, "2:tau1".
[[nodiscard]] NeedOf needs_of(const std::optional<ChannelMap>& channels, std::size_t file,
                              std::size_t files);

// The time of that file.
[[nodiscard]] const Channel& time_channel(const ChannelMap& channels, std::size_t file);

// "2:tau1"
[[nodiscard]] std::string name_in_file(std::size_t file, const std::string& name);

}  // namespace offnominal::desk
