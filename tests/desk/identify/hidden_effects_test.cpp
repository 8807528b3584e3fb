#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <offnominal/sim/hidden/case.hpp>
#include <string>
#include <vector>

#include "desk/explain/hidden_case.hpp"
#include "desk/support/effect_parameter.hpp"
#include "identify/add.hpp"
#include "replay/replay.hpp"
#include "robot/robot_file.hpp"
#include "support/repetitions.hpp"

// From a recording of a simulated robot, whose physics is the simulator's own, over `add` and the
// robot file's text to the on-board monitor: what was hidden is found, and a monitor with a bound
// tight enough to see it stays silent once the file has it.

namespace {

namespace hidden = offnominal::sim::hidden;
using offnominal::EffectKind;
using offnominal::info_of;
using offnominal::kAllEffectInfos;
using offnominal::test::to_log;
using offnominal::test::to_robot;
using namespace offnominal::desk;
using namespace offnominal::desk;

EffectKind kind_named(const std::string& name) {
  for (const auto& info : kAllEffectInfos) {
    if (name == info.name) return info.kind;
  }
  ADD_FAILURE() << name;
  return EffectKind::kViscousFriction;
}

double true_value(const hidden::TrueEffect& truth, const std::string& name) {
  for (const hidden::TrueParameter& parameter : truth.parameters) {
    if (parameter.name == name) return parameter.value;
  }
  return 0;
}

// The first parameters that the simulator drew, in the robot file's terms.
double expected_value(const hidden::TrueEffect& truth, const std::string& name) {
  if (name == "factor") return true_value(truth, "coefficient");
  if (name == "error") return 1 / (1 + true_value(truth, "share")) - 1;
  return true_value(truth, name);
}

struct Tried {
  hidden::HiddenEffect effect;
  std::string parameter;  // its first one that is not 0
  double tolerance;       // share of the true value
  bool refit_inertia;     // masses are off by 3 %; a scale cannot be told from them
  double size = 1;        // of what the simulator draws: for the monitor to see it beside the rest
};

void PrintTo(const Tried& tried, std::ostream* out) { *out << hidden::name(tried.effect); }

class HiddenEffectInFile : public ::testing::TestWithParam<Tried> {
 protected:
  void SetUp() override {
    hidden::Request request;
    request.seed = 5;
    request.effects = {GetParam().effect};
    request.effect_size = GetParam().size;
    made_ = hidden::make_case(request);
    nominal_ = to_robot(made_.nominal);
    AddRequest add_request;
    add_request.effects = {kind_named(std::string(hidden::name(GetParam().effect)))};
    add_request.joint = static_cast<std::size_t>(made_.truth.effects[0].joint);
    if (GetParam().refit_inertia) add_request.inertia_deviation = 0.05;
    result_ = add(nominal_, add_request, {to_log(made_.recording)}, {}, FilterRequest{12.0, {}});
    // What was written is what is read.
    improved_ = parse_robot(robot_text(result_.robot), "improved.toml");
  }

  double fitted(const std::string& name) const {
    return offnominal::test::parameter_of(improved_.effects[result_.added[0]], name);
  }

  hidden::Case made_;
  RobotDescription nominal_;
  AddResult result_;
  RobotDescription improved_;
};

TEST_P(HiddenEffectInFile, IsFoundInItsTrueSize) {
  EXPECT_TRUE(result_.objections.empty());
  const double expected = expected_value(made_.truth.effects[0], GetParam().parameter);
  ASSERT_NE(expected, 0);
  std::cout << GetParam().parameter << " " << fitted(GetParam().parameter) << ", true " << expected
            << '\n';
  EXPECT_NEAR(fitted(GetParam().parameter), expected, GetParam().tolerance * std::abs(expected));
}

bool alarms(RobotDescription robot, const Log& log, double bound) {
  robot.bound = BoundSettings{};
  robot.bound->constant.value = bound;
  robot.bound->velocity_error = 0.01;
  return !replay(robot, log).alarms.empty();
}

TEST_P(HiddenEffectInFile, ThenTheMonitorIsSilentWithABoundThatShowsItsAbsence) {
  const Log calibration = to_log(made_.recording);
  double loud = 0.05;
  double quiet = 0.1;
  for (; alarms(improved_, calibration, quiet); quiet *= 2) loud = quiet;
  while (quiet > 1.1 * loud) {
    const double between = std::sqrt(loud * quiet);
    (alarms(improved_, calibration, between) ? loud : quiet) = between;
  }
  const double bound = 1.2 * quiet;
  std::cout << "bound " << bound << " rad/s^2\n";
  EXPECT_TRUE(alarms(nominal_, calibration, bound));
  EXPECT_FALSE(alarms(improved_, to_log(made_.holdout), bound));
  EXPECT_TRUE(alarms(nominal_, to_log(made_.holdout), bound));
}

const std::vector<Tried> kTried{
    {hidden::HiddenEffect::kJointCoupling, "coefficient", 0.1, true},
    {hidden::HiddenEffect::kTemperatureDrift, "time_constant", 0.25, true},
    {hidden::HiddenEffect::kLoadDependentFriction, "factor", 0.1, true},
    {hidden::HiddenEffect::kTorqueScale, "error", 0.35, false},
    {hidden::HiddenEffect::kHysteresis, "level", 0.1, true},
    {hidden::HiddenEffect::kTimeDelay, "delay", 0.1, true, 3}};

INSTANTIATE_TEST_SUITE_P(All, HiddenEffectInFile,
                         ::testing::ValuesIn(offnominal::test::every_nth(kTried, 6)),
                         [](const auto& parameter) {
                           return std::string(hidden::name(parameter.param.effect));
                         });

}  // namespace
