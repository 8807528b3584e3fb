#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cstdint>
#include <offnominal/hal/protocols/protected/address.hpp>
#include <offnominal/hal/record.hpp>
#include <set>

namespace offnominal::hal {
namespace {

constexpr std::uint16_t kRecordId = data_id_of(MessageKind::kEncoder, 1);

Record with_flipped(Record record, std::uint64_t pattern) {
  for (std::size_t byte = 0; byte < record.size(); ++byte) {
    record[byte] = static_cast<std::uint8_t>(record[byte] ^ (pattern >> (8 * byte)));
  }
  return record;
}

bool opens(const Record& record, std::uint16_t id = kRecordId) {
  Content content{};
  std::uint8_t counter = 0;
  return open(record, id, content, counter) == Status::kOk;
}

// Calls `use` with every pattern of `weight` bits of 64.
template <typename Use>
void for_every_pattern(int weight, Use&& use) {
  if (weight == 0) {
    use(std::uint64_t{0});
    return;
  }
  // Next number with as many bits set (Gosper): ends when it runs over.
  std::uint64_t pattern = (std::uint64_t{1} << static_cast<unsigned>(weight)) - 1;
  for (;;) {
    use(pattern);
    const std::uint64_t lowest = pattern & (~pattern + 1);
    const std::uint64_t ripple = pattern + lowest;
    if (ripple == 0 || ripple < pattern) return;
    pattern = ripple | (((pattern ^ ripple) >> 2U) >> std::countr_zero(lowest));
  }
}

TEST(Record, OpensToWhatWasSealed) {
  const Content sealed{1, 2, 250, 0, 77};
  const Record record = seal(sealed, 200, kRecordId);
  Content content{};
  std::uint8_t counter = 0;
  ASSERT_EQ(open(record, kRecordId, content, counter), Status::kOk);
  EXPECT_EQ(content, sealed);
  EXPECT_EQ(counter, 200);
}

TEST(Record, EveryErrorOfOneToFiveBitsIsSeen) {
  const Record record = seal({0x12, 0x00, 0xFF, 0xA5, 0x3C}, 9, kRecordId);
  std::uint64_t tried = 0;
  std::uint64_t missed = 0;
  for (int weight = 1; weight <= 5; ++weight) {
    for_every_pattern(weight, [&](std::uint64_t pattern) {
      ++tried;
      if (opens(with_flipped(record, pattern))) ++missed;
    });
  }
  EXPECT_EQ(tried, 64U + 2016U + 41664U + 635376U + 7624512U);
  EXPECT_EQ(missed, 0U);
}

// The distance is 6, no more: of errors of six bits some pass, so the test above can fail.
TEST(Record, SomeErrorOfSixBitsIsNotSeen) {
  const Record record = seal({0x12, 0x00, 0xFF, 0xA5, 0x3C}, 9, kRecordId);
  std::uint64_t missed = 0;
  // Weight 6 with one of the bits fixed is enough to find some.
  for_every_pattern(5, [&](std::uint64_t pattern) {
    if ((pattern & 1U) == 0 && opens(with_flipped(record, pattern | 1U))) ++missed;
  });
  EXPECT_GT(missed, 0U);
}

TEST(Record, EveryBurstOfUpToSixteenBitsIsSeen) {
  const Record record = seal({0, 0, 0, 0, 0}, 0, kRecordId);
  // Bits in the order of the wire: byte by byte, the most significant first.
  const auto on_wire = [](std::uint64_t bits) {
    std::uint64_t pattern = 0;
    for (unsigned i = 0; i < 64; ++i) {
      if (((bits >> i) & 1U) == 0) continue;
      pattern |= std::uint64_t{1} << (8 * (i / 8) + 7 - i % 8);
    }
    return pattern;
  };
  std::uint64_t missed = 0;
  for (unsigned start = 0; start < 64; ++start) {
    for (std::uint64_t burst = 1; burst < 65536; burst += 2) {
      if (start + static_cast<unsigned>(std::bit_width(burst)) > 64) break;
      if (opens(with_flipped(record, on_wire(burst << start)))) ++missed;
    }
  }
  EXPECT_EQ(missed, 0U);
}

TEST(Record, IsNotAnotherDataIds) {
  std::set<std::uint16_t> ids;
  for (int kind = 0; kind < kMessageKinds; ++kind) {
    for (int node = 0; node < kMaxNodes; ++node) {
      ids.insert(data_id_of(static_cast<MessageKind>(kind), static_cast<std::uint8_t>(node)));
    }
  }
  ASSERT_EQ(ids.size(), static_cast<std::size_t>(kMessageKinds * kMaxNodes));
  EXPECT_FALSE(ids.contains(0));
  for (const std::uint16_t mine : ids) {
    const Record record = seal({7, 7, 7, 7, 7}, 7, mine);
    for (const std::uint16_t other : ids) {
      ASSERT_EQ(opens(record, other), mine == other) << mine << " as " << other;
    }
  }
}

TEST(Record, OfZerosIsNoRecord) {
  for (int kind = 0; kind < kMessageKinds; ++kind) {
    for (int node = 0; node < kMaxNodes; ++node) {
      const auto id = data_id_of(static_cast<MessageKind>(kind), static_cast<std::uint8_t>(node));
      EXPECT_FALSE(opens(Record{}, id)) << kind << ' ' << node;
    }
  }
}

}  // namespace
}  // namespace offnominal::hal
