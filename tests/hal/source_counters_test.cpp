// What a source counts, and from where it begins to count again.
#include <gtest/gtest.h>

#include <limits>
#include <offnominal/hal/source.hpp>

namespace offnominal::hal {
namespace {

constexpr SourceConfig kDefaults{};

// Records with the counters first, first + 1, ..., one a millisecond; the last one's status.
Status accept_many(const SourceConfig& config, int first, int count, Microseconds& time_us,
                   Source& source) {
  Status last = Status::kUnknownId;
  for (int i = 0; i < count; ++i) {
    time_us += 1000;
    last = accept(config, static_cast<std::uint8_t>(first + i), time_us, source);
  }
  return last;
}

// On both sides of now: a stamp of the future is believed as far as one of the past.
TEST(SourceCounters, AStampIsBelievedUpToItsGreatestAgeEitherWay) {
  Source source;
  Microseconds time_us = 0;
  ASSERT_EQ(accept_many(kDefaults, 0, 3, time_us, source), Status::kOk);
  for (const Microseconds sign : {-1, 1}) {
    EXPECT_EQ(state_of(kDefaults, source, time_us + sign * kDefaults.max_age_us),
              SourceState::kValid);
    EXPECT_EQ(state_of(kDefaults, source, time_us + sign * (kDefaults.max_age_us + 1)),
              SourceState::kStale);
  }
}

TEST(SourceCounters, BeginAtNothing) {
  const Source source;
  EXPECT_FALSE(source.seen);
  EXPECT_FALSE(source.synchronised);
  EXPECT_FALSE(source.has_counter);
  EXPECT_EQ(source.counter, 0);
  EXPECT_EQ(source.in_sequence, 0);
  EXPECT_EQ(source.bad_in_a_row, 0);
  EXPECT_EQ(source.time_us, 0);
  EXPECT_EQ(source.trusted_from_us, std::numeric_limits<Microseconds>::min());
  EXPECT_EQ(source.accepted + source.lost + source.repeated + source.rejected, 0U);
}

TEST(SourceCounters, CountEveryRecordOnce) {
  Source source;
  Microseconds time_us = 0;
  ASSERT_EQ(accept_many(kDefaults, 0, 10, time_us, source), Status::kOk);
  EXPECT_EQ(source.accepted, 8U) << "two came before it was trusted";
  EXPECT_EQ(accept(kDefaults, 9, time_us, source), Status::kRepeatedCounter);
  EXPECT_EQ(source.repeated, 1U);
  EXPECT_EQ(accept(kDefaults, 12, time_us, source), Status::kOk);
  EXPECT_EQ(source.lost, 2U);
  EXPECT_EQ(source.accepted, 9U);
  EXPECT_EQ(accept(kDefaults, 16, time_us, source), Status::kSkippedCounter);
  EXPECT_EQ(source.rejected, 1U);
  EXPECT_EQ(accept(kDefaults, 18, time_us, source), Status::kNotSynchronised);
  EXPECT_EQ(source.rejected, 2U);
  reject(kDefaults, source);
  EXPECT_EQ(source.rejected, 3U);
  EXPECT_EQ(source.accepted, 9U);
  EXPECT_EQ(source.lost, 2U);
}

TEST(SourceCounters, NothingIsLostBeforeTheFirstRecord) {
  const SourceConfig config{.sequence_needed = 1};
  Source source;
  ASSERT_EQ(accept(config, 9, 0, source), Status::kOk);
  EXPECT_EQ(source.lost, 0U);
  EXPECT_EQ(source.accepted, 1U);
}

TEST(SourceCounters, AGoodRecordForgivesTheBadOnesBefore) {
  Source source;
  Microseconds time_us = 0;
  ASSERT_EQ(accept_many(kDefaults, 0, 3, time_us, source), Status::kOk);
  for (int i = 3; i < 20; ++i) {
    for (int bad = 0; bad < kDefaults.max_bad_in_a_row; ++bad) reject(kDefaults, source);
    ASSERT_EQ(state_of(kDefaults, source, time_us), SourceState::kValid) << i;
    ASSERT_EQ(accept_many(kDefaults, i, 1, time_us, source), Status::kOk) << i;
  }
}

TEST(SourceCounters, AfterTooManyBadRecordsASequenceIsNeededAnew) {
  Source source;
  Microseconds time_us = 0;
  ASSERT_EQ(accept_many(kDefaults, 0, 10, time_us, source), Status::kOk);
  for (int bad = 0; bad <= kDefaults.max_bad_in_a_row; ++bad) reject(kDefaults, source);
  ASSERT_EQ(state_of(kDefaults, source, time_us), SourceState::kError);
  EXPECT_EQ(accept_many(kDefaults, 10, 2, time_us, source), Status::kNotSynchronised);
  EXPECT_EQ(accept_many(kDefaults, 12, 1, time_us, source), Status::kOk);
}

// The record that did not follow is the first of the new sequence.
TEST(SourceCounters, ASkippedCounterBeginsTheNextSequence) {
  const SourceConfig config{.max_age_us = 1};
  Source source;
  Microseconds time_us = 0;
  ASSERT_EQ(accept_many(config, 0, 10, time_us, source), Status::kOk);
  ASSERT_EQ(accept_many(config, 100, 1, time_us, source), Status::kSkippedCounter);
  EXPECT_EQ(accept_many(config, 101, 1, time_us, source), Status::kNotSynchronised);
  EXPECT_EQ(accept_many(config, 102, 1, time_us, source), Status::kOk);
}

// GIVEN a source that is not trusted for longer than its counters go round WHEN the time is over
// THEN the sequence is as long as it was, whatever its length.
TEST(SourceCounters, ALongSequenceIsNotForgotten) {
  const SourceConfig config{.max_age_us = 1'000'000};
  for (int length = 255; length <= 260; ++length) {
    Source source;
    Microseconds time_us = 0;
    ASSERT_EQ(accept_many(config, 0, 3, time_us, source), Status::kOk);
    ASSERT_EQ(accept_many(config, 100, 1, time_us, source), Status::kSkippedCounter);
    ASSERT_EQ(accept_many(config, 101, length, time_us, source), Status::kNotSynchronised);
    time_us += config.max_age_us;
    EXPECT_EQ(accept_many(config, 101 + length, 1, time_us, source), Status::kOk) << length;
  }
}

}  // namespace
}  // namespace offnominal::hal
