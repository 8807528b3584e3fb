#pragma once

#include <stdexcept>
#include <string>

namespace offnominal::test {

/// A robot file that uses every table; tests change one place of it.
inline const std::string kSampleRobot = R"(format = 1
name = "sample"
source = "made up"
gravity_m_s2 = [0.0, 0.0, -9.81]

[[joint]]
name = "turn"
type = "revolute"
axis = [0.0, 0.0, 1.0]
origin_m = [0.0, 0.0, 0.3]
rpy_rad = [0.1, -0.2, 1.5]
source = "drawing 12"
[joint.link]
mass_kg = 2.5
centre_of_mass_m = [0.1, 0.0, -0.05]
inertia_kg_m2 = {xx = 0.02, yy = 0.03, zz = 0.025, xy = 0.001, xz = 0.0, yz = -0.002}
[joint.limits]
position = [-3.0, 3.0]
velocity = 4.0
torque = 50.0
[joint.encoder]
bits = 17
[joint.control]
kp_per_s2 = 100.0
kd_per_s = 20.0

[[joint]]
name = "slide"
type = "prismatic"
axis = [0.0, 1.0, 0.0]
rotation = [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]
[joint.link]
mass_kg = 1.0
centre_of_mass_m = [0.0, 0.0, 0.0]
[joint.encoder]
counts_per_unit = 2e7

[[effect]]
kind = "stribeck_friction"
joint = 1
level = 1.5
stribeck_velocity = 0.2
fitted = true
source = "add, log A"

[[effect]]
kind = "viscous_friction"
joint = 2
coefficient = 12

[estimator]
period_s = 0.002
alpha_per_s = 20.0
hidden_units = 12
learning_rate = 0.5
weight_radius = 3.0
initial_weight_range = 0.2
seed = 7
dead_zone = "discontinuous"
torque_signal = "held"

[arming]
position_window = [0.1, 0.02]
speed = [0.2, 0.03]
torque_rate = [500.0, 60.0]
ramp_s = 0.5

[uncertainty_bound]
kind = "table"
variable = "torque"
joint = 2
at = [0.0, 10.0]
value = [1.0, 2.5]

[drives]
protocol = "can_simple"  # as odrivetool says
node = [3, 44]
joint_per_turn = [6.25, -0.5]

[channels]
position = ["a", "b"]
torque = [{source = "i1", scale = 0.5, unit = "A"}, "f2"]
)";

/// `text` with its first `from` turned into `to`.
inline std::string changed(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  if (at == std::string::npos) throw std::logic_error("the sample has no " + from);
  return text.replace(at, from.size(), to);
}

}  // namespace offnominal::test
