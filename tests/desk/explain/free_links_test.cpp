// A transmission that gives way, and links that are off the file, bend a joint's torque alike.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <offnominal/sim/hidden/case.hpp>
#include <utility>
#include <vector>

#include "explain/beside_free_links.hpp"
#include "explain/friction_family.hpp"
#include "explain/link_share.hpp"
#include "explain/undecided.hpp"
#include "hidden_case.hpp"
#include "identify/workspace.hpp"
#include "serial_arm.hpp"

namespace offnominal::desk {
namespace {

using sim::hidden::HiddenEffect;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

SearchSetting setting_for(const Log& log, const RobotDescription& robot,
                          const NuisanceOptions& nuisance) {
  const std::vector<Log> logs{log};
  const FilterPlan plan = plan_filter(logs, robot);
  const auto widths = Eigen::VectorXd::Zero(robot.joint_count());
  return setting_of(
      nuisance, std::make_unique<Data>(make_workspaces(logs, robot, plan, widths), robot, nuisance),
      nullptr, {.bootstrap_draws = 499, .seed = 1, .threads = 1});
}

// As if the search had found these.
FoundModel found_with(const SearchSetting& setting, const std::vector<Term>& terms) {
  FoundModel found;
  found.baseline = setting.regression->fit({});
  found.unsure.assign(static_cast<std::size_t>(setting.data->layout.joint_count()), 0);
  found.held_out_before = setting.hold_out->residual({}, found.baseline);
  for (const Term& term : terms) found.accepted.push_back({term});
  order_and_hold_out(*setting.regression, *setting.hold_out, 1, found);
  const RowLayout& layout = setting.data->layout;
  EXPECT_GT(best_fall(layout.rms(found.baseline.residual), layout.rms(found.fit.residual)).share,
            kRelevantShare)
      << "it must look like something";
  return found;
}

// What keeps its name of an elasticity that somebody named on the joint.
std::size_t named_after(const sim::hidden::Case& made, const RobotDescription& robot,
                        Eigen::Index joint) {
  const SearchSetting setting = setting_for(test::to_log(made.recording), robot, {});
  FoundModel found =
      found_with(setting, {first_on_grid(*setting.data, EffectKind::kJointElasticity, joint)});
  leave_out_links_in_disguise(setting, robot, 1, found);
  EXPECT_EQ(found.unsure[static_cast<std::size_t>(joint)], found.accepted.empty() ? 1 : 0);
  return found.accepted.size();
}

// Of a payload that the search names on the last link, beside links that may be off by `share`.
std::vector<EffectAt> links_for_a_payload(const RobotDescription& real,
                                          const RobotDescription& file, double share) {
  const Log log = test::record(real, {.duration_s = 15, .seed = 4});
  const SearchSetting setting = setting_for(log, file, with_link_share({}, share));
  std::vector<Term> terms;
  add_payload(*setting.regression, terms);
  return could_be_links(setting, file, found_with(setting, terms));
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

// A payload of its own weight is more than a link of 12 % makes up, whatever else is off.
TEST(CouldBeLinks, IsAskedOfAPayloadBesideLinksThatAreOffFurther) {
  constexpr std::size_t kJointsOfArm = 5;
  constexpr double kPoorCad = 0.12;
  const auto last = static_cast<Eigen::Index>(kJointsOfArm) - 1;
  const RobotDescription file = test::serial_arm(kJointsOfArm);
  RobotDescription loaded = file;
  loaded.effects.push_back(
      test::effect_of(EffectKind::kTipPayload, last, {1.6, 0.03, -0.09, 0.11}));
  EXPECT_THAT(links_for_a_payload(loaded, file, kPoorCad), IsEmpty());
  RobotDescription heavier = file;
  heavier.joints[kJointsOfArm - 1].joint.mass_kg *= 1.3;
  heavier.joints[kJointsOfArm - 1].joint.centre_of_mass_m[1] *= 1.4;
  heavier.joints[kJointsOfArm - 2].joint.mass_kg *= 1.25;
  EXPECT_THAT(links_for_a_payload(heavier, file, kPoorCad),
              ElementsAre(EffectAt{EffectKind::kTipPayload, last}));
}

// GIVEN a joint on which a spring shows WHEN the numbers that are written leave no more than noise
// there THEN links that are off had only looked like it, and nothing is asked of it.
TEST(Undecided, IsNothingThatTheWrittenNumbersLeave) {
  constexpr Eigen::Index kJoint = 2;
  const RobotDescription file = test::serial_arm(3);
  RobotDescription real = file;
  real.effects.push_back(
      test::effect_of(EffectKind::kJointStiffness, static_cast<int>(kJoint), {4.0, 0.5}));
  const SearchSetting setting = setting_for(test::record(real, {.duration_s = 15}), file, {});
  FoundModel found;
  found.baseline = setting.regression->fit({});
  found.fit = found.baseline;
  found.unsure.assign(3, 0);
  found.unsure[kJoint] = 1;
  const auto excitation = excitation_of(setting.data->recordings);
  Eigen::VectorXd left = setting.data->layout.rms(found.fit.residual);
  const auto asked = [&] { return undecided(setting, file, found, excitation, left); };
  ASSERT_THAT(asked(), SizeIs(1));
  left[kJoint] = 0.01;  // N m: the recording's noise is 0.02, filtered
  EXPECT_THAT(asked(), IsEmpty());
}

}  // namespace
}  // namespace offnominal::desk
