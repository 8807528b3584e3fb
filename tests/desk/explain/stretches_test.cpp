#include "identify/stretches.hpp"

#include <gtest/gtest.h>

#include "desk/compare/recorded_arm.hpp"

namespace offnominal::desk {
namespace {

using Eigen::Index;

Log long_recording(double duration_s, int joints) {
  constexpr double kRateHz = 100;
  const auto samples = static_cast<Index>(duration_s * kRateHz);
  Log log;
  log.period_s = 1 / kRateHz;
  log.t_s = Eigen::VectorXd::LinSpaced(samples, 0, static_cast<double>(samples - 1) / kRateHz);
  log.q.resize(samples, joints);
  for (int joint = 0; joint < joints; ++joint) log.q.col(joint) = log.t_s.array() + joint;
  log.dq = log.q;
  log.tau = -log.q;
  log.dq_derived.assign(static_cast<std::size_t>(joints), false);
  return log;
}

RobotDescription jointed(int joints) {
  RobotDescription robot;
  robot.joints.resize(static_cast<std::size_t>(joints));
  return robot;
}

FilterPlan search_plan() {
  FilterPlan plan;
  plan.sample_rate_hz = 100;
  plan.decimation = 3;
  return plan;
}

TEST(Stretches, GIVEN_what_a_search_can_bear_THEN_all_of_it_is_searched) {
  const std::vector<Log> logs{long_recording(300, 2), long_recording(100, 2)};
  const std::vector<Stretch> stretches = stretches_of(logs, jointed(2), search_plan());
  ASSERT_EQ(stretches.size(), 2U);
  EXPECT_TRUE(stretches[0].is_whole());
  EXPECT_TRUE(stretches[1].is_whole());
  EXPECT_EQ(stretches[1].margin, 0);
}

TEST(Stretches,
     GIVEN_a_long_recording_THEN_even_parts_of_it_are_searched_and_no_more_than_is_borne) {
  const std::vector<Log> logs{long_recording(1000, 7)};
  const std::vector<Stretch> stretches = stretches_of(logs, jointed(7), search_plan());
  ASSERT_GE(stretches.size(), 3U);
  Index last_end = 0;
  Index rows = 0;
  for (const Stretch& one : stretches) {
    EXPECT_GE(one.first, last_end) << "stretches must not overlap";
    last_end = one.first + one.samples;
    rows += 7 * (one.samples - 2 * one.margin) / search_plan().decimation;
  }
  EXPECT_LE(last_end, logs[0].sample_count());
  EXPECT_GT(last_end, logs[0].sample_count() * 3 / 4) << "the end is looked at too";
  EXPECT_LT(rows, 40'000);
  EXPECT_GT(rows, 20'000);
}

TEST(Stretches, GIVEN_a_stretch_THEN_its_cut_is_those_samples) {
  const std::vector<Log> logs{long_recording(1000, 7)};
  const Stretch one = stretches_of(logs, jointed(7), search_plan())[1];
  const Log cut = one.cut();
  ASSERT_EQ(cut.sample_count(), one.samples);
  EXPECT_EQ(cut.t_s[0], logs[0].t_s[one.first]);
  EXPECT_EQ(cut.q(5, 6), logs[0].q(one.first + 5, 6));
  EXPECT_EQ(cut.tau(one.samples - 1, 0), logs[0].tau(one.first + one.samples - 1, 0));
  EXPECT_EQ(cut.joint_count(), 7);
}

TEST(Stretches, GIVEN_another_rate_THEN_a_recording_has_the_edges_of_its_own_filter) {
  const std::vector<Log> logs{test::record_arm({.rate_hz = 250}), test::record_arm({})};
  const RobotDescription robot = test::arm_description();
  const FilterPlan plan = plan_filter(logs, robot);
  const Eigen::VectorXd widths = Eigen::VectorXd::Constant(2, 0.01);
  const auto searched = searched_workspaces(stretches_of(logs, robot, plan), robot, plan, widths);
  const auto made = make_workspaces(logs, robot, plan, widths);
  ASSERT_EQ(searched.size(), 2U);
  EXPECT_EQ(searched[1].plan.edge_samples, made[1].plan.edge_samples);
}

TEST(Stretches, GIVEN_an_effect_in_time_in_the_robot_file_THEN_nothing_is_cut) {
  RobotDescription robot = jointed(7);
  RobotEffect effect;
  effect.kind = EffectKind::kPeriodicDisturbance;
  robot.effects.push_back(effect);
  const std::vector<Log> logs{long_recording(1000, 7)};
  const std::vector<Stretch> stretches = stretches_of(logs, robot, search_plan());
  ASSERT_EQ(stretches.size(), 1U);
  EXPECT_TRUE(stretches[0].is_whole());
}

}  // namespace
}  // namespace offnominal::desk
