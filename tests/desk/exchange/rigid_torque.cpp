#include "rigid_torque.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <offnominal/model/inverse_dynamics.hpp>

#include "robot/chain_of.hpp"

namespace offnominal::test {

MotionState random_state(std::mt19937_64& generator, int joints) {
  const auto draw = [&](double most) {
    std::vector<double> values(static_cast<std::size_t>(joints));
    for (double& value : values) {
      value = std::uniform_real_distribution<double>(-most, most)(generator);
    }
    return values;
  };
  MotionState state;
  state.q = draw(std::numbers::pi);
  state.dq = draw(3);
  state.ddq = draw(5);
  return state;
}

std::vector<double> torque_of(const desk::RobotDescription& robot, const MotionState& state) {
  using Joints = Vector<kRuntimeJoints, double>;
  const auto vector = [&](const std::vector<double>& values) {
    return Joints(Eigen::Map<const Joints>(values.data(), robot.joint_count()));
  };
  const auto model = make_model(desk::chain_of<kRuntimeJoints, double>(robot));
  const Joints torque =
      inverse_dynamics(model, vector(state.q), vector(state.dq), vector(state.ddq), 0.0);
  return {torque.begin(), torque.end()};
}

double deviation(const std::vector<double>& a, const std::vector<double>& b) {
  double difference = a.size() == b.size() ? 0 : std::numeric_limits<double>::infinity();
  double largest = 1;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    difference = std::max(difference, std::fabs(a[i] - b[i]));
    largest = std::max({largest, std::fabs(a[i]), std::fabs(b[i])});
  }
  return difference / largest;
}

}  // namespace offnominal::test
