#include "look/name_guess.hpp"

#include <gtest/gtest.h>

namespace {

using offnominal::desk::guess_of;
using offnominal::desk::Role;

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
                          Case{"state.q[6]", Role::kPosition, 6, ""},
                          Case{"cmd.tau_J_d[6]", Role::kNone, 6, ""},
                          Case{"tau_ext_hat_filtered_3", Role::kNone, 3, ""},
                          Case{"gripper_state_pos", Role::kNone, -1, ""},
                          Case{"error_pos_deg(1,:)", Role::kNone, 1, ""},
                          Case{"Reference Velocity", Role::kNone, -1, ""},
                          Case{"temperature1", Role::kNone, 1, ""},
                          Case{"Zeit [s]", Role::kTime, -1, "s"},
                          Case{"Geschwindigkeit [\u00b0/s]", Role::kVelocity, -1, "\u00b0/s"},
                          Case{"A2 Drehmoment [Nm]", Role::kTorque, 2, "Nm"},
                          Case{"A2 Motorstrom [A]", Role::kCurrent, 2, "A"},
                          Case{"A1 Soll-Position [\u00b0]", Role::kNone, 1, ""},
                          Case{"axis 3 [mA]", Role::kCurrent, 3, "mA"},
                          Case{"axis 3 [1/min]", Role::kVelocity, 3, "1/min"},
                          Case{"bus [V]", Role::kNone, -1, ""},
                          Case{"i_mA", Role::kCurrent, -1, "mA"},
                          Case{"torque_2_mA", Role::kCurrent, 2, "mA"},
                          Case{"torque_current1", Role::kCurrent, 1, ""},
                          Case{"current_position1", Role::kPosition, 1, ""},
                          Case{"field.effort0", Role::kTorque, 0, ""},
                          Case{"joint_p[2]", Role::kPosition, 2, ""},
                          Case{"joint_dp[2]", Role::kVelocity, 2, ""},
                          Case{"joint_u[2]", Role::kTorque, 2, ""},
                          Case{"joint1_u", Role::kTorque, 1, ""},
                          Case{"joint1_pid_p", Role::kNone, 1, ""},
                          Case{"theta_dot_2", Role::kVelocity, 2, ""},
                          Case{"thetadot2", Role::kVelocity, 2, ""},
                          Case{"q1_dot", Role::kVelocity, 1, ""},
                          Case{"dphi1", Role::kVelocity, 1, ""},
                          Case{"dtheta_1", Role::kVelocity, 1, ""},
                          Case{"angle_rate_1", Role::kVelocity, 1, ""},
                          Case{"jointvel3", Role::kVelocity, 3, ""},
                          Case{"Axis 1.NcToPlc.ActVelo", Role::kVelocity, 1, ""},
                          Case{"oil_level_1", Role::kNone, 1, ""},
                          Case{"sample_rate", Role::kNone, -1, ""},
                          Case{"ddtheta_1", Role::kNone, 1, ""},
                          Case{"theta_ddot_1", Role::kNone, 1, ""},
                          Case{"thetaddot1", Role::kNone, 1, ""},
                          Case{"theta_dot_dot_1", Role::kNone, 1, ""},
                          Case{"$AXIS_ACT.A1", Role::kPosition, 1, ""},
                          Case{"$AXIS_ACT_MEAS.A1", Role::kPosition, 1, ""},
                          Case{"$VEL_AXIS_ACT[1]", Role::kVelocity, 1, ""},
                          Case{"$TORQUE_AXIS_ACT[1]", Role::kTorque, 1, ""},
                          Case{"axis_act_mode_1", Role::kNone, 1, ""},
                          Case{"vir", Role::kVoltage, -1, ""},
                          Case{"Vsupply", Role::kNone, -1, ""}}) {
    const auto guess = guess_of(one.name);
    EXPECT_EQ(guess.role, one.role) << one.name;
    EXPECT_EQ(guess.number, one.number) << one.name;
    EXPECT_EQ(guess.unit, one.unit) << one.name;
  }
}

TEST(NameGuess, OfWhatIsNotMeasuredItSaysWhatItWouldBe) {
  EXPECT_EQ(guess_of("tau_ext_hat_filtered_3").not_measured, Role::kTorque);
  EXPECT_EQ(guess_of("q_des_3").not_measured, Role::kPosition);
  EXPECT_EQ(guess_of("q_3").not_measured, Role::kNone);
  EXPECT_EQ(guess_of("motor_temp_3").not_measured, Role::kNone);
}

TEST(NameGuess, AUnitThatTheFileSaysGivesARoleToANameThatSaysNone) {
  EXPECT_EQ(guess_of("axis1", "mA").role, Role::kCurrent);
  EXPECT_EQ(guess_of("axis1", "deg").role, Role::kPosition);
  EXPECT_EQ(guess_of("axis1_ref", "deg").role, Role::kNone);
  EXPECT_EQ(guess_of("torque1", "mA").role, Role::kCurrent);
  EXPECT_TRUE(guess_of("motor_pos").of_motor);
  EXPECT_FALSE(guess_of("act_pos_mot_deg").of_motor);
}

}  // namespace
