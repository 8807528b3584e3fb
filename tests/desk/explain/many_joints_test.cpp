// Recordings of arms of one to seven joints, down to the shortest that are taken: every joint adds
// numbers to the fit, and a short recording has fewer independent blocks of time than the whole arm
// has numbers. Run under the address sanitizer and, for its threads, under the thread sanitizer.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "common/parallel.hpp"
#include "compare/compare.hpp"
#include "compare/measurement.hpp"
#include "explain/add_found.hpp"
#include "explain/contradicted.hpp"
#include "explain/doctor.hpp"
#include "explain/explain.hpp"
#include "explain/explain_report.hpp"
#include "serial_arm.hpp"
#include "support/repetitions.hpp"

namespace offnominal::desk {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::UnorderedElementsAre;

ExplainOptions quick(int threads) {
  ExplainOptions options;
  options.bootstrap_draws = 499;
  options.replays = 0;
  options.threads = threads;
  return options;
}

// A spring that the file does not know, on the arm's last joint.
Explanation explained(std::size_t joints, double duration_s, int threads) {
  const RobotDescription robot = test::serial_arm(joints);
  RobotDescription real = robot;
  real.effects.push_back(
      test::effect_of(EffectKind::kJointStiffness, static_cast<int>(joints) - 1, {6, 0.1}, true));
  return explain(robot, {test::record(real, {.duration_s = duration_s})}, {}, quick(threads));
}

// Every number that is told has an interval, or says why it has none.
void expect_intervals_or_words(const Explanation& told) {
  for (const Finding& finding : told.found) {
    for (const Estimate& one : finding.parameters) {
      EXPECT_NE(one.ci95.has_value(), !one.why_no_interval.empty())
          << finding.what.name() << '.' << one.value.name;
    }
  }
}

class ManyJoints : public ::testing::TestWithParam<std::size_t> {};

TEST_P(ManyJoints, OfAShortRecordingHaveIntervalsOrWordsForWhyNot) {
  const Explanation told = explained(GetParam(), 9, 2);
  ASSERT_THAT(told.found, Not(IsEmpty())) << told.words;
  expect_intervals_or_words(told);
}

INSTANTIATE_TEST_SUITE_P(
    OneToSeven, ManyJoints,
    ::testing::ValuesIn(test::every_nth(std::vector<std::size_t>{6, 1, 2, 3, 4, 5, 7}, 6)),
    [](const auto& parameter) { return std::to_string(parameter.param); });

// What counts is how often the joint concerned has been seen, not how many joints there are.
TEST(ManyJoints, GIVEN_six_joints_and_blocks_enough_on_the_joint_THEN_its_numbers_have_intervals) {
  const Explanation told = explained(6, 9, 2);
  ASSERT_THAT(told.found, Not(IsEmpty())) << told.words;
  EXPECT_EQ(told.found[0].what, (EffectAt{EffectKind::kJointStiffness, 5}));
  const Estimate& stiffness = told.found[0].parameters.at(0);
  ASSERT_TRUE(stiffness.ci95) << stiffness.why_no_interval;
  EXPECT_LT((*stiffness.ci95)[0], 6);
  EXPECT_GT((*stiffness.ci95)[1], 6);
  EXPECT_LT((*stiffness.ci95)[1] - (*stiffness.ci95)[0], 3);
}

// Nine ripples of the file are eighteen numbers more on the joint.
TEST(ManyJoints, GIVEN_more_numbers_on_the_joint_than_blocks_THEN_it_says_so_in_words) {
  RobotDescription robot = test::serial_arm(3);
  for (int i = 0; i < 13; ++i) {
    robot.effects.push_back(
        test::effect_of(EffectKind::kCoggingTorque, 2, {0.1, 0.05, 7.0 + 3 * i}, true));
  }
  RobotDescription real = robot;
  real.effects.push_back(test::effect_of(EffectKind::kJointStiffness, 2, {6, 0.1}, true));
  const Explanation told = explain(robot, {test::record(real, {.duration_s = 8})}, {}, quick(2));
  ASSERT_THAT(told.found, Not(IsEmpty())) << told.words;
  const Estimate& stiffness = told.found[0].parameters.at(0);
  EXPECT_FALSE(stiffness.ci95);
  EXPECT_THAT(stiffness.why_no_interval,
              AllOf(HasSubstr("fitted numbers of joint 3"), HasSubstr("record for longer")));
  const ExplainNames names{{"log"}, {}, "robot", "explain"};
  EXPECT_THAT(text_of(told, names), HasSubstr(stiffness.why_no_interval));
  const nlohmann::ordered_json said =
      to_json(told, names).at("found").at(0).at("parameters").at(stiffness.value.name);
  EXPECT_TRUE(said.at("ci95").is_null());
  EXPECT_EQ(said.at("why_no_ci95"), stiffness.why_no_interval);
}

// Coulomb friction that pushes: the file's number is fitted again beside the spring.
TEST(ManyJoints, GIVEN_a_number_of_the_file_that_physics_forbids_THEN_all_found_is_not_written) {
  const RobotDescription robot = test::serial_arm(2);
  RobotDescription real = robot;
  real.effects.at(3).parameters[0] = -0.3;
  real.effects.push_back(test::effect_of(EffectKind::kJointStiffness, 1, {6, 0.1}, true));
  const AddedFindings added =
      add_found(robot, {test::record(real, {.duration_s = 20})}, {}, quick(2), {});
  EXPECT_EQ(added.explanation.improved.effects.at(3).parameters[0], 0);
  EXPECT_THAT(added.objections, Contains(AllOf(HasSubstr("level of joint 2 was held at 0"),
                                               HasSubstr("sign of the torque"))));
  EXPECT_FALSE(added.may_be_written(true));
}

// Coulomb friction that pushes is held at 0, and the viscous number is the one that fits beside it.
// A joint without known friction that gains energy: whatever explain finds in its place.
// Which of the family of friction comes closest to a torque that drives the joint says nothing.
TEST(ManyJoints, GIVEN_friction_that_gives_energy_THEN_it_gets_no_name) {
  RobotDescription robot = test::serial_arm(1);
  RobotDescription real = robot;
  robot.effects.clear();
  real.effects = {test::effect_of(EffectKind::kQuadraticFriction, 0, {-0.5}, true)};
  const AddedFindings added =
      add_found(robot, {test::record(real, {.duration_s = 20})}, {}, quick(2), {});
  EXPECT_FALSE(added.may_be_written(true)) << added.explanation.words;
  EXPECT_THAT(added.explanation.found, IsEmpty()) << added.explanation.words;
  EXPECT_THAT(added.explanation.words, HasSubstr("Something shows"));
}

TEST(ManyJoints, GIVEN_a_number_that_is_held_THEN_all_else_is_fitted_beside_it) {
  const RobotDescription robot = test::serial_arm(2);
  RobotDescription real = robot;
  real.effects.at(3).parameters[0] = -0.3;
  real.effects.push_back(test::effect_of(EffectKind::kJointStiffness, 1, {6, 0.1}, true));
  const Log log = test::record(real, {.duration_s = 20});
  const AddedFindings added = add_found(robot, {log}, {}, quick(2), {});
  const RobotDescription& improved = added.explanation.improved;
  ASSERT_EQ(improved.effects.at(3).parameters[0], 0);
  const Measurement measured = measure(log, robot);
  const auto error = [&](double of_viscous) {
    RobotDescription other = improved;
    other.effects.at(2).parameters[0] += of_viscous;
    return compare(other, measured).joints.at(1).rms_error;
  };
  const double step = 0.02 * std::abs(improved.effects.at(2).parameters[0]);
  EXPECT_LT(error(0), error(step));
  EXPECT_LT(error(0), error(-step));
}

// Viscous friction that is a guess near nothing and comes out a little below it is held there, and
// hides no wrong Coulomb friction beside it.
TEST(ManyJoints,
     GIVEN_a_guess_of_viscous_friction_near_nothing_THEN_wrong_coulomb_friction_is_told) {
  RobotDescription real = test::serial_arm(3);
  RobotDescription robot = real;
  real.effects.at(2).parameters[0] = -0.02;
  real.effects.at(3).parameters[0] = 2;
  robot.effects.at(2).parameters[0] = 0.01;
  robot.effects.at(3).parameters[0] = 0.1;
  const Explanation told = explain(robot, {test::record(real, {.duration_s = 20})}, {}, quick(2));
  ASSERT_THAT(told.shifts, ::testing::SizeIs(1)) << told.words;
  EXPECT_EQ(told.shifts[0].effect, 3U);
  EXPECT_NEAR(told.shifts[0].came, 2, 0.1);
  EXPECT_EQ(told.improved.effects.at(2).parameters[0], 0);
  EXPECT_NEAR(told.improved.effects.at(3).parameters[0], 2, 0.1);
}

// What is told of a number is what the new file has: a number that the last fit leaves where it was
// is not told.
TEST(ManyJoints, GIVEN_a_number_that_the_last_fit_leaves_THEN_it_is_no_shift) {
  const RobotDescription file = test::serial_arm(2);
  RobotDescription fitted = file;
  fitted.effects.at(1).parameters[0] = 1.0;
  fitted.effects.at(3).parameters[0] *= 1.0001;
  const auto shift = [&](std::size_t effect, double came) {
    Shift one;
    one.effect = effect;
    one.file = file.effects.at(effect).parameters[0];
    one.came = came;
    return one;
  };
  std::vector<Shift> shifts{shift(1, 1.1), shift(3, 1.0), shift(0, 0.2)};
  EXPECT_TRUE(leave_out_undone(fitted, shifts));
  ASSERT_THAT(shifts, ::testing::SizeIs(1));
  EXPECT_EQ(shifts[0].effect, 1U);
  EXPECT_FALSE(leave_out_undone(fitted, shifts));
}

// A description of somebody else's with friction that nobody measured: what the recordings say is
// told of each joint and written, though the file does not mark it fitted, and the error falls.
TEST(ManyJoints, GIVEN_friction_of_the_file_that_is_wrong_THEN_the_new_file_has_what_fits) {
  RobotDescription real = test::serial_arm(3);
  RobotDescription robot = real;
  for (RobotEffect& effect : robot.effects) {
    effect.fitted = false;
    effect.source = "a guess";
    effect.parameters[0] = effect.kind == EffectKind::kViscousFriction ? 10 : 0.1;
  }
  const Log log = test::record(real, {.duration_s = 20});
  const AddedFindings added = add_found(robot, {log}, {}, quick(2), {});
  const Explanation& told = added.explanation;
  EXPECT_THAT(told.found, IsEmpty()) << told.words;
  for (const JointAnswer& answer : told.answers) {
    EXPECT_EQ(answer.verdict, Verdict::kParameterShift) << answer.words;
    EXPECT_THAT(answer.words, HasSubstr("viscous_friction.coefficient")) << answer.words;
  }
  EXPECT_THAT(added.objections, IsEmpty());
  EXPECT_TRUE(added.may_be_written(false));
  for (std::size_t i = 0; i < real.effects.size(); ++i) {
    const RobotEffect& written = told.improved.effects.at(i);
    const double truth = real.effects[i].parameters[0];
    EXPECT_NEAR(written.parameters[0], truth, 0.1 * truth) << i;
    EXPECT_TRUE(written.fitted);
    EXPECT_THAT(written.source, HasSubstr("a guess; "));
  }
  for (const JointErrors& joint : told.joints) {
    EXPECT_LT(joint.rms_improved, 0.1 * joint.rms_before) << "joint " << joint.joint + 1;
  }
}

// Whoever knows his numbers keeps them: what is missing is looked for beside them.
TEST(ManyJoints, GIVEN_effects_to_keep_THEN_none_of_their_numbers_moves) {
  RobotDescription robot = test::serial_arm(2);
  RobotDescription real = robot;
  for (RobotEffect& effect : robot.effects) {
    effect.parameters[0] *= effect.kind == EffectKind::kViscousFriction ? 3 : 1;
  }
  real.effects.push_back(test::effect_of(EffectKind::kJointStiffness, 1, {6, 0.1}, true));
  ExplainOptions options = quick(2);
  const Log log = test::record(real, {.duration_s = 20});
  ASSERT_NE(add_found(robot, {log}, {}, options, {}).explanation.improved.effects.at(0).parameters,
            robot.effects.at(0).parameters);
  options.keep_effects = true;
  const Explanation told = add_found(robot, {log}, {}, options, {}).explanation;
  EXPECT_THAT(told.shifts, IsEmpty());
  for (std::size_t i = 0; i < robot.effects.size(); ++i) {
    EXPECT_EQ(told.improved.effects.at(i).parameters, robot.effects[i].parameters) << i;
    EXPECT_EQ(told.improved.effects.at(i).source, robot.effects[i].source) << i;
  }
}

// Less than nothing by a little is nothing: the number goes to the end of what is possible.
TEST(ManyJoints, GIVEN_no_friction_where_the_file_has_some_THEN_the_new_file_has_none) {
  RobotDescription robot = test::serial_arm(1);
  RobotDescription real = robot;
  real.effects.at(0).parameters[0] = -0.01;
  robot.effects.at(0).parameters[0] = 1;
  const AddedFindings added = add_found(
      robot, {test::record(real, {.duration_s = 20, .torque_noise_nm = 0.005})}, {}, quick(2), {});
  EXPECT_THAT(added.objections, IsEmpty());
  EXPECT_EQ(added.explanation.improved.effects.at(0).parameters[0], 0);
  EXPECT_EQ(added.explanation.verdict, Verdict::kParameterShift) << added.explanation.words;
}

// What a number comes out as hangs on the scale of the torque, which a class leaves open.
TEST(ManyJoints, GIVEN_a_torque_that_may_have_another_scale_THEN_no_number_of_that_joint_moves) {
  const RobotDescription robot = test::serial_arm(2);
  Log log = test::record(robot, {.duration_s = 20});
  log.tau *= 1.5;
  const Explanation told = explain(robot, {log}, {}, quick(2));
  for (const auto& same : told.ambiguous) {
    for (const EffectAt& what : same) {
      if (what.kind != EffectKind::kTorqueScale) continue;
      for (const Shift& shift : told.shifts) EXPECT_NE(shift.joint, what.joint) << told.words;
    }
  }
}

// Numbers of the file that are right are neither told nor touched.
TEST(ManyJoints, GIVEN_friction_of_the_file_that_is_right_THEN_it_stays) {
  RobotDescription robot = test::serial_arm(2);
  for (RobotEffect& effect : robot.effects) effect.fitted = false;
  RobotDescription real = robot;
  real.effects.push_back(test::effect_of(EffectKind::kJointStiffness, 1, {6, 0.1}, true));
  const AddedFindings added =
      add_found(robot, {test::record(real, {.duration_s = 20})}, {}, quick(2), {});
  EXPECT_THAT(added.explanation.shifts, IsEmpty());
  for (std::size_t i = 0; i < robot.effects.size(); ++i) {
    EXPECT_EQ(added.explanation.improved.effects.at(i).parameters, robot.effects[i].parameters);
    EXPECT_FALSE(added.explanation.improved.effects.at(i).fitted);
  }
}

// An owner's file without any friction, on an arm that has Coulomb and viscous friction everywhere:
// no joint waits for another, and nothing larger than the two is named.
TEST(ManyJoints, GIVEN_a_file_without_friction_THEN_every_joint_gets_both_and_nothing_else) {
  constexpr std::size_t kJoints = 6;
  const RobotDescription real = test::serial_arm(kJoints);
  RobotDescription robot = real;
  robot.effects.clear();
  const Explanation told = explain(robot, {test::record(real, {.duration_s = 30})},
                                   {test::record(real, {.duration_s = 12, .seed = 2})}, quick(2));
  ASSERT_EQ(told.answers.size(), kJoints);
  for (const JointAnswer& one : told.answers) {
    EXPECT_EQ(one.verdict, Verdict::kFound) << one.joint + 1 << ": " << one.words;
    EXPECT_THAT(one.found, UnorderedElementsAre(EffectAt{EffectKind::kCoulombFriction, one.joint},
                                                EffectAt{EffectKind::kViscousFriction, one.joint}))
        << one.joint + 1 << ": " << one.words;
  }
  EXPECT_EQ(told.found.size(), 2 * kJoints);
  EXPECT_THAT(told.advice, Contains(HasSubstr("no friction on joints 1, 2, 3, 4, 5, 6")));
  ASSERT_EQ(told.waterfall.size(), told.found.size() + 1);
  for (std::size_t i = 0; i < kJoints; ++i) {
    const auto joint = static_cast<Eigen::Index>(i);
    EXPECT_LT(told.waterfall.back()[joint], 0.2 * told.waterfall.front()[joint]);
  }
}

// The motion of another joint fits a joint's own friction about as well, and here exactly: it is
// the joint's own that every drive has.
TEST(ManyJoints, GIVEN_joints_that_move_in_step_THEN_friction_is_of_the_joint_itself) {
  RobotDescription robot = test::serial_arm(2);
  robot.effects.clear();
  RobotDescription real = robot;
  real.effects = {test::effect_of(EffectKind::kCoulombFriction, 0, {0.6, 0.01}, true),
                  test::effect_of(EffectKind::kViscousFriction, 0, {0.8}, true),
                  test::effect_of(EffectKind::kJointCoupling, 1, {-0.6, -0.5, 1, 0.01}, true)};
  const Explanation told =
      explain(robot, {test::record(real, {.duration_s = 25, .in_step = true})}, {}, quick(2));
  ASSERT_EQ(told.answers.size(), 2U);
  for (const JointAnswer& one : told.answers) {
    EXPECT_THAT(one.found, UnorderedElementsAre(EffectAt{EffectKind::kCoulombFriction, one.joint},
                                                EffectAt{EffectKind::kViscousFriction, one.joint}))
        << told.words;
  }
}

// The width of the sign that fits Coulomb friction alone is not the one beside viscous friction:
// left where it was it makes a Stribeck effect that is not there.
TEST(ManyJoints, GIVEN_coulomb_and_viscous_friction_THEN_no_larger_member_of_the_family_is_named) {
  const RobotDescription real = test::serial_arm(1);
  RobotDescription robot = real;
  robot.effects.clear();
  for (const std::uint64_t seed : test::every_nth(std::vector<std::uint64_t>{11, 12, 13, 14}, 4)) {
    const Explanation told = explain(
        robot, {test::record(real, {.duration_s = 30, .torque_noise_nm = 0.005, .seed = seed})}, {},
        quick(2));
    std::vector<EffectAt> names;
    for (const Finding& one : told.found) names.push_back(one.what);
    EXPECT_THAT(names, UnorderedElementsAre(EffectAt{EffectKind::kCoulombFriction, 0},
                                            EffectAt{EffectKind::kViscousFriction, 0}))
        << seed << ": " << told.words;
  }
}

// Links that may all be off would explain the same: the one that is off has the name.
TEST(ManyJoints, GIVEN_one_link_of_another_mass_THEN_it_is_named_and_written) {
  const RobotDescription robot = test::serial_arm(4);
  RobotDescription real = robot;
  real.joints[2].joint.mass_kg *= 0.7;
  const AddedFindings added =
      add_found(robot, {test::record(real, {.duration_s = 20})}, {}, quick(2), {});
  const Explanation& told = added.explanation;
  EXPECT_EQ(told.verdict, Verdict::kParameterShift) << told.words;
  ASSERT_THAT(told.found, Not(IsEmpty())) << told.words;
  EXPECT_EQ(told.found[0].what, (EffectAt{EffectKind::kLinkMass, 2}));
  EXPECT_FALSE(told.link_share_judged);
  EXPECT_TRUE(added.may_be_written(false)) << added.doubts.size();
  EXPECT_LT(told.joints[2].holdout_after, 0.1 * told.joints[2].holdout_before);
}

// Everywhere by a third, each its own way: no one link nor effect is that, and the file gets
// others.
TEST(ManyJoints, GIVEN_links_that_are_all_off_THEN_the_new_file_has_others) {
  const RobotDescription robot = test::serial_arm(3);
  RobotDescription real = robot;
  const std::vector<double> factors{1.3, 0.75, 1.3};
  for (std::size_t link = 0; link < factors.size(); ++link) {
    Joint<double>& one = real.joints[link].joint;
    one.mass_kg *= factors[link];
    one.centre_of_mass_m[1] += 0.02;
    one.centre_of_mass_m[2] -= 0.02;
    for (double& inertia : one.inertia_kg_m2) inertia *= 1.3;
  }
  const AddedFindings added =
      add_found(robot, {test::record(real, {.duration_s = 20})}, {}, quick(2), {});
  const Explanation& told = added.explanation;
  EXPECT_TRUE(told.link_share_judged) << told.words;
  EXPECT_EQ(told.verdict, Verdict::kParameterShift) << told.words;
  EXPECT_THAT(told.words, HasSubstr("of the links"));
  EXPECT_THAT(told.found, IsEmpty());
  EXPECT_TRUE(added.may_be_written(false));
  for (const JointErrors& joint : told.joints) {
    EXPECT_LT(joint.holdout_after, 0.3 * joint.holdout_before) << joint.joint;
  }
}

// Of constants that nobody doubts only the ratios would show, and the drive that is right would be
// the wrong one.
TEST(ManyJoints, GIVEN_links_and_torque_constants_that_are_off_THEN_no_constant_is_named) {
  const RobotDescription robot = test::serial_arm(4);
  RobotDescription real = robot;
  const std::vector<double> factors{1.2, 0.85, 1.2, 0.85};
  for (std::size_t link = 0; link < factors.size(); ++link) {
    Joint<double>& one = real.joints[link].joint;
    one.mass_kg *= factors[link];
    one.centre_of_mass_m[1] += 0.015;
    one.centre_of_mass_m[2] -= 0.015;
    for (double& inertia : one.inertia_kg_m2) inertia *= factors[link];
  }
  Log log = test::record(real, {.duration_s = 20});
  const std::vector<double> constants{1.04, 1, 1.04, 1.04};
  for (std::size_t joint = 0; joint < constants.size(); ++joint) {
    log.tau.col(static_cast<Eigen::Index>(joint)) *= constants[joint];
  }
  const AddedFindings added = add_found(robot, {log}, {}, quick(2), {});
  const Explanation& told = added.explanation;
  EXPECT_TRUE(told.link_share_judged) << told.words;
  EXPECT_THAT(told.found, IsEmpty()) << told.words;
  EXPECT_TRUE(added.may_be_written(false));
  const auto& effects = told.improved.effects;
  EXPECT_TRUE(std::any_of(effects.begin(), effects.end(), [](const RobotEffect& one) {
    return one.kind == EffectKind::kTorqueScale && one.fitted;
  }));
  for (const JointErrors& joint : told.joints) {
    EXPECT_LT(joint.holdout_after, 0.2 * joint.holdout_before) << joint.joint;
  }
}

// Half of a joint's torque, and most of it constant or a spring where the joint moves.
TEST(ManyJoints, GIVEN_a_counterweight_THEN_a_curve_over_the_position_is_named) {
  const RobotDescription robot = test::serial_arm(4);
  Log log = test::record(robot, {.duration_s = 20});
  const Log unseen = [&] {
    Log other = test::record(robot, {.duration_s = 20, .seed = 2});
    other.tau.col(1).array() -= 12 * (other.q.col(1).array() - 0.4).cos();
    return other;
  }();
  log.tau.col(1).array() -= 12 * (log.q.col(1).array() - 0.4).cos();
  const AddedFindings added = add_found(robot, {log}, {unseen}, quick(2), {});
  const Explanation& told = added.explanation;
  ASSERT_THAT(told.found, Not(IsEmpty())) << told.words;
  EXPECT_EQ(told.found.size(), 1U) << told.words;
  EXPECT_EQ(told.found[0].what, (EffectAt{EffectKind::kPositionTorque, 1})) << told.words;
  EXPECT_TRUE(added.may_be_written(false));
  EXPECT_LT(told.joints[1].holdout_after, 0.1 * told.joints[1].holdout_before);
}

// The width of the file's smoothed sign is another than what the motion would resolve, and right.
TEST(ManyJoints, GIVEN_a_slow_motion_and_the_right_width_of_friction_THEN_nothing_is_missing) {
  RobotDescription robot = test::serial_arm(2);
  for (RobotEffect& effect : robot.effects) {
    effect.fitted = false;
    if (effect.kind == EffectKind::kCoulombFriction) effect.parameters[1] = 0.3;
  }
  const Log log = test::record(robot, {.duration_s = 20, .torque_noise_nm = 0.001});
  const Explanation told = explain(robot, {log}, {}, quick(2));
  EXPECT_EQ(told.verdict, Verdict::kExplained) << told.words;
  for (const JointErrors& joint : told.joints) {
    EXPECT_LT(joint.rms_after, 2 * joint.rms_before) << joint.joint;
  }
}

// Every joint of so long a recording is looked at beside the others.
TEST(ManyJoints, OfALongRecordingThreadsFindWhatIsWrongOnEachJoint) {
  constexpr Eigen::Index kFirst = 200'000;
  constexpr Eigen::Index kRows = 400;
  const RobotDescription robot = test::serial_arm(7);
  Log log = test::record(robot, {.duration_s = 290, .rate_hz = 1000});
  ASSERT_GT(threads_for(log.q.size()), 1) << "on a machine of several processors";
  for (const JointComparison& joint : compare(robot, measure(log, robot)).joints) {
    EXPECT_LT(joint.relative_error_percent, 2) << joint.joint;
  }
  log.tau(100'000, 4) += 500;
  log.q.col(2).segment(kFirst, kRows).setConstant(log.q(kFirst, 2));
  const std::vector<DataFault> faults = examine(log, robot);
  const auto rows_of = [&](DataFaultKind kind, Eigen::Index joint) {
    std::vector<RowSpan> rows;
    for (const DataFault& fault : faults) {
      if (fault.kind != kind || fault.joint != joint) continue;
      for (const FaultSpan& span : fault.spans) rows.push_back(span.samples);
    }
    return rows;
  };
  EXPECT_EQ(faults.size(), 2U);
  const std::vector<RowSpan> stuck = rows_of(DataFaultKind::kStuck, 2);
  ASSERT_EQ(stuck.size(), 1U);
  EXPECT_NEAR(static_cast<double>(stuck[0].first), kFirst, 1);
  EXPECT_NEAR(static_cast<double>(stuck[0].count()), kRows, 2);
  const std::vector<RowSpan> spike = rows_of(DataFaultKind::kJump, 4);
  ASSERT_EQ(spike.size(), 1U);
  EXPECT_EQ(spike[0].first, 100'000);
}

TEST(ManyJoints, TheNumberOfThreadsChangesNothing) {
  const ExplainNames names{{"log"}, {}, "robot", "explain"};
  EXPECT_EQ(to_json(explained(6, 9, 1), names), to_json(explained(6, 9, 2), names));
}

}  // namespace
}  // namespace offnominal::desk
