// Why an arm left where its controller had to hold it.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "offnominal/sim/joint_state.hpp"
#include "sil/sil.hpp"

namespace offnominal::desk::sil {

/// Of an arm that its controller let go of by Fault::kArmNotHeld. `before`: where its brakes
/// opened; `after`: when it was let go of. What it may be is computed from the files of both ends;
/// nothing where they do not say.
[[nodiscard]] NotHeld not_held(const RobotDescription& robot, const Scenario& scenario,
                               const sim::JointState& before, const sim::JointState& after);

/// "joint 2 (elbow) moved by 0.0512 rad, and its position_window is 0.05 rad", or how fast it was.
[[nodiscard]] std::string words_of(const NotHeld& arm);

}  // namespace offnominal::desk::sil
