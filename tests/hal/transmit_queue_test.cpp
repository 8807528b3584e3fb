#include "src/transmit_queue.hpp"

#include <gtest/gtest.h>

namespace offnominal::hal {
namespace {

Frame with_id(std::uint32_t id, std::uint8_t content = 0) {
  Frame frame;
  frame.id = id;
  frame.length = 1;
  frame.data[0] = content;
  return frame;
}

std::uint32_t give_next(TransmitQueue& queue) {
  TransmitQueue::Mailbox* next = queue.next();
  if (next == nullptr) return 0;
  const std::uint32_t id = next->frame.id;
  queue.taken(*next);
  return id;
}

TEST(TransmitQueue, GivenSeveralWaitingWhenTheKernelIsGivenSomeThenLowestIdentifierIsFirst) {
  TransmitQueue queue(2);
  for (const std::uint32_t id : {5U, 3U, 4U}) {
    EXPECT_EQ(queue.place(with_id(id), 100), TransmitQueue::Placed::kNew);
  }
  EXPECT_EQ(give_next(queue), 3U);
  EXPECT_EQ(give_next(queue), 4U);
  EXPECT_EQ(give_next(queue), 0U) << "two at a time";
  EXPECT_FALSE(queue.gone_out(with_id(4), 50));
  EXPECT_EQ(give_next(queue), 5U);
  EXPECT_FALSE(queue.waits());
}

TEST(TransmitQueue, GivenFrameInTheKernelWhenItsIdentifierIsPlacedAgainThenThatWaitsForIt) {
  TransmitQueue queue(4);
  EXPECT_EQ(queue.place(with_id(7, 1), 100), TransmitQueue::Placed::kNew);
  EXPECT_EQ(give_next(queue), 7U);
  EXPECT_EQ(queue.place(with_id(7, 2), 200), TransmitQueue::Placed::kNew);
  EXPECT_EQ(give_next(queue), 0U);
  EXPECT_EQ(queue.place(with_id(7, 3), 300), TransmitQueue::Placed::kInPlaceOfOld);
  EXPECT_FALSE(queue.gone_out(with_id(7), 100));
  ASSERT_NE(queue.next(), nullptr);
  EXPECT_EQ(queue.next()->frame.data[0], 3) << "the newest";
}

TEST(TransmitQueue, GivenSameNumberInBothLengthsOfIdentifierThenTheyAreTwo) {
  TransmitQueue queue(4);
  Frame extended = with_id(7);
  extended.extended = true;
  EXPECT_EQ(queue.place(with_id(7), 100), TransmitQueue::Placed::kNew);
  EXPECT_EQ(queue.place(extended, 100), TransmitQueue::Placed::kNew);
  EXPECT_EQ(give_next(queue), 7U);
  EXPECT_EQ(give_next(queue), 7U);
}

TEST(TransmitQueue,
     GivenDeadlinesWhenTimePassesThenLateFramesAreForgottenHereAndCountedOnceInTheKernel) {
  TransmitQueue queue(1);
  EXPECT_EQ(queue.place(with_id(1), 100), TransmitQueue::Placed::kNew);
  EXPECT_EQ(give_next(queue), 1U);
  EXPECT_EQ(queue.place(with_id(2), 100), TransmitQueue::Placed::kNew);
  EXPECT_EQ(queue.place(with_id(3), 101), TransmitQueue::Placed::kNew);
  EXPECT_EQ(queue.forget_late(100), 0U) << "at its deadline a frame is in time";
  EXPECT_EQ(queue.newly_late_in_kernel(100), 0U);
  EXPECT_EQ(queue.forget_late(101), 1U);
  EXPECT_EQ(queue.newly_late_in_kernel(101), 1U);
  EXPECT_EQ(queue.newly_late_in_kernel(102), 0U);
  EXPECT_TRUE(queue.gone_out(with_id(1), 99)) << "counted as late, whatever its stamp says";
  EXPECT_EQ(queue.forget_waiting(), 1U);
  EXPECT_EQ(queue.forget_in_kernel(), 0U);
}

TEST(TransmitQueue, GivenEveryMailboxFullWhenOneMoreIsPlacedThenThereIsNoRoom) {
  TransmitQueue queue(1);
  for (std::uint32_t id = 0; id < TransmitQueue::kMailboxes; ++id) {
    EXPECT_EQ(queue.place(with_id(id), 100), TransmitQueue::Placed::kNew);
  }
  EXPECT_EQ(queue.place(with_id(0x700), 100), TransmitQueue::Placed::kNoRoom);
}

}  // namespace
}  // namespace offnominal::hal
