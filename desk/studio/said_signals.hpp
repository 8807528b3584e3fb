#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "robot/robot.hpp"
#include "studio/signal_map.hpp"

// What a user has said of signals, so that it can be said again: of a new guess, or in the next
// program.

namespace offnominal::desk::studio {

struct SaidSignal {
  SignalKey key;
  std::optional<Channel> channel = {};  // none: a velocity that is derived
  ChannelOf of = ChannelOf::kJoint;
  double period_s = 0;  // of the time
};

/// What `map` says of these signals; what it does not have is left out.
[[nodiscard]] std::vector<SaidSignal> said_of(const ChannelMap& map,
                                              const std::set<SignalKey>& keys);

/// Says it of another map; false, and nothing is said: the recordings have no such column, joint or
/// file. A column that has another name since files were joined or taken apart is found again.
[[nodiscard]] bool say_again(SaidSignal said, ChannelMap& map, const MappedColumns& columns);

/// "the position of joint 2", "the time of file 2".
[[nodiscard]] std::string words_of(const SignalKey& key);

[[nodiscard]] nlohmann::ordered_json json_of(const SaidSignal& said);
/// Of anything; none: of no signal. Throws nlohmann::json::exception where it is no such JSON.
[[nodiscard]] std::optional<SaidSignal> said_from(const nlohmann::ordered_json& from);

}  // namespace offnominal::desk::studio
