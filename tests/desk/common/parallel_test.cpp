#include "common/parallel.hpp"

#include <gtest/gtest.h>

#include <barrier>
#include <cstddef>
#include <mutex>
#include <set>
#include <stdexcept>
#include <thread>
#include <vector>

namespace offnominal::desk {
namespace {

TEST(ParallelFor, CallsEachOnceOnAnyNumberOfThreads) {
  for (const int threads : {-1, 0, 1, 3, 50}) {
    std::vector<int> calls(20);
    parallel_for(calls.size(), threads, [&](std::size_t i) { ++calls[i]; });
    EXPECT_EQ(calls, std::vector<int>(20, 1)) << threads;
  }
}

TEST(ParallelFor, ThrowsAgainWhatWasThrownAndLeavesWhatHadNotBegun) {
  std::vector<int> calls(20);
  const auto work = [&](std::size_t i) {
    ++calls[i];
    if (i == 2) throw std::runtime_error("the third");
  };
  EXPECT_THROW(parallel_for(calls.size(), 1, work), std::runtime_error);
  EXPECT_EQ(calls[2], 1);
  EXPECT_EQ(calls[3], 0);
}

TEST(ParallelFor, RunsALoopWithinOneThatThreadsShareOnItsCaller) {
  std::vector<char> same(4, 0);
  parallel_for(same.size(), 2, [&](std::size_t i) {
    const auto caller = std::this_thread::get_id();
    bool all = true;
    parallel_for(8, 4, [&](std::size_t) { all = all && std::this_thread::get_id() == caller; });
    same[i] = static_cast<char>(all);
  });
  EXPECT_EQ(same, std::vector<char>(4, 1));
}

// A loop of one, or on one thread, leaves the threads to what it calls.
TEST(ParallelFor, SharesALoopWithinOneThatRunsAlone) {
  std::mutex mutex;
  std::set<std::thread::id> seen;
  parallel_for(1, 4, [&](std::size_t) {
    std::barrier meet(2);
    parallel_for(2, 2, [&](std::size_t) {
      meet.arrive_and_wait();
      const std::lock_guard lock(mutex);
      seen.insert(std::this_thread::get_id());
    });
  });
  EXPECT_EQ(seen.size(), 2U);
}

TEST(ParallelParts, CoverEveryRowOnceTheLastMayBeShort) {
  for (const int count : {0, 1, 9, 10, 11}) {
    std::vector<int> rows(static_cast<std::size_t>(count));
    parallel_parts(count, 5, 3, [&](std::ptrdiff_t first, std::ptrdiff_t size) {
      EXPECT_LE(size, 5);
      for (std::ptrdiff_t i = first; i < first + size; ++i) ++rows[static_cast<std::size_t>(i)];
    });
    EXPECT_EQ(rows, std::vector<int>(rows.size(), 1)) << count;
  }
}

}  // namespace
}  // namespace offnominal::desk
