#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <offnominal/diagnosis/estimator_config.hpp>
#include <string>
#include <vector>

#include "core/print_status.hpp"

namespace offnominal::test {
namespace {

constexpr int kCapacity = 35;

template <typename Scalar>
struct Refusal {
  std::string name;
  std::function<void(EstimatorConfig<Scalar>&)> spoil;
  Status status;
};

template <typename Scalar>
std::vector<Refusal<Scalar>> refusals() {
  using Config = EstimatorConfig<Scalar>;
  std::vector<Refusal<Scalar>> all{
      {"hidden units 0", [](Config& c) { c.hidden_units = 0; }, Status::kInvalidHiddenUnits},
      {"hidden units -1", [](Config& c) { c.hidden_units = -1; }, Status::kInvalidHiddenUnits},
      {"hidden units above the capacity", [](Config& c) { c.hidden_units = kCapacity + 1; },
       Status::kInvalidHiddenUnits},
      {"a tick longer than the filter", [](Config& c) { c.period_s = Scalar(0.11); },
       Status::kUnstablePeriod},
      {"learning rate -1", [](Config& c) { c.learning_rate = -1; }, Status::kInvalidLearningRate},
  };
  const Scalar infinity = std::numeric_limits<Scalar>::infinity();
  const Scalar not_a_number = std::numeric_limits<Scalar>::quiet_NaN();
  for (const Scalar bad : {Scalar(0), Scalar(-1), infinity, -infinity, not_a_number}) {
    const std::string to_bad = " = " + std::to_string(bad);
    all.push_back(
        {"period" + to_bad, [=](Config& c) { c.period_s = bad; }, Status::kInvalidPeriod});
    all.push_back(
        {"alpha" + to_bad, [=](Config& c) { c.alpha = bad; }, Status::kInvalidFilterPole});
    all.push_back({"radius" + to_bad, [=](Config& c) { c.weight_radius = bad; },
                   Status::kInvalidWeightRadius});
    all.push_back({"initial range" + to_bad, [=](Config& c) { c.initial_weight_range = bad; },
                   Status::kInvalidInitialWeights});
    if (bad != 0) {
      all.push_back({"learning rate" + to_bad, [=](Config& c) { c.learning_rate = bad; },
                     Status::kInvalidLearningRate});
    }
  }
  return all;
}

template <typename Scalar>
void expect_each_refused() {
  ASSERT_EQ(validate<kCapacity>(EstimatorConfig<Scalar>{}), Status::kOk);
  for (const Refusal<Scalar>& refusal : refusals<Scalar>()) {
    EstimatorConfig<Scalar> config;
    refusal.spoil(config);
    EXPECT_EQ(validate<kCapacity>(config), refusal.status) << refusal.name;
  }
}

TEST(EstimatorConfig, EachBadSettingIsRefusedWithItsOwnStatusInDouble) {
  expect_each_refused<double>();
}

TEST(EstimatorConfig, EachBadSettingIsRefusedWithItsOwnStatusInFloat) {
  expect_each_refused<float>();
}

TEST(EstimatorConfig, ALearningRateOfZeroDetectsOnly) {
  EstimatorConfig<double> config;
  config.learning_rate = 0;
  EXPECT_EQ(validate<kCapacity>(config), Status::kOk);
}

TEST(EstimatorConfig, TheLongestTickIsOneOverAlpha) {
  EstimatorConfig<double> config;
  config.alpha = 10;
  config.period_s = 0.1;
  EXPECT_EQ(validate<kCapacity>(config), Status::kOk);
  config.period_s = std::nextafter(0.1, 1.0) + 1e-15;
  EXPECT_EQ(validate<kCapacity>(config), Status::kUnstablePeriod);
}

}  // namespace
}  // namespace offnominal::test
