#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <offnominal/model/chain.hpp>
#include <string>

#include "core/print_status.hpp"

namespace offnominal::test {
namespace {

template <typename Scalar>
Effect<Scalar> usable_effect(const EffectInfo& info) {
  Effect<Scalar> effect{info.kind, 1, {}};
  for (std::size_t i = 0; i < info.parameters.size(); ++i) {
    effect.parameters[i] = static_cast<Scalar>(std::min(1.0, 0.9 * info.parameters[i].max));
  }
  return effect;
}

template <typename Scalar>
Status status_of(const Effect<Scalar>& effect) {
  Chain<3, Scalar> chain;
  EXPECT_TRUE(chain.effects.add(effect));
  return validate(chain);
}

// Every parameter of the effect in turn: not a number, infinite, and just outside of its range.
template <typename Scalar>
void expect_bad_parameters_refused(const EffectInfo& info) {
  ASSERT_EQ(status_of(usable_effect<Scalar>(info)), Status::kOk);
  const Scalar infinity = std::numeric_limits<Scalar>::infinity();
  const Scalar not_a_number = std::numeric_limits<Scalar>::quiet_NaN();
  for (std::size_t i = 0; i < info.parameters.size(); ++i) {
    const std::string parameter = info.parameters[i].name;
    Effect<Scalar> effect = usable_effect<Scalar>(info);
    for (const Scalar bad : {not_a_number, infinity, -infinity}) {
      effect.parameters[i] = bad;
      EXPECT_EQ(status_of(effect), Status::kInvalidEffect) << parameter << " = " << bad;
    }
    const double min = info.parameters[i].min;
    if (min > -1e300) {
      effect.parameters[i] = static_cast<Scalar>(min - 0.1 * std::max(std::fabs(min), 1e-9));
      EXPECT_EQ(status_of(effect), Status::kInvalidEffect) << parameter << " below " << min;
    }
    const double max = info.parameters[i].max;
    if (max < 1e300) {
      effect.parameters[i] = static_cast<Scalar>(1.1 * max);
      EXPECT_EQ(status_of(effect), Status::kInvalidEffect) << parameter << " above " << max;
    }
  }
}

class EffectValidation : public testing::TestWithParam<EffectInfo> {};

TEST_P(EffectValidation, RefusesEveryParameterOutsideItsRange) {
  expect_bad_parameters_refused<double>(GetParam());
  expect_bad_parameters_refused<float>(GetParam());
}

TEST_P(EffectValidation, AcceptsTheEndsOfEveryRange) {
  for (std::size_t i = 0; i < GetParam().parameters.size(); ++i) {
    Effect<double> effect = usable_effect<double>(GetParam());
    if (GetParam().parameters[i].quantity == Quantity::kJointNumber) continue;  // see below
    for (const double end : {GetParam().parameters[i].min, GetParam().parameters[i].max}) {
      effect.parameters[i] = end;
      EXPECT_EQ(status_of(effect), Status::kOk) << GetParam().parameters[i].name << " = " << end;
    }
  }
}

TEST(JointCouplingValidation, TheOtherJointIsOneOfTheChainAndNotTheEffectsOwn) {
  const auto status_with = [](double source) {
    return status_of<double>({EffectKind::kJointCoupling, 1, {1, 1, source, 0.01}});
  };
  EXPECT_EQ(status_with(1), Status::kOk);
  EXPECT_EQ(status_with(3), Status::kOk);
  for (const double bad : {2.0, 0.0, 4.0, 1e9, -1.0, 1.5, 2.5}) {
    EXPECT_EQ(status_with(bad), Status::kInvalidEffect) << bad;
  }
}

TEST(LoadDependentFrictionValidation, TheFactorsOfOneJointAddUpToLessThanLocking) {
  const auto status_with = [](std::uint8_t second_joint, double second) {
    Chain<2, double> chain;
    EXPECT_TRUE(chain.effects.add({EffectKind::kLoadDependentFriction, 0, {0.5, 0.01}}));
    EXPECT_TRUE(
        chain.effects.add({EffectKind::kLoadDependentFriction, second_joint, {second, 0.01}}));
    return validate(chain);
  };
  EXPECT_EQ(status_with(0, 0.44), Status::kOk);
  EXPECT_EQ(status_with(1, 0.9), Status::kOk);
  EXPECT_EQ(status_with(0, 0.46), Status::kInvalidEffect);
}

INSTANTIATE_TEST_SUITE_P(All, EffectValidation, testing::ValuesIn(kAllEffectInfos),
                         [](const testing::TestParamInfo<EffectInfo>& tested) {
                           return std::string(tested.param.name);
                         });

}  // namespace
}  // namespace offnominal::test
