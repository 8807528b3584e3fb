#include "offnominal/sim/plants/hidden_robot.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

namespace offnominal::sim {

using Eigen::Vector2d;

HiddenRobot::HiddenRobot(const hidden::Robot& robot, std::vector<hidden::Contact> contacts,
                         const DesiredMotion& start)
    : robot_(robot),
      plant_(robot, std::move(contacts)),
      inner_(plant_.start(start.q, start.dq, start.ddq)),
      state_{inner_.motor_q, inner_.motor_dq} {}

void HiddenRobot::step(double t_s, const JointVector& tau, double period_s) {
  constexpr double kMaxSubstepS = 1e-4;
  const int substeps = static_cast<int>(std::ceil(period_s / kMaxSubstepS - 1e-9));
  const double h_s = period_s / substeps;
  told_.emplace_back(tau);
  Vector2d sum = Vector2d::Zero();
  for (int i = 0; i < substeps; ++i) {
    const double step_t_s = t_s + i * h_s;
    Vector2d given;
    for (int j = 0; j < 2; ++j) given[j] = given_torque(j, step_t_s + 0.5 * h_s, period_s);
    plant_.step(inner_, step_t_s, given, h_s);
    sum += given;
  }
  given_ = sum / substeps;
  state_ = {inner_.motor_q, inner_.motor_dq};
  if (!(inner_.motor_q.cwiseAbs().maxCoeff() < 100.0)) {
    throw std::runtime_error("hidden robot: its motion ran away at t = " + std::to_string(t_s) +
                             " s");
  }
  const double latest_s = std::max(robot_.joints[0].drive.delay_s, robot_.joints[1].drive.delay_s);
  while (static_cast<double>(told_.size()) > latest_s / period_s + 2.0) {
    told_.pop_front();
    ++first_told_;
  }
}

double HiddenRobot::given_torque(Eigen::Index joint, double t_s, double period_s) const {
  const hidden::JointDrive& drive = robot_.joints[static_cast<std::size_t>(joint)].drive;
  const double late = std::max(0.0, std::floor((t_s - drive.delay_s) / period_s));
  const double tau = told_[static_cast<std::size_t>(late - first_told_)][joint];
  const double beyond = std::max(0.0, std::abs(tau) - drive.saturation_onset_nm);
  return drive.scale * (tau - std::copysign((1.0 - drive.saturation_slope) * beyond, tau));
}

}  // namespace offnominal::sim
