#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <offnominal/controller/controller_config.hpp>
#include <offnominal/hal/drive_protocol.hpp>

namespace offnominal::controller {

// The largest command that is none above a limit > 0: frames carry floats, and the nearest one may
// be above it.
template <typename Scalar>
[[nodiscard]] constexpr float largest_command(Scalar limit) {
  constexpr float kMost = std::numeric_limits<float>::max();
  if (limit >= static_cast<Scalar>(kMost)) return kMost;
  const auto nearest = static_cast<float>(limit);
  if (static_cast<Scalar>(nearest) <= limit) return nearest;
  return std::bit_cast<float>(std::bit_cast<std::uint32_t>(nearest) - 1);
}

// Holds torques to what the joints' drives can give, and to how fast they may change.
template <int N, typename Scalar>
class TorqueLimiter {
 public:
  using Commands = PerJoint<N, hal::TorqueCommand>;

  TorqueLimiter() = default;
  // Of a configuration that validate() accepts.
  template <typename Space>
  explicit TorqueLimiter(const ControllerConfig<N, Scalar, Space>& config) {
    const std::size_t joints = config.monitor.chain.joints.size();
    size_for(joints, limit_, step_);
    for (std::size_t j = 0; j < joints; ++j) {
      limit_[j] = static_cast<Scalar>(largest_command(config.monitor.chain.joints[j].max_torque));
      step_[j] = config.arming.torque_rate[j] * config.monitor.estimator.period_s;
    }
  }

  // commands: of the tick before. is_in[j] becomes true where the rate takes nothing away.
  void hold(const Commands& commands, Vector<N, Scalar>& tau, PerJoint<N, bool>& is_in) const {
    for (std::size_t j = 0; j < limit_.size(); ++j) {
      const auto before = static_cast<Scalar>(commands[j].torque);
      Scalar& wanted = tau[static_cast<Eigen::Index>(j)];
      wanted = std::clamp(wanted, -limit_[j], limit_[j]);
      const Scalar held = std::clamp(wanted, before - step_[j], before + step_[j]);
      if (held == wanted) is_in[j] = true;
      wanted = held;
    }
  }

 private:
  PerJoint<N, Scalar> limit_{};  // N m or N
  PerJoint<N, Scalar> step_{};   // in one tick, N m or N
};

}  // namespace offnominal::controller
