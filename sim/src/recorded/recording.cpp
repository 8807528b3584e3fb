#include "offnominal/sim/recorded/recording.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace offnominal::sim::recorded {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using hidden::Draws;

double rounded(double value, double step) { return step * std::round(value / step); }

double with_digits(double value, int digits) {
  if (value == 0) return 0;
  const double unit = std::pow(10.0, std::floor(std::log10(std::abs(value))) + 1 - digits);
  return rounded(value, unit);
}

}  // namespace

Habits draw_habits(Draws& draws) {
  constexpr std::array<int, 5> kBits{14, 16, 17, 19, 20};
  Habits habits;
  habits.torque_noise = draws.below(4) == 0 ? 0 : draws.log_uniform(0.001, 0.03);
  if (draws.below(4) == 0) habits.torque_step = draws.log_uniform(0.003, 0.05);
  habits.encoder_bits = kBits[static_cast<std::size_t>(draws.below(5))];
  habits.five_digits = draws.below(4) == 0;
  habits.float_positions = draws.below(5) == 0;
  habits.late_stamps = draws.below(4) == 0 ? 1 + draws.below(5) : 0;
  habits.with_velocity = draws.below(2) == 0;
  return habits;
}

Recording record(const Motion& motion, const MatrixXd& tau, const Habits& habits, Draws& draws) {
  const Index rows = motion.t_s.size();
  const Index joints = tau.cols();
  const double period_s = motion.t_s[1] - motion.t_s[0];
  Recording recording{motion.t_s, motion.q, {}, tau};
  if (habits.with_velocity) recording.dq = motion.dq;
  for (Index joint = 0; joint < joints; ++joint) {
    const double largest = tau.col(joint).cwiseAbs().maxCoeff();
    const double fastest = motion.dq.col(joint).cwiseAbs().maxCoeff();
    for (Index i = 0; i < rows; ++i) {
      double& torque = recording.tau(i, joint);
      torque += habits.torque_noise * largest * draws.gaussian();
      if (habits.torque_step > 0) torque = rounded(torque, habits.torque_step * largest);
      double& q = recording.q(i, joint);
      if (habits.float_positions) {
        q = static_cast<double>(static_cast<float>(q));
      } else {
        q = rounded(q, 2 * std::numbers::pi / std::exp2(habits.encoder_bits));
      }
      if (habits.with_velocity) recording.dq(i, joint) += 0.01 * fastest * draws.gaussian();
      if (!habits.five_digits) continue;
      constexpr int kDigits = 5;
      torque = with_digits(torque, kDigits);
      q = with_digits(q, kDigits);
      if (habits.with_velocity)
        recording.dq(i, joint) = with_digits(recording.dq(i, joint), kDigits);
    }
  }
  for (int k = 0; k < habits.late_stamps; ++k) {
    const Index row = 10 + draws.below(static_cast<int>(rows) - 20);
    const double late = draws.uniform(0.2, 0.9) * period_s;
    recording.t_s[row] = motion.t_s[row] + late;
  }
  return recording;
}

std::string_view name_of(Defect defect) {
  constexpr std::array<std::string_view, kDefects> kNames{
      "none",       "gap",           "stuck_position", "stuck_torque",
      "saturation", "position_step", "position_spike", "torque_spike",
      "start",      "torque_sign",   "degrees",        "milliseconds"};
  return kNames[static_cast<std::size_t>(defect)];
}

}  // namespace offnominal::sim::recorded
