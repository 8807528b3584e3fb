// A transmission that gives way, and links that are off the file, bend a joint's torque alike.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <offnominal/sim/hidden/case.hpp>
#include <utility>

#include "explain/beside_free_links.hpp"
#include "explain/friction_family.hpp"
#include "hidden_case.hpp"
#include "identify/workspace.hpp"

namespace offnominal::desk {
namespace {

using sim::hidden::HiddenEffect;

// What keeps its name of an elasticity that somebody named on the joint.
std::size_t named_after(const sim::hidden::Case& made, const RobotDescription& robot,
                        Eigen::Index joint) {
  const std::vector<Log> logs{test::to_log(made.recording)};
  const FilterPlan plan = plan_filter(logs, robot);
  const auto widths = Eigen::VectorXd::Zero(robot.joint_count());
  const NuisanceOptions nuisance;
  const SearchSetting setting = setting_of(
      nuisance, std::make_unique<Data>(make_workspaces(logs, robot, plan, widths), robot, nuisance),
      nullptr, {.bootstrap_draws = 99, .seed = 1, .threads = 1});
  FoundModel found;
  found.baseline = setting.regression->fit({});
  found.unsure.assign(2, 0);
  found.held_out_before = setting.hold_out->residual({}, found.baseline);
  found.accepted.push_back({first_on_grid(*setting.data, EffectKind::kJointElasticity, joint)});
  order_and_hold_out(*setting.regression, *setting.hold_out, 1, found);
  const RowLayout& layout = setting.data->layout;
  EXPECT_GT(best_fall(layout.rms(found.baseline.residual), layout.rms(found.fit.residual)).share,
            kRelevantShare)
      << "it must look like something";
  leave_out_links_in_disguise(setting, robot, 1, found);
  EXPECT_EQ(found.unsure[static_cast<std::size_t>(joint)], found.accepted.empty() ? 1 : 0);
  return found.accepted.size();
}

TEST(LinksInDisguise, LoseTheNameThatAnElasticityKeeps) {
  const sim::hidden::Case elastic = test::case_of(5, {HiddenEffect::kJointElasticity});
  EXPECT_EQ(named_after(elastic, test::to_robot(elastic.nominal), elastic.truth.effects[0].joint),
            1U);
  const sim::hidden::Case stiff = test::case_of(5, {});
  RobotDescription robot = test::to_robot(stiff.nominal);
  for (RobotJoint& joint : robot.joints) {
    for (double& inertia : joint.joint.inertia_kg_m2) inertia *= 0.4;
  }
  for (Eigen::Index joint = 0; joint < 2; ++joint) {
    EXPECT_EQ(named_after(stiff, robot, joint), 0U) << "joint " << joint + 1;
  }
}

}  // namespace
}  // namespace offnominal::desk
