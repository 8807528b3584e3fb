#include <gtest/gtest.h>

#include <limits>
#include <offnominal/model/chain.hpp>
#include <string>

#include "core/print_status.hpp"

namespace offnominal::test {
namespace {

template <typename Scalar>
Effect<Scalar> usable_effect(const EffectInfo& info) {
  Effect<Scalar> effect{info.kind, 0, {}};
  for (std::size_t i = 0; i < info.parameters.size(); ++i) effect.parameters[i] = 1;
  return effect;
}

template <typename Scalar>
Status status_of(const Effect<Scalar>& effect) {
  Chain<1, Scalar> chain;
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
      effect.parameters[i] = static_cast<Scalar>(min - 1e-10);
      EXPECT_EQ(status_of(effect), Status::kInvalidEffect) << parameter << " below " << min;
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
    for (const double end : {GetParam().parameters[i].min, GetParam().parameters[i].max}) {
      effect.parameters[i] = end;
      EXPECT_EQ(status_of(effect), Status::kOk) << GetParam().parameters[i].name << " = " << end;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, EffectValidation, testing::ValuesIn(kAllEffectInfos),
                         [](const testing::TestParamInfo<EffectInfo>& tested) {
                           return std::string(tested.param.name);
                         });

}  // namespace
}  // namespace offnominal::test
