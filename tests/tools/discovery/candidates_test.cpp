#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>

#include "discovery/data.hpp"
#include "discovery/effect_candidate.hpp"
#include "hidden_case.hpp"

namespace offnominal::tools::discovery {
namespace {

using Eigen::Index;

std::vector<Workspace> some_recording() {
  sim::hidden::Request request;
  request.seed = 5;
  request.duration_s = 12;
  const sim::hidden::Case made = sim::hidden::make_case(request);
  const RobotDescription robot = test::to_robot(made.nominal);
  const Log log = test::to_log(made.recording);
  const FilterPlan plan = discovery_filter({log}, robot);
  std::vector<Workspace> recordings;
  recordings.push_back(make_workspace(log, robot, plan, Eigen::VectorXd::Zero(2)));
  return recordings;
}

TEST(Candidates, AreTheEffectsOfTheDesignEachOnce) {
  std::set<std::string> names;
  for (const auto& effect : all_candidates()) {
    EXPECT_TRUE(names.insert(effect->name()).second) << effect->name();
    EXPECT_FALSE(std::string(effect->formula()).empty()) << effect->name();
    EXPECT_FALSE(std::string(effect->motion_hint()).empty()) << effect->name();
  }
  EXPECT_EQ(names.size(), 20U);
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
      EXPECT_EQ(columns.size(), effect->linear_parameters(JointType::kRevolute).size());
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
}  // namespace offnominal::tools::discovery
