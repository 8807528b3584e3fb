#include <gtest/gtest.h>

#include <algorithm>
#include <offnominal/hal/source.hpp>
#include <random>

#include "support/seed.hpp"

namespace offnominal::hal {
namespace {

constexpr SourceConfig kConfig{};

// A source that has seen counters 0, 1, 2 at 0, 1000, 2000 us: synchronised.
Source synchronised() {
  Source source;
  EXPECT_EQ(accept(kConfig, 0, 0, source), Status::kNotSynchronised);
  EXPECT_EQ(accept(kConfig, 1, 1000, source), Status::kNotSynchronised);
  EXPECT_EQ(accept(kConfig, 2, 2000, source), Status::kOk);
  return source;
}

TEST(Source, IsNeverSeenUntilRecordsHaveFollowedOneAnother) {
  Source source;
  EXPECT_EQ(state_of(kConfig, source, 0), SourceState::kNeverSeen);
  EXPECT_EQ(accept(kConfig, 9, 0, source), Status::kNotSynchronised);
  EXPECT_EQ(state_of(kConfig, source, 0), SourceState::kNeverSeen);
  EXPECT_EQ(state_of(kConfig, synchronised(), 2000), SourceState::kValid);
}

TEST(Source, IsStaleWhenNothingComes) {
  const Source source = synchronised();
  EXPECT_EQ(state_of(kConfig, source, 5000), SourceState::kValid);
  EXPECT_EQ(state_of(kConfig, source, 5001), SourceState::kStale);
}

TEST(Source, ARepeatedRecordRefreshesNothing) {
  Source source = synchronised();
  EXPECT_EQ(accept(kConfig, 2, 4000, source), Status::kRepeatedCounter);
  EXPECT_EQ(source.repeated, 1U);
  EXPECT_EQ(state_of(kConfig, source, 5001), SourceState::kStale);
}

TEST(Source, CountsWhatWasLostUpToWhatIsAllowed) {
  Source source = synchronised();
  EXPECT_EQ(accept(kConfig, 5, 3000, source), Status::kOk);
  EXPECT_EQ(source.lost, 2U);
  EXPECT_EQ(accept(kConfig, 9, 4000, source), Status::kSkippedCounter);
  EXPECT_EQ(state_of(kConfig, source, 4000), SourceState::kError);
}

TEST(Source, RecoversOnlyAfterRecordsInSequence) {
  Source source = synchronised();
  EXPECT_EQ(accept(kConfig, 100, 3000, source), Status::kSkippedCounter);
  EXPECT_EQ(accept(kConfig, 101, 4000, source), Status::kNotSynchronised);
  EXPECT_EQ(accept(kConfig, 103, 5000, source), Status::kNotSynchronised) << "one is missing";
  EXPECT_EQ(accept(kConfig, 104, 6000, source), Status::kNotSynchronised);
  EXPECT_EQ(accept(kConfig, 105, 7000, source), Status::kNotSynchronised) << "too soon";
  EXPECT_EQ(accept(kConfig, 106, 8000, source), Status::kOk);
  EXPECT_EQ(state_of(kConfig, source, 8000), SourceState::kValid);
}

TEST(Source, TheCounterWraps) {
  Source source = synchronised();
  for (int i = 3; i < 1000; ++i) {
    ASSERT_EQ(accept(kConfig, static_cast<std::uint8_t>(i), 1000 * i, source), Status::kOk) << i;
  }
  EXPECT_EQ(source.lost, 0U);
}

TEST(Source, ManyUnreadableRecordsAreAnErrorAFewAreNot) {
  Source source = synchronised();
  for (int i = 0; i < 3; ++i) reject(kConfig, source);
  EXPECT_EQ(state_of(kConfig, source, 2000), SourceState::kValid);
  reject(kConfig, source);
  EXPECT_EQ(state_of(kConfig, source, 2000), SourceState::kError);
  EXPECT_EQ(source.rejected, 4U);
}

// GIVEN a stamp of the future WHEN nothing comes any more THEN the source is not valid until then.
TEST(Source, AStampOfTheFutureIsNotBelieved) {
  constexpr Microseconds kHour = 3'600'000'000;
  Source source;
  std::uint8_t counter = 0;
  for (Microseconds time = 1000; time <= 10'000; time += 1000) {
    static_cast<void>(accept(kConfig, counter++, time + kHour, source));
  }
  ASSERT_TRUE(source.synchronised);
  for (Microseconds now = 10'000; now < kHour; now += 60'000'000) {
    ASSERT_EQ(state_of(kConfig, source, now), SourceState::kStale) << now;
  }
  // One that came while the tick was beginning is of now.
  ASSERT_EQ(accept(kConfig, counter++, 2 * kHour + 20, source), Status::kOk);
  EXPECT_EQ(state_of(kConfig, source, 2 * kHour), SourceState::kValid);
}

// GIVEN a burst of records that were on the bus before WHEN it is played back among the live ones
// THEN none of the old ones is taken.
TEST(Source, NothingOldIsTakenOfABurstPlayedBack) {
  std::mt19937_64 random = test::seeded_generator();
  for (int trial = 0; trial < 2000; ++trial) {
    Source source;
    std::uint8_t live = 0;
    Microseconds time = 0;
    for (int i = 0; i < 20; ++i) static_cast<void>(accept(kConfig, live++, time += 1000, source));
    // Far enough back that it cannot be taken for what comes next.
    const int back = std::uniform_int_distribution<int>(4, 250)(random);
    auto old = static_cast<std::uint8_t>(live - back);
    for (int i = 0; i < 2; ++i) {
      const int burst = std::uniform_int_distribution<int>(1, std::min(back, 20))(random);
      for (int k = 0; k < burst; ++k) {
        ASSERT_NE(accept(kConfig, old++, time, source), Status::kOk) << "trial " << trial;
      }
      ASSERT_NE(accept(kConfig, live++, time += 1000, source), Status::kOk)
          << "an old record among live ones is an error until they follow one another again";
    }
  }
}

}  // namespace
}  // namespace offnominal::hal
