#include "look/roles.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <initializer_list>

namespace {

using offnominal::desk::ExpectedJoints;
using offnominal::desk::NamedColumn;
using offnominal::desk::Role;
using offnominal::desk::Roles;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;

Roles roles_of(std::initializer_list<const char*> names, const ExpectedJoints& expected = {}) {
  std::vector<NamedColumn> columns;
  for (const char* name : names) columns.push_back({name});
  return offnominal::desk::roles_of(columns, expected);
}

TEST(Roles, FamiliesHaveOneColumnForEachJoint) {
  const Roles roles = roles_of({"time", "pos_2", "pos_1", "pos_10", "vel_1", "vel_2", "vel_10",
                                "i_1", "i_2", "i_10", "pos_gripper"});
  EXPECT_EQ(roles.time, "time");
  EXPECT_THAT(roles.position, ElementsAre("pos_1", "pos_2", "pos_10"));
  EXPECT_THAT(roles.velocity, ElementsAre("vel_1", "vel_2", "vel_10"));
  EXPECT_THAT(roles.torque, ElementsAre("i_1", "i_2", "i_10"));
  EXPECT_EQ(roles.torque_role, Role::kCurrent);
  EXPECT_EQ(roles.order, "");
}

TEST(Roles, WhatStandsInOneStructureBelongsTogether) {
  const Roles roles =
      roles_of({"model.time", "tau_g(1,:)", "tau_g(2,:)", "rec.time", "rec.pos(1,:)",
                "rec.pos(2,:)", "rec.torque(1,:)", "rec.torque(2,:)"},
               {2, {}});
  EXPECT_EQ(roles.time, "rec.time");
  EXPECT_THAT(roles.torque, ElementsAre("rec.torque(1,:)", "rec.torque(2,:)"));
  EXPECT_THAT(roles.other_families, ElementsAre("tau_g(#,:)"));
}

TEST(Roles, OfAnotherNumberOfJointsNothingIsTaken) {
  EXPECT_THAT(roles_of({"t", "q1", "q2", "tau1", "tau2"}, {3, {}}).position, IsEmpty());
}

TEST(Roles, JointsThatHaveNamesAreFamiliesToo) {
  const Roles roles = roles_of({"time", "shoulder_pos", "elbow_pos", "shoulder_vel", "elbow_vel",
                                "shoulder_torque", "elbow_torque"});
  EXPECT_THAT(roles.position, ElementsAre("shoulder_pos", "elbow_pos"));
  EXPECT_THAT(roles.velocity, ElementsAre("shoulder_vel", "elbow_vel"));
  EXPECT_THAT(roles.torque, ElementsAre("shoulder_torque", "elbow_torque"));
  EXPECT_THAT(roles.order, HasSubstr("in the order of the columns"));
}

TEST(Roles, NamesOfTheRobotsJointsGiveTheirOrder) {
  const Roles roles = roles_of(
      {"t", "position.elbow_joint", "position.gripper_finger_joint", "position.shoulder_pan_joint",
       "effort.elbow_joint", "effort.gripper_finger_joint", "effort.shoulder_pan_joint"},
      {2, {"shoulder_pan_joint", "elbow_joint"}});
  EXPECT_THAT(roles.position, ElementsAre("position.shoulder_pan_joint", "position.elbow_joint"));
  EXPECT_THAT(roles.torque, ElementsAre("effort.shoulder_pan_joint", "effort.elbow_joint"));
  EXPECT_EQ(roles.torque_role, Role::kTorque);
  EXPECT_THAT(roles.order, HasSubstr("in the robot's order"));
}

TEST(Roles, ANumberedArmOnANamedTorsoIsOneChain) {
  const Roles roles = roles_of({"t", "- torso_lift_joint_position", "- arm_1_joint_position",
                                "- arm_2_joint_position", "- torso_lift_joint_effort",
                                "- arm_1_joint_effort", "- arm_2_joint_effort"});
  EXPECT_THAT(roles.position, ElementsAre("- torso_lift_joint_position", "- arm_1_joint_position",
                                          "- arm_2_joint_position"));
  EXPECT_EQ(roles.torque.size(), 3U);
}

TEST(Roles, WordsOfHowAValueCameAboutAreNoJoints) {
  const Roles roles = roles_of({"time", "pos_meas1", "pos_meas2", "vel_meas1", "vel_meas2",
                                "pos_filt1", "pos_filt2", "vel_filt1", "vel_filt2", "tau_con1",
                                "tau_con2", "tau_meas1", "tau_meas2"});
  EXPECT_THAT(roles.position, ElementsAre("pos_meas1", "pos_meas2"));
  EXPECT_THAT(roles.velocity, ElementsAre("vel_meas1", "vel_meas2"));
  EXPECT_THAT(roles.torque, ElementsAre("tau_meas1", "tau_meas2"));
  EXPECT_THAT(roles_of({"pos_meas", "pos_filt", "tau_meas", "tau_filt"}).position.size(), 1U);
}

// Whatever stands first in the file.
TEST(Roles, WhatWasMeasuredComesBeforeWhatWasAskedFor) {
  const Roles roles =
      roles_of({"O_T_EE_0", "O_T_EE_1", "time", "q_d_0", "q_d_1", "q_0", "q_1", "dq_d_0", "dq_d_1",
                "dq_0", "dq_1", "tau_J_d_0", "tau_J_d_1", "tau_ext_hat_filtered_0",
                "tau_ext_hat_filtered_1", "tau_est_0", "tau_est_1", "tau_J_0", "tau_J_1"});
  EXPECT_EQ(roles.time, "time");
  EXPECT_THAT(roles.position, ElementsAre("q_0", "q_1"));
  EXPECT_THAT(roles.velocity, ElementsAre("dq_0", "dq_1"));
  EXPECT_THAT(roles.torque, ElementsAre("tau_J_0", "tau_J_1"));
  EXPECT_THAT(roles.other_families, ElementsAre("tau_est_#"));
  EXPECT_THAT(roles.not_measured,
              UnorderedElementsAre("q_d_#", "dq_d_#", "tau_J_d_#", "tau_ext_hat_filtered_#"));
}

TEST(Roles, WhatWasNotMeasuredIsNotTakenEvenAlone) {
  const Roles roles = roles_of({"t", "shoulder_pos_cmd", "elbow_pos_cmd", "shoulder_velocity",
                                "elbow_velocity", "shoulder_torque", "elbow_torque"});
  EXPECT_THAT(roles.position, IsEmpty());
  EXPECT_THAT(roles.torque, ElementsAre("shoulder_torque", "elbow_torque"));
  EXPECT_THAT(roles.not_measured, Contains("*_pos_cmd"));
}

TEST(Roles, WhatSaysThatItWasMeasuredComesFirst) {
  const Roles roles = roles_of({"t", "pos_x_1", "pos_1", "pos_meas_1", "tau_hat_1", "tau_1"});
  EXPECT_THAT(roles.position, ElementsAre("pos_meas_1"));
  EXPECT_THAT(roles.torque, ElementsAre("tau_1"));
  EXPECT_THAT(roles.other_families, ElementsAre("pos_x_#", "pos_#", "tau_hat_#"));
}

TEST(Roles, ARateIsNoJointAndNoPosition) {
  const Roles roles =
      roles_of({"t", "theta_1", "theta_2", "theta_dot_1", "theta_dot_2", "u_1", "u_2"}, {2, {}});
  EXPECT_THAT(roles.position, ElementsAre("theta_1", "theta_2"));
  EXPECT_THAT(roles.velocity, ElementsAre("theta_dot_1", "theta_dot_2"));
  EXPECT_THAT(roles.torque, IsEmpty());
  EXPECT_THAT(roles.other_families, IsEmpty());
}

// It may be the name of a joint, or say how it came about.
TEST(Roles, ALetterAloneIsTakenAndTold) {
  const Roles roles = roles_of({"t", "q_d_1", "q_d_2", "tau_1", "tau_2"});
  EXPECT_THAT(roles.position, ElementsAre("q_d_1", "q_d_2"));
  EXPECT_THAT(roles.may_be_asked_for, ElementsAre("q_d_#"));
  EXPECT_THAT(roles_of({"t", "pos_b", "pos_d", "tau_b", "tau_d"}).position,
              ElementsAre("pos_b", "pos_d"));
}

TEST(Roles, ColumnsThatChangeComeBeforeThoseThatDoNot) {
  const Roles roles = offnominal::desk::roles_of({{"pos_se_1", {}, false},
                                                  {"pos_se_2", {}, true},
                                                  {"pos_mot_1", {}, false},
                                                  {"pos_mot_2", {}, false},
                                                  {"vel_se_1", {}, false},
                                                  {"vel_se_2", {}, false},
                                                  {"vel_mot_1", {}, false},
                                                  {"vel_mot_2", {}, false}},
                                                 {2, {}});
  EXPECT_THAT(roles.position, ElementsAre("pos_mot_1", "pos_mot_2"));
  EXPECT_THAT(roles.velocity, ElementsAre("vel_mot_1", "vel_mot_2"));
}

}  // namespace
