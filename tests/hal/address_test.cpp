#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <offnominal/hal/protocols/protected/address.hpp>
#include <set>
#include <vector>

namespace offnominal::hal {
namespace {

TEST(Address, OfEveryClassicFrameIsFoundAgain) {
  std::set<std::uint32_t> ids;
  for (int kind = 0; kind < kMessageKinds; ++kind) {
    for (int node = 0; node < kMaxNodes; ++node) {
      const auto k = static_cast<MessageKind>(kind);
      const auto n = static_cast<std::uint8_t>(node);
      const Frame frame = frame_of(k, n, {});
      EXPECT_TRUE(is_well_formed(frame));
      EXPECT_TRUE(ids.insert(frame.id).second) << frame.id;
      Address address;
      ASSERT_EQ(address_of(frame, address), Status::kOk);
      EXPECT_EQ(address.kind, k);
      EXPECT_EQ(address.first_node, n);
      EXPECT_EQ(address.count, 1);
    }
  }
}

TEST(Address, GroupsCarryTheirRecordsInOrder) {
  for (std::size_t count = 1; count <= kMaxRecordsPerFrame; ++count) {
    std::vector<Record> records(count);
    for (std::size_t i = 0; i < count; ++i) records[i].fill(static_cast<std::uint8_t>(i + 1));
    Frame frame;
    ASSERT_EQ(group_frame_of(MessageKind::kEncoder, 2, records, frame), Status::kOk);
    EXPECT_TRUE(is_well_formed(frame));
    EXPECT_TRUE(frame.fd);
    Address address;
    ASSERT_EQ(address_of(frame, address), Status::kOk);
    EXPECT_EQ(address.first_node, 2);
    ASSERT_GE(address.count, count);
    for (std::size_t i = 0; i < count; ++i) {
      EXPECT_TRUE(std::ranges::equal(record_in(frame, i), records[i]));
    }
  }
}

TEST(Address, GroupsThatCannotBeAreRefused) {
  Frame frame;
  const std::vector<Record> nine(9);
  const std::vector<Record> four(4);
  EXPECT_EQ(group_frame_of(MessageKind::kEncoder, 0, nine, frame), Status::kInvalidValue);
  EXPECT_EQ(group_frame_of(MessageKind::kEncoder, 0, {}, frame), Status::kInvalidValue);
  EXPECT_EQ(group_frame_of(MessageKind::kEncoder, 29, four, frame), Status::kInvalidValue);
  EXPECT_EQ(group_frame_of(MessageKind::kHeartbeat, 0, four, frame), Status::kInvalidValue);
}

// Every identifier, standard and extended ones that look like it, with every length, as a data
// frame, a request and CAN FD: an accepted frame's records lie within its length.
TEST(Address, NeverReachesBeyondTheLength) {
  int accepted = 0;
  for (std::uint32_t id = 0; id <= kMaxStandardId + 1; ++id) {
    for (int length = 0; length <= 255; ++length) {
      for (int flags = 0; flags < 8; ++flags) {
        Frame frame;
        frame.id = id;
        frame.length = static_cast<std::uint8_t>(length);
        frame.extended = (flags & 1) != 0;
        frame.fd = (flags & 2) != 0;
        frame.remote = (flags & 4) != 0;
        Address address{MessageKind::kHeartbeat, 99, 99};
        const Status status = address_of(frame, address);
        if (status != Status::kOk) {
          ASSERT_EQ(address.first_node, 99) << "a refusal has changed the address";
          continue;
        }
        ++accepted;
        ASSERT_LE(address.count * kRecordLength, frame.length);
        ASSERT_LE(address.first_node + address.count, kMaxNodes);
        ASSERT_GE(address.count, 1);
        ASSERT_FALSE(frame.extended || frame.remote);
      }
    }
  }
  EXPECT_GT(accepted, 5 * kMaxNodes);
}

TEST(Address, SaysWhyAFrameIsNotTaken) {
  Address address;
  Frame frame = frame_of(MessageKind::kEncoder, 0, {});
  frame.remote = true;
  EXPECT_EQ(address_of(frame, address), Status::kNotADataFrame);
  frame = frame_of(MessageKind::kEncoder, 0, {});
  frame.extended = true;
  EXPECT_EQ(address_of(frame, address), Status::kUnknownId);
  frame = frame_of(MessageKind::kEncoder, 0, {});
  frame.fd = true;
  EXPECT_EQ(address_of(frame, address), Status::kWrongFormat);
  frame = frame_of(MessageKind::kEncoder, 0, {});
  frame.length = 7;
  EXPECT_EQ(address_of(frame, address), Status::kWrongLength);
  frame.id = 0x7FF;
  EXPECT_EQ(address_of(frame, address), Status::kUnknownId);
}

}  // namespace
}  // namespace offnominal::hal
