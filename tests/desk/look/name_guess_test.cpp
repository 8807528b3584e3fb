#include "look/name_guess.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace {

using offnominal::desk::guess_of;
using offnominal::desk::Role;
using offnominal::desk::Roles;
using offnominal::desk::roles_of;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(NameGuess, RolesUnitsAndNumbersOfCommonNames) {
  struct Case {
    const char* name;
    Role role;
    int number;
    const char* unit;
  };
  for (const Case& one : {Case{"t", Role::kTime, -1, ""},
                          Case{"Time", Role::kTime, -1, ""},
                          Case{"time [ms]", Role::kTime, -1, "ms"},
                          Case{"q1", Role::kPosition, 1, ""},
                          Case{"dq12", Role::kVelocity, 12, ""},
                          Case{"tau3", Role::kTorque, 3, ""},
                          Case{"actual_current_4", Role::kCurrent, 4, ""},
                          Case{"axis2_position_deg", Role::kPosition, 2, "deg"},
                          Case{"pos_deg_2", Role::kPosition, 2, "deg"},
                          Case{"rec.act_pos_mot_deg(5,:)", Role::kPosition, 5, "deg"},
                          Case{"rec.act_vel_mot_deg_per_s(5,:)", Role::kVelocity, 5, "deg/s"},
                          Case{"rec.act_torque_abs_nm(1,:)", Role::kTorque, 1, "Nm"},
                          Case{"q(:,2)", Role::kPosition, 2, ""},
                          Case{"Velocity [rpm]", Role::kVelocity, -1, "rpm"},
                          Case{"jointPosition[0]", Role::kPosition, 0, ""},
                          Case{"q_ref1", Role::kNone, 1, ""},
                          Case{"error_pos_deg(1,:)", Role::kNone, 1, ""},
                          Case{"Reference Velocity", Role::kNone, -1, ""},
                          Case{"temperature1", Role::kNone, 1, ""},
                          Case{"Vsupply", Role::kNone, -1, ""}}) {
    const auto guess = guess_of(one.name);
    EXPECT_EQ(guess.role, one.role) << one.name;
    EXPECT_EQ(guess.number, one.number) << one.name;
    EXPECT_EQ(guess.unit, one.unit) << one.name;
  }
}

TEST(NameGuess, FamiliesHaveOneColumnForEachJoint) {
  const Roles roles = roles_of({"time", "pos_2", "pos_1", "pos_10", "vel_1", "vel_2", "vel_10",
                                "i_1", "i_2", "i_10", "pos_gripper"},
                               0);
  EXPECT_EQ(roles.time, "time");
  EXPECT_THAT(roles.position, ElementsAre("pos_1", "pos_2", "pos_10"));
  EXPECT_THAT(roles.velocity, ElementsAre("vel_1", "vel_2", "vel_10"));
  EXPECT_THAT(roles.torque, ElementsAre("i_1", "i_2", "i_10"));
  EXPECT_TRUE(roles.torque_is_current);
}

TEST(NameGuess, WhatStandsInOneStructureBelongsTogether) {
  const Roles roles =
      roles_of({"model.time", "tau_g(1,:)", "tau_g(2,:)", "rec.time", "rec.pos(1,:)",
                "rec.pos(2,:)", "rec.torque(1,:)", "rec.torque(2,:)"},
               2);
  EXPECT_EQ(roles.time, "rec.time");
  EXPECT_THAT(roles.torque, ElementsAre("rec.torque(1,:)", "rec.torque(2,:)"));
  EXPECT_THAT(roles.other_families, ElementsAre("tau_g(#,:)"));
}

TEST(NameGuess, OfAnotherNumberOfJointsNothingIsTaken) {
  EXPECT_THAT(roles_of({"t", "q1", "q2", "tau1", "tau2"}, 3).position, IsEmpty());
}

}  // namespace
