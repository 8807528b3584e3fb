#include <gtest/gtest.h>

#include <offnominal/model/quantity.hpp>

namespace offnominal::test {
namespace {

struct Units {
  Quantity quantity;
  const char* revolute;
  const char* prismatic;
};

class UnitOf : public testing::TestWithParam<Units> {};

TEST_P(UnitOf, FollowsTheJoint) {
  EXPECT_STREQ(unit_of(GetParam().quantity, JointType::kRevolute), GetParam().revolute);
  EXPECT_STREQ(unit_of(GetParam().quantity, JointType::kPrismatic), GetParam().prismatic);
}

INSTANTIATE_TEST_SUITE_P(
    All, UnitOf,
    testing::Values(
        Units{Quantity::kEffort, "N m", "N"},
        Units{Quantity::kEffortPerVelocity, "N m s/rad", "N s/m"},
        Units{Quantity::kEffortPerVelocitySquared, "N m s^2/rad^2", "N s^2/m^2"},
        Units{Quantity::kEffortPerPosition, "N m/rad", "N/m"},
        Units{Quantity::kPosition, "rad", "m"}, Units{Quantity::kVelocity, "rad/s", "m/s"},
        Units{Quantity::kReflectedInertia, "kg m^2", "kg"}, Units{Quantity::kMass, "kg", "kg"},
        Units{Quantity::kDistance, "rad", "m"}, Units{Quantity::kLength, "m", "m"},
        Units{Quantity::kCyclesPerPosition, "1/turn", "1/m"},
        Units{Quantity::kAngularFrequency, "rad/s", "rad/s"}, Units{Quantity::kTime, "s", "s"},
        Units{Quantity::kRatio, "1", "1"}, Units{Quantity::kJointNumber, "", ""}));

}  // namespace
}  // namespace offnominal::test
