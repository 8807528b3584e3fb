#pragma once

#include <nlohmann/json_fwd.hpp>

#include "live/live.hpp"

namespace offnominal::desk::live {

/// What does not change, as docs/studio.md has it: what is judged, what can be done.
[[nodiscard]] nlohmann::ordered_json setup_json(const Live& live);

/// A moment: numbers with five digits, those that there are not null.
[[nodiscard]] nlohmann::ordered_json moment_json(const Moment& moment, const Live& live);

/// The charts around the last detection, as report pages hold them.
[[nodiscard]] nlohmann::json frozen_json(const Live& live, std::size_t pixels);

}  // namespace offnominal::desk::live
