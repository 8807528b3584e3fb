#pragma once

#include <string>
#include <vector>

#include "look/look.hpp"
#include "look/roles.hpp"

// The columns of a look, as all that proposes channels needs them.

namespace offnominal::desk {

// File, columns with their facts, and what is unread; nothing of it taken for anything but by name.
[[nodiscard]] Look look_of(const NamedColumns& columns);

void set_time(Look& look, const Eigen::VectorXd& t_s);
void take_for_no_time_but(Look& look, const std::string& name);

[[nodiscard]] const LookedColumn* column_in(const Look& look, const std::string& name);

[[nodiscard]] std::vector<NamedColumn> columns_of(const Look& look);
[[nodiscard]] ExpectedJoints expected_of(const RobotDescription* robot);

// With the unit that is not the SI's own, and, of currents and voltages, any, where it is one of
// the quantity's.
[[nodiscard]] Channel channel_of(const Look& look, const std::string& name, Role role);

}  // namespace offnominal::desk
