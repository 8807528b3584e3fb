#include "common/parallel.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <stdexcept>
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

}  // namespace
}  // namespace offnominal::desk
