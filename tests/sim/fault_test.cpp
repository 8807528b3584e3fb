#include "offnominal/sim/fault.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

namespace offnominal::sim {
namespace {

Fault mass_loss(double share, double rate = 0.5) {
  Fault fault;
  fault.kind = FaultKind::kMassLoss;
  fault.mass_loss = share;
  fault.rate_per_s = rate;
  return fault;
}

TEST(Fault, PaperMassFallsFromHalfAKilogramToAnEighth) {
  const Fault fault = mass_loss(0.75);
  EXPECT_EQ(faulty_arm({}, fault, 0.0).mass1_kg, 0.5);
  EXPECT_EQ(faulty_arm({}, fault, 10.0).mass1_kg, 0.5);
  for (const double t : {10.5, 11.0, 13.0, 20.0}) {
    EXPECT_NEAR(faulty_arm({}, fault, t).mass1_kg, 0.125 + 0.375 * std::exp(-0.5 * (t - 10.0)),
                1e-15);
  }
  EXPECT_NEAR(faulty_arm({}, fault, 200.0).mass1_kg, 0.125, 1e-15);
  EXPECT_EQ(faulty_arm({}, fault, 20.0).mass2_kg, 2.0);
}

TEST(Fault, AbruptFaultIsCompleteAtItsOnset) {
  const Fault fault = mass_loss(0.75, kAbrupt);
  EXPECT_EQ(time_profile(fault, std::nextafter(10.0, 0.0)), 0.0);
  EXPECT_EQ(time_profile(fault, 10.0), 1.0);
  EXPECT_EQ(faulty_arm({}, fault, 10.0).mass1_kg, 0.125);
}

TEST(Fault, ProfileStartsAtZeroRisesAndStaysBelowOne) {
  const Fault fault = mass_loss(0.75);
  double last = time_profile(fault, 10.0);
  EXPECT_EQ(last, 0.0);
  for (int k = 1; k <= 1000; ++k) {
    const double beta = time_profile(fault, 10.0 + 0.01 * k);
    EXPECT_GT(beta, last);
    EXPECT_LT(beta, 1.0);
    last = beta;
  }
}

TEST(Fault, HealthyPlantHasNoProfile) { EXPECT_EQ(time_profile({}, 15.0), 0.0); }

TEST(Fault, NonlinearFaultIsEquationThirty) {
  const TwoLinkState s{{0.1, -0.2}, {9.0, 0.5}};
  const Eigen::Vector2d psi = nonlinear_fault(s);
  EXPECT_NEAR(psi[0], 0.075 + 10.0 * 0.01 * 0.25 - 1.4 + 17.0, 1e-14);
  EXPECT_NEAR(psi[1], -1.0 + 12.5, 1e-14);
}

TEST(Fault, RefusesWrongFields) {
  EXPECT_THROW(validate(mass_loss(1.0)), std::invalid_argument);
  EXPECT_THROW(validate(mass_loss(-0.1)), std::invalid_argument);
  EXPECT_THROW(validate(mass_loss(std::nan(""))), std::invalid_argument);
  EXPECT_THROW(validate(mass_loss(0.5, 0.0)), std::invalid_argument);
  EXPECT_THROW(validate(mass_loss(0.5, std::nan(""))), std::invalid_argument);
  Fault never = mass_loss(0.5);
  never.time_s = std::numeric_limits<double>::infinity();
  EXPECT_THROW(validate(never), std::invalid_argument);
  EXPECT_NO_THROW(validate(mass_loss(0.0, kAbrupt)));
}

}  // namespace
}  // namespace offnominal::sim
