// Every hidden effect shows in the torque with about the size that effect_table.hpp documents.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <ostream>
#include <string>

#include "unexplained.hpp"

namespace offnominal::sim::hidden {
namespace {

constexpr int kSeeds = 20;

struct Bounds {
  HiddenEffect effect;
  double low, high;        // of the mean share of the joint's torque
  double slow_low = -1.0;  // of the part below 20 Hz, where impacts make the rest
  double slow_high = 1.0;
};

std::ostream& operator<<(std::ostream& out, const Bounds& bounds) {
  return out << name(bounds.effect);
}

class EffectSize : public testing::TestWithParam<Bounds> {};

TEST_P(EffectSize, IsVisibleAndDoesNotDominate) {
  const Bounds& bounds = GetParam();
  double mean = 0.0, mean_slow = 0.0, smallest = 1e9, largest = 0.0;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    Request request{seed, {bounds.effect}};
    request.duration_s = 3.0;
    const test::Share share = test::share(request);
    mean += share.own / kSeeds;
    mean_slow += share.own_slow / kSeeds;
    smallest = std::min(smallest, share.own);
    largest = std::max(largest, share.own);
  }
  std::printf("%-24s share of rms torque: mean %.3f, %.3f to %.3f; below 20 Hz mean %.3f\n",
              std::string(name(bounds.effect)).c_str(), mean, smallest, largest, mean_slow);
  EXPECT_GT(mean, bounds.low);
  EXPECT_LT(mean, bounds.high);
  EXPECT_GT(mean_slow, bounds.slow_low);
  EXPECT_LT(mean_slow, bounds.slow_high);
}

// Three seconds of thirty: some of them are slow phases, hence the wide bounds.
INSTANTIATE_TEST_SUITE_P(HiddenRobots, EffectSize,
                         testing::Values(Bounds{HiddenEffect::kCoulombFriction, 0.07, 0.13},
                                         Bounds{HiddenEffect::kViscousFriction, 0.05, 0.12},
                                         Bounds{HiddenEffect::kQuadraticFriction, 0.06, 0.14},
                                         Bounds{HiddenEffect::kStribeckFriction, 0.03, 0.07},
                                         Bounds{HiddenEffect::kFrictionAsymmetry, 0.06, 0.12},
                                         Bounds{HiddenEffect::kLoadDependentFriction, 0.05, 0.11},
                                         Bounds{HiddenEffect::kHysteresis, 0.06, 0.13},
                                         Bounds{HiddenEffect::kTorqueOffset, 0.045, 0.1},
                                         Bounds{HiddenEffect::kTorqueScale, 0.1, 0.16},
                                         Bounds{HiddenEffect::kRotorInertia, 0.06, 0.15},
                                         Bounds{HiddenEffect::kLinkMass, 0.1, 0.2},
                                         Bounds{HiddenEffect::kTipPayload, 0.08, 0.15},
                                         Bounds{HiddenEffect::kCoggingTorque, 0.04, 0.1},
                                         Bounds{HiddenEffect::kJointStiffness, 0.05, 0.1},
                                         Bounds{HiddenEffect::kJointElasticity, 0.04, 0.14, 0.025,
                                                0.09},
                                         Bounds{HiddenEffect::kBacklash, 0.15, 0.7, 0.03, 0.13},
                                         Bounds{HiddenEffect::kTimeDelay, 0.007, 0.03},
                                         Bounds{HiddenEffect::kPeriodicDisturbance, 0.04, 0.1},
                                         Bounds{HiddenEffect::kJointCoupling, 0.05, 0.13},
                                         Bounds{HiddenEffect::kTemperatureDrift, 0.08, 0.2},
                                         Bounds{HiddenEffect::kGearLoss, 0.1, 0.3},
                                         Bounds{HiddenEffect::kPositionTorque, 0.08, 0.22}),
                         [](const auto& given) { return std::string(name(given.param.effect)); });

TEST(EffectSize, NothingHiddenLeavesNothingUnexplained) {
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    Request request{seed, {}};
    request.duration_s = 4.0;
    const test::Share share = test::share(request);
    // A joint that sticks rings faster than the trace can show: the whole is looser than the slow.
    EXPECT_LT(share.own, 0.03) << seed;
    EXPECT_LT(share.other, 0.03) << seed;
    EXPECT_LT(share.own_slow, 0.012) << seed;
  }
}

TEST(EffectSize, GrowsWithTheRequestedFactor) {
  for (const HiddenEffect effect :
       {HiddenEffect::kCoulombFriction, HiddenEffect::kStribeckFriction,
        HiddenEffect::kJointElasticity, HiddenEffect::kTipPayload, HiddenEffect::kTimeDelay}) {
    Request request{7, {effect}};
    request.duration_s = 8.0;
    const double whole = test::share(request).own_slow;
    request.effect_size = 0.4;
    const double part = test::share(request).own_slow;
    EXPECT_GT(part / whole, 0.25) << name(effect);
    EXPECT_LT(part / whole, 0.6) << name(effect);
  }
}

class OutsideSize : public testing::TestWithParam<OutsideEffect> {};

TEST_P(OutsideSize, ShowsAtItsJointOnly) {
  double own = 0.0, other = 0.0;
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
    Request request{seed, {}};
    request.outside = GetParam();
    const test::Share share = test::share(request);
    own += share.own / 2.0;
    other += share.other / 2.0;
  }
  EXPECT_GT(own, 0.05);
  EXPECT_LT(own, 0.15);
  EXPECT_LT(other, 0.006);
}

INSTANTIATE_TEST_SUITE_P(HiddenRobots, OutsideSize, testing::ValuesIn(all_outside_effects()),
                         [](const auto& given) { return std::string(name(given.param)); });

}  // namespace
}  // namespace offnominal::sim::hidden
