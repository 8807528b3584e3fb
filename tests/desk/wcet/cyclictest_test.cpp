#include "wcet/cyclictest.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

namespace offnominal::desk::wcet {
namespace {

using testing::Contains;
using testing::Not;

// As rt-tests 2.4 writes it.
constexpr const char* kAnswer = R"({
  "file_version": 1,
  "cmdline:": "cyclictest -q",
  "rt_test_version:": "2.40",
  "return_code": 0,
  "num_threads": 1,
  "thread": {"0": {
    "histogram": {"21": 1, "9": 4, "100": 3, "64": 2},
    "cycles": 11, "min": 9, "max": 10044, "avg": 233.03, "cpu": 0, "node": 0}}
})";

TEST(Cyclictest, IsReadFromItsAnswer) {
  const CyclictestResult result = parse_cyclictest(kAnswer);
  EXPECT_EQ(result.version, "2.40");
  EXPECT_EQ(result.cycles, 11);
  EXPECT_EQ(result.min_us, 9);
  EXPECT_EQ(result.mean_us, 233.03);
  EXPECT_EQ(result.max_us, 10044);
  // In order of latency, not of its text.
  ASSERT_EQ(result.histogram.size(), 4U);
  EXPECT_EQ(result.histogram.front().first, 9);
  EXPECT_EQ(result.quantile_us(0.0), 9);
  EXPECT_EQ(result.quantile_us(0.36), 9);
  EXPECT_EQ(result.quantile_us(0.5), 64);
  EXPECT_EQ(result.quantile_us(0.9), 100);
  EXPECT_EQ(result.quantile_us(1.0), 10044);  // beyond the histogram
}

TEST(Cyclictest, RefusesAnythingElse) {
  for (const char* text : {"", "[]", "{}", R"({"thread": {"0": {"cycles": "many"}}})"}) {
    EXPECT_THROW(static_cast<void>(parse_cyclictest(text)), std::runtime_error) << text;
  }
}

TEST(Cyclictest, GetsTheSettingsOfTheTick) {
  CyclicSettings settings{.interval_us = 500, .ticks = 77, .request = {}, .machine = {}};
  settings.machine.scheduler = "SCHED_OTHER";
  auto words = cyclictest_arguments(settings, "/x");
  EXPECT_THAT(words, Contains("--interval=500"));
  EXPECT_THAT(words, Contains("--loops=77"));
  EXPECT_THAT(words, Contains("--policy=other"));
  EXPECT_THAT(words, Contains("--json=/x"));
  EXPECT_THAT(words, Not(Contains("--mlockall")));
  settings.request.priority = 80;
  settings.machine.scheduler = "SCHED_FIFO 80";
  settings.machine.cpu = 3;
  settings.machine.memory_locked = true;
  words = cyclictest_arguments(settings, "/x");
  for (const char* word : {"--policy=fifo", "--priority=80", "--affinity=3", "--mlockall"}) {
    EXPECT_THAT(words, Contains(word));
  }
}

}  // namespace
}  // namespace offnominal::desk::wcet
