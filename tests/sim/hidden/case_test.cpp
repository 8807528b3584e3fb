#include "offnominal/sim/hidden/case.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <numbers>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>

#include "offnominal/sim/hidden/data_fault.hpp"
#include "offnominal/sim/hidden/draw_robot.hpp"
#include "support/places.hpp"
#include "unexplained.hpp"

namespace offnominal::sim::hidden {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

Request short_request(std::uint64_t seed, std::vector<HiddenEffect> effects = {}) {
  Request request{seed, std::move(effects)};
  request.duration_s = 2.0;
  return request;
}

// Two seconds of a motion that never rests.
Recording recorded(const Request& request, std::uint64_t run = 0) {
  const Eigen::VectorXd t_s = Eigen::VectorXd::LinSpaced(41, 0.0, 2.0);
  MatrixXd q(41, 2);
  q.col(0) = -1.5 + 0.6 * (2.0 * t_s.array()).sin();
  q.col(1) = 0.2 + 0.3 * t_s.array() * t_s.array();
  return record_motion(request, t_s, q, run);
}

TEST(HiddenCase, SameRequestGivesTheSameBytes) {
  const Request request =
      short_request(11, {HiddenEffect::kHysteresis, HiddenEffect::kCoggingTorque});
  const Case a = make_case(request), b = make_case(request);
  EXPECT_EQ(a.recording.q, b.recording.q);
  EXPECT_EQ(a.recording.tau, b.recording.tau);
  EXPECT_EQ(a.holdout.tau, b.holdout.tau);
  EXPECT_EQ(a.truth.effects[0].parameters[0].value, b.truth.effects[0].parameters[0].value);
}

TEST(HiddenCase, OtherSeedIsAnotherCase) {
  const Case a = make_case(short_request(11)), b = make_case(short_request(12));
  EXPECT_NE(a.nominal.links[0].mass_kg, b.nominal.links[0].mass_kg);
  EXPECT_GT((a.recording.q - b.recording.q).norm(), 1.0);
}

TEST(HiddenCase, HidingSomethingLeavesArmAndMotion) {
  const Case bare = make_case(short_request(11));
  const Case other = make_case(short_request(11, {HiddenEffect::kCoggingTorque}));
  EXPECT_EQ(bare.nominal.links[1].inertia_kg_m2, other.nominal.links[1].inertia_kg_m2);
  EXPECT_EQ(bare.nominal.joints[0].torque_limit_nm, other.nominal.joints[0].torque_limit_nm);
  EXPECT_LT((bare.recording.q - other.recording.q).cwiseAbs().maxCoeff(), 0.05);
  EXPECT_NE(bare.recording.tau, other.recording.tau);
}

TEST(HiddenCase, EveryEffectIsNamedWithItsParametersAndUnits) {
  std::set<std::string> names;
  for (const HiddenEffect effect : all_hidden_effects()) {
    const DrawnRobot drawn = draw_robot(short_request(2, {effect}));
    ASSERT_EQ(drawn.truth.effects.size(), 1U);
    const TrueEffect& hidden = drawn.truth.effects[0];
    EXPECT_EQ(hidden.effect, effect);
    ASSERT_FALSE(hidden.parameters.empty());
    for (const TrueParameter& p : hidden.parameters) EXPECT_TRUE(std::isfinite(p.value));
    names.insert(std::string(name(effect)));
  }
  EXPECT_EQ(names.size(), hidden_effect_table().size());
  EXPECT_EQ(names.count(""), 0U);
}

template <typename Row>
std::string document_row(const Row& row) {
  std::ostringstream sizes;
  for (const DrawnNumber& drawn : row.drawn) {
    if (sizes.tellp() > 0) sizes << ", ";
    sizes << drawn.of << ' ' << drawn.low << " to " << drawn.high;
    if (!drawn.unit.empty()) sizes << ' ' << drawn.unit;
  }
  if (!row.note.empty()) sizes << ", " << row.note;
  return "| `" + std::string(row.name) + "` | " + sizes.str() + " |\n";
}

TEST(HiddenCase, TheBenchmarksPageHasTheSizesOfTheTables) {
  std::string rows = "| effect | drawn |\n|---|---|\n";
  for (const HiddenEffectRow& row : hidden_effect_table()) rows += document_row(row);
  for (const OutsideEffectRow& row : outside_effect_table()) {
    if (row.effect != OutsideEffect::kNone) rows += document_row(row);
  }
  std::ifstream file(offnominal::test::source_dir() / "docs" / "discovery-benchmark.md");
  const std::string page{std::istreambuf_iterator<char>(file), {}};
  EXPECT_NE(page.find("\n" + rows + "\n"), std::string::npos) << "the page needs\n" << rows;
}

TEST(HiddenCase, TheTablesAreInTheOrderOfTheirEnumerations) {
  for (const HiddenEffectRow& row : hidden_effect_table()) {
    EXPECT_EQ(&row_of(row.effect), &row) << row.name;
  }
  for (const OutsideEffectRow& row : outside_effect_table()) {
    EXPECT_EQ(&row_of(row.effect), &row) << row.name;
  }
}

TEST(HiddenCase, TruthKeepsTheOrderOfTheRequest) {
  const DrawnRobot drawn =
      draw_robot(short_request(2, {HiddenEffect::kBacklash, HiddenEffect::kCoulombFriction}));
  EXPECT_EQ(drawn.truth.effects[0].effect, HiddenEffect::kBacklash);
  EXPECT_EQ(drawn.truth.effects[1].effect, HiddenEffect::kCoulombFriction);
}

TEST(HiddenCase, HiddenFrictionIsNotInTheNominalModel) {
  const Case coulomb = make_case(short_request(4, {HiddenEffect::kCoulombFriction}));
  const auto joint = static_cast<std::size_t>(coulomb.truth.effects[0].joint);
  EXPECT_EQ(coulomb.nominal.joints[joint].coulomb_nm, 0.0);
  EXPECT_GT(coulomb.nominal.joints[joint].viscous_nm_s_rad, 0.0);
  EXPECT_GT(coulomb.nominal.joints[1 - joint].coulomb_nm, 0.0);
}

TEST(HiddenCase, BothJointsAreChosen) {
  int second = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    second +=
        draw_robot(short_request(seed, {HiddenEffect::kJointStiffness})).truth.effects[0].joint;
  }
  EXPECT_GT(second, 8);
  EXPECT_LT(second, 32);
}

TEST(HiddenCase, NoiseHasTheRequestedSize) {
  Request request = short_request(6);
  request.torque_noise_share = 0.0;
  const Case clean = make_case(request);
  request.torque_noise_share = 0.01;
  const Case noisy = make_case(request);
  for (Index j = 0; j < 2; ++j) {
    const double limit = clean.nominal.joints[static_cast<std::size_t>(j)].torque_limit_nm;
    const double deviation = test::rms(noisy.recording.tau.col(j) - clean.recording.tau.col(j));
    EXPECT_NEAR(deviation / limit, 0.01, 0.001);
  }
  EXPECT_EQ(noisy.recording.q, clean.recording.q);
}

TEST(HiddenCase, GivenMotionIsDrivenByTheSameRobot) {
  const Request request = short_request(9, {HiddenEffect::kTorqueOffset});
  const Recording a = recorded(request), b = recorded(request);
  EXPECT_EQ(a.tau, b.tau);
  ASSERT_EQ(a.t_s.size(), 2000);
  EXPECT_NEAR(a.t_s[1], 0.001, 1e-15);
  EXPECT_NEAR(a.q(0, 0), -1.5, 0.01);
  EXPECT_NEAR(a.q(1999, 1), 1.4, 0.02);
  EXPECT_NE(recorded(request, 1).tau, a.tau);  // another repetition, other noise
}

TEST(HiddenCase, HoldoutIsAnotherMotionOfFifteenSeconds) {
  const Case made = make_case(short_request(9));
  ASSERT_EQ(made.holdout.t_s.size(), 15000);
  EXPECT_GT((made.holdout.q.topRows(2000) - made.recording.q).norm(), 1.0);
}

TEST(HiddenCase, RefusesRequestsThatAreNone) {
  Request request = short_request(1);
  request.encoder_bits = 0;
  EXPECT_THROW(make_case(request), std::invalid_argument);
  request = short_request(1);
  request.duration_s = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(make_case(request), std::invalid_argument);
  request = short_request(1, {HiddenEffect::kBacklash, HiddenEffect::kBacklash});
  EXPECT_THROW(make_case(request), std::invalid_argument);
}

// The same robot with a faulty and with a sound log.
struct Logs {
  Recording sound, faulty;
  std::vector<TrueParameter> parameters;
};

Logs logs_with(DataFault fault, std::uint64_t seed) {
  Request request = short_request(seed);
  request.torque_noise_share = 0.0;
  Logs logs;
  logs.sound = recorded(request);
  request.fault = fault;
  logs.faulty = recorded(request);
  logs.parameters = parameters(draw_log_fault(fault, Draws(seed, Stream::kDataFault)));
  return logs;
}

TEST(HiddenDataFault, DegreesAreDegrees) {
  const Logs logs = logs_with(DataFault::kDegrees, 1);
  EXPECT_EQ(logs.faulty.tau, logs.sound.tau);
  EXPECT_LT((logs.faulty.q - 180.0 / std::numbers::pi * logs.sound.q).norm(), 1e-9);
}

TEST(HiddenDataFault, SwappedSignsAreThoseOfTheTruth) {
  std::set<std::string> kinds;
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    const Logs logs = logs_with(DataFault::kSwappedTorqueSign, seed);
    EXPECT_EQ(logs.faulty.q, logs.sound.q);
    std::string kind;
    for (Index j = 0; j < 2; ++j) {
      const double sign = logs.parameters[static_cast<std::size_t>(j)].value;
      EXPECT_EQ(logs.faulty.tau.col(j), sign * logs.sound.tau.col(j));
      kind += sign < 0.0 ? '-' : '+';
    }
    kinds.insert(kind);
  }
  EXPECT_EQ(kinds, (std::set<std::string>{"+-", "-+", "--"}));
}

TEST(HiddenDataFault, StaleRowsRepeatTheRowBefore) {
  const Logs logs = logs_with(DataFault::kStaleSamples, 3);
  Index stale = 0;
  for (Index k = 1; k < logs.faulty.t_s.size(); ++k) {
    const bool changed = logs.faulty.q.row(k) != logs.sound.q.row(k) ||
                         logs.faulty.tau.row(k) != logs.sound.tau.row(k);
    if (!changed) continue;
    ++stale;
    const bool repeats = logs.faulty.q.row(k) == logs.faulty.q.row(k - 1) ||
                         logs.faulty.tau.row(k) == logs.faulty.tau.row(k - 1);
    EXPECT_TRUE(repeats) << k;
  }
  const double share = static_cast<double>(stale) / static_cast<double>(logs.faulty.t_s.size());
  EXPECT_GT(share, 0.01);
  EXPECT_LT(share, 0.055);
}

TEST(HiddenDataFault, SkewedTorquesAreLateOrOnAnotherClock) {
  int late = 0;
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    const Logs logs = logs_with(DataFault::kClockSkew, seed);
    EXPECT_EQ(logs.faulty.q, logs.sound.q);
    const double skew_s = logs.parameters[0].value, rate = logs.parameters[1].value;
    EXPECT_TRUE((skew_s == 0.0) != (rate == 1.0));
    late += skew_s > 0.0 ? 1 : 0;
    const double row = (1.5 - skew_s) * rate * 1000.0;
    const auto before = static_cast<Index>(row);
    for (Index j = 0; j < 2; ++j) {
      const double low = std::min(logs.sound.tau(before, j), logs.sound.tau(before + 1, j));
      const double high = std::max(logs.sound.tau(before, j), logs.sound.tau(before + 1, j));
      EXPECT_GE(logs.faulty.tau(1500, j), low - 1e-9);
      EXPECT_LE(logs.faulty.tau(1500, j), high + 1e-9);
    }
  }
  EXPECT_GT(late, 0);
  EXPECT_LT(late, 8);
}

TEST(HiddenDataFault, EveryLogOfTheRobotHasItAndTheTruthSaysSo) {
  Request request = short_request(5);
  const Case sound = make_case(request);
  request.fault = DataFault::kSwappedTorqueSign;
  const Case made = make_case(request);
  EXPECT_EQ(made.truth.fault, DataFault::kSwappedTorqueSign);
  for (Index j = 0; j < 2; ++j) {
    const double sign = made.truth.fault_parameters[static_cast<std::size_t>(j)].value;
    EXPECT_EQ(made.recording.tau.col(j), sign * sound.recording.tau.col(j));
    EXPECT_EQ(made.holdout.tau.col(j), sign * sound.holdout.tau.col(j));
  }
}

}  // namespace
}  // namespace offnominal::sim::hidden
