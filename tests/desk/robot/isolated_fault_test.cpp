#include "robot/isolated_fault.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace offnominal::desk {
namespace {

using ::testing::HasSubstr;

std::string words(FaultKind kind, double size, double deviation, const std::string& unit) {
  IsolatedFault fault;
  fault.kind = kind;
  fault.size = size;
  fault.deviation = deviation;
  fault.unit = unit;
  fault.confidence = 1;
  fault.decided = true;
  return words_of(fault, {"elbow"});
}

TEST(IsolatedFault, HasARangeAboutItsSize) {
  EXPECT_THAT(words(FaultKind::kOffset, -20, 1.5, "N m"), HasSubstr("-20 N m (-23 to -17)"));
  EXPECT_THAT(words(FaultKind::kOffset, 20, 1.5, "N m"), HasSubstr("torque of 20 N m (17 to 23)"));
  EXPECT_THAT(words(FaultKind::kFriction, -2, 0.5, "N m"),
              HasSubstr("friction down by 2 N m (1 to 3)"));
  EXPECT_THAT(words(FaultKind::kLostTorque, -0.1, 0.02, "1"),
              HasSubstr("torque gained, 10 % (6 to 14)"));
  EXPECT_THAT(words(FaultKind::kPayload, -0.5, 0.3, "kg"),
              HasSubstr("payload lost, 0.5 kg (-0.1 to 1.1)"));
}

}  // namespace
}  // namespace offnominal::desk
