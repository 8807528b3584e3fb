#include "true_parameters.hpp"

#include <cmath>

namespace offnominal::bench {

using sim::hidden::HiddenEffect;
using sim::hidden::TrueEffect;
using sim::hidden::TrueParameter;

namespace {

constexpr double kMotionRad = 1.0;

double value_of(const TrueEffect& truth, const std::string& name) {
  for (const TrueParameter& parameter : truth.parameters) {
    if (parameter.name == name) return parameter.value;
  }
  return 0;
}

ExpectedParameter same(const TrueParameter& parameter) {
  return {parameter.name, parameter.value, std::abs(parameter.value)};
}

std::vector<ExpectedParameter> only(const std::string& name, double value) {
  return {{name, value, std::abs(value)}};
}

}  // namespace

std::vector<ExpectedParameter> expected_parameters(const TrueEffect& truth,
                                                   double sampling_period_s) {
  switch (truth.effect) {
    case HiddenEffect::kLoadDependentFriction:
      return only("factor", value_of(truth, "coefficient"));
    case HiddenEffect::kTorqueScale:
      return only("error", 1 / (1 + value_of(truth, "share")) - 1);
    case HiddenEffect::kBacklash:
      return only("width", value_of(truth, "gap"));
    case HiddenEffect::kJointElasticity:
      return only("stiffness", value_of(truth, "stiffness"));
    case HiddenEffect::kTimeDelay:
      return only("delay", value_of(truth, "delay") + sampling_period_s / 2);
    default:
      break;
  }
  const double amplitude = std::hypot(value_of(truth, "sine"), value_of(truth, "cosine"));
  std::vector<ExpectedParameter> expected;
  for (const TrueParameter& parameter : truth.parameters) {
    expected.push_back(same(parameter));
    if (parameter.name == "sine" || parameter.name == "cosine") expected.back().scale = amplitude;
    if (parameter.name == "rest_position") expected.back().scale = kMotionRad;
  }
  return expected;
}

}  // namespace offnominal::bench
