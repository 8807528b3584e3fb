// The loop from a recording that cannot tell to one that can, on simulated robots whose physics is
// the simulator's own. The rate of success is the benchmark's business (./dev bench discovery
// --cases motion).

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <numbers>
#include <offnominal/sim/hidden/draw_robot.hpp>
#include <sstream>

#include "desk/explain/hidden_case.hpp"
#include "explain/explain.hpp"
#include "motion/design.hpp"
#include "support/repetitions.hpp"

namespace offnominal::desk::motion {
namespace {

namespace hidden = sim::hidden;
using test::to_log;
using test::to_robot;
using ::testing::Contains;
using ::testing::HasSubstr;

Explanation explain_quickly(const RobotDescription& robot, const Log& log) {
  ExplainOptions options;
  options.bootstrap_draws = 399;
  options.threads = 2;
  return explain(robot, {log}, {}, options);
}

// Joint 1 and 2 on a few sines each, so many seconds.
Log record_sines(const hidden::Request& request, const hidden::Nominal& nominal, double duration_s,
                 const std::vector<std::pair<double, double>>& amplitude_and_hz) {
  const auto rows = static_cast<Eigen::Index>(duration_s * 100) + 1;
  const Eigen::VectorXd t_s = Eigen::VectorXd::LinSpaced(rows, 0, duration_s);
  Eigen::MatrixXd q(rows, 2);
  for (std::size_t j = 0; j < 2; ++j) {
    const auto& joint = nominal.joints[j];
    const auto column = static_cast<Eigen::Index>(j);
    q.col(column).setConstant((joint.position_min_rad + joint.position_max_rad) / 2);
    for (const auto& [amplitude, hz] : amplitude_and_hz) {
      const double rate = 2 * std::numbers::pi * hz * (j == 0 ? 1 : 1.3);
      q.col(column).array() += amplitude * (rate * t_s.array()).sin();
    }
  }
  return to_log(hidden::record_motion(request, t_s, q));
}

Explanation explain_designed(const hidden::Request& request, const RobotDescription& robot,
                             DesignRequest design) {
  design.starts = 24;
  design.threads = 2;
  const Motion motion = design_motion(robot, design).fitted.motion;
  return explain_quickly(robot, to_log(hidden::record_motion(request, motion.t_s, motion.q, 1)));
}

void expect_found(const Explanation& e, const hidden::TrueEffect& truth) {
  ASSERT_FALSE(e.found.empty()) << e.words;
  EXPECT_EQ(e.found[0].what.name(), hidden::name(truth.effect));
  EXPECT_EQ(e.found[0].what.joint, truth.joint);
}

// The effects that a sentence of advice asks to separate, or the one that it asks to excite.
std::vector<std::string> advised(const Explanation& e) {
  for (const std::string& advice : e.advice) {
    if (!advice.starts_with("to tell ")) continue;
    const auto option = advice.find(" --", advice.find("--robot"));
    const auto begin = advice.find(' ', option + 1) + 1;
    std::istringstream list(advice.substr(begin, advice.find(' ', begin) - begin));
    std::vector<std::string> effects;
    for (std::string one; std::getline(list, one, ',');) effects.push_back(one);
    return effects;
  }
  return {};
}

// The motion of the advice: for the effects that it names, or for all where it names none.
DesignRequest advised_design(const Explanation& e, const RobotDescription& robot) {
  DesignRequest design;
  for (const std::string& text : advised(e)) {
    design.effects.push_back(contender_of(text, robot, "--separate"));
  }
  return design;
}

struct Poorly {
  hidden::HiddenEffect effect;
  Verdict first;  // what one slow sine of either joint tells of it
};

class PoorMotion : public ::testing::TestWithParam<Poorly> {};

TEST_P(PoorMotion, BecomesFoundOnTheMotionThatTheAdviceNames) {
  hidden::Request request;
  request.seed = 11;
  request.effects = {GetParam().effect};
  const hidden::DrawnRobot drawn = hidden::draw_robot(request);
  const RobotDescription robot = to_robot(drawn.nominal);
  const Explanation first =
      explain_quickly(robot, record_sines(request, drawn.nominal, 20, {{0.2, 0.15}}));
  ASSERT_EQ(first.verdict, GetParam().first) << first.words;
  EXPECT_THAT(first.advice, Contains(HasSubstr("offnominal motion --robot ROBOT ")));
  EXPECT_EQ(advised(first).empty(), first.verdict == Verdict::kNotExcited);
  expect_found(explain_designed(request, robot, advised_design(first, robot)),
               drawn.truth.effects[0]);
}

constexpr std::array kPoorly{Poorly{hidden::HiddenEffect::kStribeckFriction, Verdict::kNotExcited}};

INSTANTIATE_TEST_SUITE_P(Effects, PoorMotion, ::testing::ValuesIn(kPoorly),
                         [](const auto& one) { return std::string(name(one.param.effect)); });

TEST(Ambiguous, BecomesFoundOnTheMotionThatTheAdviceNames) {
  constexpr int kWanted = 1;  // of 24 robots one or two are left in a class
  int seen = 0;
  constexpr std::array kEffects{hidden::HiddenEffect::kViscousFriction,
                                hidden::HiddenEffect::kLoadDependentFriction,
                                hidden::HiddenEffect::kJointStiffness};
  for (std::size_t i = 0; i < 8 * kEffects.size() && seen < kWanted; ++i) {
    hidden::Request request;
    request.seed = 1 + i / kEffects.size();
    request.effects = {kEffects.at(i % kEffects.size())};
    const hidden::DrawnRobot drawn = hidden::draw_robot(request);
    const RobotDescription robot = to_robot(drawn.nominal);
    const Explanation first =
        explain_quickly(robot, record_sines(request, drawn.nominal, 8, {{0.6, 0.2}}));
    if (first.verdict != Verdict::kAmbiguous) continue;
    ++seen;
    SCOPED_TRACE(std::string(hidden::name(request.effects[0])) + ": " + first.words);
    ASSERT_EQ(advised(first).size(), first.ambiguous[0].size());
    const Explanation second = explain_designed(request, robot, advised_design(first, robot));
    EXPECT_NE(second.verdict, Verdict::kAmbiguous);
    expect_found(second, drawn.truth.effects[0]);
  }
  EXPECT_EQ(seen, kWanted) << "no first motion was ambiguous: the test shows nothing";
}

}  // namespace
}  // namespace offnominal::desk::motion
