#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "look/name_guess.hpp"

// Which columns are the joints' positions, velocities and torques, by their names: families of
// columns that differ in a number (pos_1, pos_2), or in the name of a joint (shoulder_pos,
// elbow_pos; position.shoulder_pan_joint).

namespace offnominal::desk {

struct NamedColumn {
  std::string name;
  std::string said_unit = {};  // by the file; empty: none
  bool is_constant = false;
  bool ascends = true;  // as a time does; asked of those that are called one
};

// What is known of the robot.
struct ExpectedJoints {
  int count = 0;  // 0: not known
  std::vector<std::string> names = {};
};

// Columns of one quantity, one for each joint.
struct FamilyOfJoints {
  std::string name;
  std::vector<std::string> columns;
  bool of_motor = false;
};

struct Roles {
  std::optional<std::string> time;
  std::vector<std::string> position;
  std::vector<std::string> velocity;
  std::vector<std::string> torque;
  Role torque_role = Role::kTorque;  // or kCurrent, kVoltage
  bool position_of_motor = false;    // by its name
  bool velocity_of_motor = false;
  bool torque_of_motor = false;
  std::vector<std::string> other_families;      // of the same roles, that would do as well
  std::vector<FamilyOfJoints> other_positions;  // of them
  std::vector<FamilyOfJoints> other_velocities;
  // Positions and torques or currents that are more or fewer than there are joints, where none are
  // as many: the largest family; empty: none.
  std::vector<std::string> positions_of_other_count;
  std::vector<std::string> torques_of_other_count;
  // That are as many, and by their names were asked for, act from outside or come from a model.
  std::vector<std::string> not_measured;
  // That are taken for want of a plainer name, and may have been asked for: "q_d_#".
  std::vector<std::string> may_be_asked_for;
  std::string order;  // how joints that have names stand; empty: by number
};

// Of the columns that are called a time one that ascends, then one of which this is more than a
// letter among others ("T1", "O_T_EE[0]"), then one that stands where the positions stand, then the
// one of the fewest words ("time" before "exec_time"), then the first. A letter among others alone
// is none where it does not ascend: a temperature.
[[nodiscard]] std::optional<std::string> time_in(const std::vector<NamedColumn>& columns,
                                                 const std::vector<std::string>& position);

// The families that have a column for each joint, or for as many as most families have where that
// is not known. Of several, one that stands where the positions stand, then one whose columns all
// change, then one that shares most words with them, then one that is called measured, then one
// that is not called estimated, then the one of the fewest words ("q_1" before "q_foo_1"), then the
// first. What was not measured is never taken. Joints with names stand in the robot's order where
// all of its names are found, else in that of the columns.
[[nodiscard]] Roles roles_of(const std::vector<NamedColumn>& columns,
                             const ExpectedJoints& expected);

}  // namespace offnominal::desk
