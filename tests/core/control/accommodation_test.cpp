#include <gtest/gtest.h>

#include <limits>
#include <offnominal/control/accommodation.hpp>

#include "core/model/random_chain.hpp"
#include "support/seed.hpp"

namespace offnominal::test {
namespace {

constexpr double kUnlimited = std::numeric_limits<double>::max();

// Eq. (31): tau_r = tau - M psi_hat.
TEST(Accommodation, GivenRoomThenTheTorqueIsMinusInertiaTimesFaultEstimate) {
  std::mt19937_64 generator = seeded_generator();
  for (int sample = 0; sample < 200; ++sample) {
    Matrix<3, 3, double> inertia;
    for (Eigen::Index i = 0; i < 3; ++i) inertia.col(i) = random_vector3(generator, 2);
    const Eigen::Vector3d psi_hat = random_vector3(generator, 5);
    const Eigen::Vector3d limit = Eigen::Vector3d::Constant(kUnlimited);
    const auto result = compensating_torque<3, double>(inertia, psi_hat, limit);
    EXPECT_LE(deviation(result.torque, -(inertia * psi_hat)), 1e-14);
    EXPECT_FALSE(result.saturated);
  }
}

TEST(Accommodation, GivenLimitsThenEachJointIsClampedToItsOwnAndItIsSaid) {
  const Matrix<3, 3, double> inertia = Eigen::Vector3d(1, 2, 3).asDiagonal();
  const Eigen::Vector3d psi_hat(1, -5, 2);
  const auto result = compensating_torque<3, double>(inertia, psi_hat, {0.5, 4, 7});
  EXPECT_EQ(result.torque, Eigen::Vector3d(-0.5, 4, -6));
  EXPECT_TRUE(result.saturated);
}

TEST(Accommodation, GivenATorqueAtItsLimitThenItIsNotYetSaturated) {
  const Matrix<1, 1, float> inertia(2.0F);
  const auto at_limit =
      compensating_torque<1, float>(inertia, Vector<1, float>(3.0F), Vector<1, float>(6.0F));
  EXPECT_EQ(at_limit.torque[0], -6.0F);
  EXPECT_FALSE(at_limit.saturated);
  const auto beyond =
      compensating_torque<1, float>(inertia, Vector<1, float>(-3.001F), Vector<1, float>(6.0F));
  EXPECT_EQ(beyond.torque[0], 6.0F);
  EXPECT_TRUE(beyond.saturated);
}

TEST(Accommodation, GivenALimitOfZeroThenNothingIsCommanded) {
  const Matrix<2, 2, double> inertia = Matrix<2, 2, double>::Identity();
  const auto idle = compensating_torque<2, double>(inertia, {0, 0}, Eigen::Vector2d::Zero());
  EXPECT_TRUE(idle.torque.isZero(0));
  EXPECT_FALSE(idle.saturated);
  const auto faulty = compensating_torque<2, double>(inertia, {1, -1}, Eigen::Vector2d::Zero());
  EXPECT_TRUE(faulty.torque.isZero(0));
  EXPECT_TRUE(faulty.saturated);
}

TEST(Accommodation, NaNInNaNOut) {
  const Matrix<1, 1, double> inertia(2.0);
  const Vector<1, double> nan(std::numeric_limits<double>::quiet_NaN());
  EXPECT_TRUE(
      std::isnan(compensating_torque<1, double>(inertia, nan, Vector<1, double>(1.0)).torque[0]));
}

}  // namespace
}  // namespace offnominal::test
