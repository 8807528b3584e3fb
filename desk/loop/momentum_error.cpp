#include "loop/momentum_error.hpp"

#include <algorithm>
#include <cstddef>
#include <numbers>
#include <offnominal/model/mass_matrix.hpp>
#include <random>

#include "robot/chain_of.hpp"

namespace offnominal::desk {

std::vector<double> momentum_per_velocity(const RobotDescription& robot) {
  constexpr int kPoses = 2000;
  constexpr double kBetweenPoses = 1.1;
  const auto model = make_model(chain_of<kRuntimeJoints, double>(robot));
  std::mt19937 generator;  // the same poses every time
  std::vector<double> most(robot.joints.size());
  for (int pose = 0; pose < kPoses; ++pose) {
    Vector<kRuntimeJoints, double> q(robot.joint_count());
    for (Eigen::Index j = 0; j < q.size(); ++j) {
      // A turn, or a metre, where there is no limit.
      const Joint<double>& joint = robot.joints[static_cast<std::size_t>(j)].joint;
      const double reach = joint.type == JointType::kRevolute ? std::numbers::pi : 1.0;
      const double low = std::max(joint.min_position, std::min(-reach, joint.max_position - reach));
      const double high = std::min(joint.max_position, std::max(reach, joint.min_position + reach));
      q[j] = std::uniform_real_distribution<double>(low, std::max(low, high))(generator);
    }
    const auto inertia = mass_matrix(model, q);
    for (std::size_t i = 0; i < most.size(); ++i) {
      const double sum = inertia.row(static_cast<Eigen::Index>(i)).cwiseAbs().sum();
      most[i] = std::max(most[i], kBetweenPoses * sum);
    }
  }
  return most;
}

}  // namespace offnominal::desk
