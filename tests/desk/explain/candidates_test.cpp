#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>

#include "compare/inverse_model.hpp"
#include "hidden_case.hpp"
#include "identify/data.hpp"
#include "identify/effect_candidate.hpp"

namespace offnominal::desk {
namespace {

using Eigen::Index;

std::vector<Workspace> some_recording() {
  sim::hidden::Request request;
  request.seed = 5;
  request.duration_s = 12;
  const sim::hidden::Case made = sim::hidden::make_case(request);
  const RobotDescription robot = test::to_robot(made.nominal);
  const Log log = test::to_log(made.recording);
  const FilterPlan plan = plan_filter({log}, robot);
  std::vector<Workspace> recordings;
  recordings.push_back(make_workspace(log, robot, plan, Eigen::VectorXd::Zero(2)));
  return recordings;
}

TEST(Candidates, AreAllEffectsThatCoreDescribesEachOnce) {
  std::set<EffectKind> kinds;
  for (const auto& effect : all_candidates()) {
    EXPECT_TRUE(kinds.insert(effect->kind()).second) << effect->name();
    EXPECT_EQ(&effect->info(), info_of(effect->kind())) << effect->name();
  }
  EXPECT_EQ(kinds.size(), kAllEffectInfos.size() + kInfosOutsideChains.size());
}

// What a search finds goes into a robot file by the struct's own parameters: an effect with the
// values that a file has must come back from the coefficients and the shape that mean it.
TEST(Candidates, GiveTheEffectThatTheirRegressorsAreOf) {
  const std::vector<Workspace> at = some_recording();
  int compared = 0;
  for (const auto& candidate : all_candidates()) {
    for (Index joint = 0; joint < 2; ++joint) {
      const bool is_torque = candidate->info().action == EffectAction::kTorque ||
                             candidate->info().action == EffectAction::kTorqueOfState;
      if (!is_torque || !candidate->applies(at[0], joint)) continue;
      ShapePoint shape;
      for (const ShapeRange& range : candidate->shapes(at, joint)) {
        shape.push_back(range.grid[range.grid.size() / 2]);
      }
      const auto columns = candidate->regressors(at[0], joint, shape);
      Eigen::VectorXd coefficients(static_cast<Index>(columns.size()));
      Eigen::VectorXd sum = Eigen::VectorXd::Zero(at[0].sample_count());
      for (Index i = 0; i < coefficients.size(); ++i) {
        coefficients[i] = 0.4 + 0.3 * static_cast<double>(i);
        sum += coefficients[i] * columns[static_cast<std::size_t>(i)][0].values;
      }
      const Effect<double> effect = candidate->effect(joint, coefficients, shape, at[0].sign_width);
      EXPECT_TRUE(parameters_valid(effect)) << candidate->name();
      const Eigen::VectorXd torque =
          torque_of_effect(effect, JointType::kRevolute, at[0].motion, at[0].start_s);
      EXPECT_LT((torque - sum).norm(), 1e-9 * (1 + sum.norm())) << candidate->name();
      ++compared;
    }
  }
  EXPECT_EQ(compared, 26);
}

// In one direction a difference between the two is any constant and any slope.
TEST(Candidates, OfBothDirectionsDoNotApplyWhereAJointTurnsOneWay) {
  const Candidate asymmetry = candidate_of(EffectKind::kFrictionAsymmetry);
  std::vector<Workspace> at = some_recording();
  EXPECT_TRUE(asymmetry->applies_in_any(at, 0));
  at[0].motion.dq.col(0) = at[0].motion.dq.col(0).cwiseAbs();
  EXPECT_FALSE(asymmetry->applies_in_any(at, 0));
  EXPECT_TRUE(asymmetry->applies_in_any(at, 1));
  // A second recording in which it all but stands says nothing of directions.
  at.push_back(at[0]);
  at[1].motion.dq.col(0) = 1e-3 * some_recording()[0].motion.dq.col(0);
  at[1].top_speed[0] *= 1e-3;
  EXPECT_FALSE(asymmetry->applies_in_any(at, 0));
}

TEST(Candidates, HaveARegressorPerLinearParameterAtEveryPointOfTheirGrids) {
  const std::vector<Workspace> at = some_recording();
  for (const auto& effect : all_candidates()) {
    for (Index joint = 0; joint < 2; ++joint) {
      if (!effect->applies(at[0], joint)) continue;
      ShapePoint ends;
      for (const ShapeRange& range : effect->shapes(at, joint)) {
        ASSERT_FALSE(range.grid.empty()) << effect->name();
        ends.push_back(range.grid.back());
      }
      const auto columns = effect->regressors(at[0], joint, ends);
      const Eigen::VectorXd coefficients =
          Eigen::VectorXd::Ones(static_cast<Index>(columns.size()));
      const auto named = effect->parameters(JointType::kRevolute, coefficients, ends);
      EXPECT_GE(named.size(), columns.size()) << effect->name();
      for (const Regressor& column : columns) {
        ASSERT_FALSE(column.empty()) << effect->name();
        for (const JointTorque& torque : column) {
          EXPECT_EQ(torque.values.size(), at[0].sample_count()) << effect->name();
          EXPECT_TRUE(torque.values.allFinite()) << effect->name();
        }
      }
    }
  }
}

// A grid in even steps of the logarithm has to be refined in the logarithm, an even one as it is.
TEST(Candidates, SayHowTheirGridsAreSpaced) {
  const std::vector<Workspace> at = some_recording();
  int logarithmic = 0;
  for (const auto& effect : all_candidates()) {
    for (const ShapeRange& range : effect->shapes(at, 0)) {
      if (range.grid.size() < 3 || range.kind == ShapeRange::Kind::kDiscrete) continue;
      const double ratio = range.grid[1] / range.grid[0];
      const bool even_ratio = std::abs(range.grid[2] / range.grid[1] - ratio) < 1e-9 * ratio;
      EXPECT_EQ(range.kind == ShapeRange::Kind::kLogarithmic, even_ratio)
          << effect->name() << " " << range.name;
      logarithmic += even_ratio ? 1 : 0;
    }
  }
  EXPECT_GE(logarithmic, 5);
}

}  // namespace
}  // namespace offnominal::desk
