#pragma once

#include <cstdint>
#include <limits>
#include <offnominal/hal/bus/frame.hpp>
#include <offnominal/hal/status.hpp>

// What a receiver knows of one sender of one message.

namespace offnominal::hal {

enum class SourceState : std::uint8_t {
  kNeverSeen = 0,  // no valid record since the start
  kValid = 1,      // the newest record may be used
  kStale = 2,      // it is too old, or from the future
  kError = 3,      // what came last cannot be trusted; records in sequence are awaited
};

struct SourceConfig {
  Microseconds max_age_us = 3000;     // older is stale; > 0
  std::uint8_t max_counter_step = 3;  // so many records less one may be lost in a row; 1 to 127
  std::uint8_t sequence_needed = 3;   // records in sequence before the first one is used; >= 1
  std::uint8_t max_bad_in_a_row = 3;  // more records that do not open are an error; >= 1
};

// A source with a record in every period is stale at the third without one.
[[nodiscard]] constexpr SourceConfig source_config(Microseconds period_us) {
  return {.max_age_us = period_us * 5 / 2};
}

// Plain data. Counters wrap.
struct Source {
  bool seen = false;  // a valid record, ever
  bool synchronised = false;
  bool has_counter = false;
  std::uint8_t counter = 0;      // of the newest record with a right CRC
  std::uint8_t in_sequence = 0;  // records whose counters followed one another
  std::uint8_t bad_in_a_row = 0;
  Microseconds time_us = 0;  // of the newest record that was accepted
  // None is accepted before, since records of another sequence have come.
  Microseconds trusted_from_us = std::numeric_limits<Microseconds>::min();
  std::uint32_t accepted = 0;
  std::uint32_t lost = 0;  // by the counters of the accepted ones
  std::uint32_t repeated = 0;
  std::uint32_t rejected = 0;  // wrong CRC, value or counter
};

namespace detail {
constexpr void lose_sequence(Source& source) {
  source.synchronised = false;
  source.in_sequence = 0;
}
constexpr void count_up(std::uint8_t& value) {
  if (value < std::numeric_limits<std::uint8_t>::max()) ++value;
}
}  // namespace detail

// A record whose CRC and content are right has come. kOk: its content may be used.
// kRepeatedCounter: the one before, again; nothing is refreshed. kSkippedCounter: more were lost
// than the configuration allows, or an old one was played back; the source is in error until
// records have followed one another, and nothing else has come, for max_age_us: a burst of old ones
// follows one another as well. kNotSynchronised: one of those.
[[nodiscard]] constexpr Status accept(const SourceConfig& config, std::uint8_t counter,
                                      Microseconds time_us, Source& source) {
  source.bad_in_a_row = 0;
  const auto step = static_cast<std::uint8_t>(counter - source.counter);
  if (source.has_counter && step == 0) {
    ++source.repeated;
    return Status::kRepeatedCounter;
  }
  const std::uint8_t allowed = source.synchronised ? config.max_counter_step : std::uint8_t{1};
  const bool follows = !source.has_counter || step <= allowed;
  source.has_counter = true;
  source.counter = counter;
  if (!follows) {
    const bool was_synchronised = source.synchronised;
    detail::lose_sequence(source);
    source.in_sequence = 1;
    source.trusted_from_us = time_us + config.max_age_us;
    ++source.rejected;
    return was_synchronised ? Status::kSkippedCounter : Status::kNotSynchronised;
  }
  detail::count_up(source.in_sequence);
  const bool trusted =
      source.in_sequence >= config.sequence_needed && time_us >= source.trusted_from_us;
  if (!source.synchronised && !trusted) return Status::kNotSynchronised;
  if (source.synchronised) source.lost += static_cast<std::uint32_t>(step - 1);
  source.synchronised = true;
  source.seen = true;
  source.time_us = time_us;
  ++source.accepted;
  return Status::kOk;
}

// A record of this source has come that could not be opened or decoded.
constexpr void reject(const SourceConfig& config, Source& source) {
  ++source.rejected;
  detail::count_up(source.bad_in_a_row);
  if (source.bad_in_a_row > config.max_bad_in_a_row) detail::lose_sequence(source);
}

[[nodiscard]] constexpr SourceState state_of(const SourceConfig& config, const Source& source,
                                             Microseconds now_us) {
  if (!source.seen) return SourceState::kNeverSeen;
  if (!source.synchronised) return SourceState::kError;
  const Microseconds age_us = now_us - source.time_us;
  // A time of the future says nothing of now: silent or not, it would be valid until then.
  const bool believed = age_us <= config.max_age_us && age_us >= -config.max_age_us;
  return believed ? SourceState::kValid : SourceState::kStale;
}

}  // namespace offnominal::hal
