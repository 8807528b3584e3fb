// The joint controller, tick by tick, for any number of joints behind one face.
#pragma once

#include <cstdint>
#include <memory>
#include <offnominal/controller/fault.hpp>
#include <offnominal/hal/drive_description.hpp>
#include <offnominal/hal/drive_protocol.hpp>
#include <offnominal/hal/messages.hpp>
#include <optional>

#include "common/precision.hpp"
#include "loop/bus_port.hpp"
#include "loop/controller_settings.hpp"
#include "loop/motion_at.hpp"
#include "offnominal/sim/joint_state.hpp"
#include "robot/isolated_fault.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk {

/// What the controller knows after a tick, one number per joint in every vector.
struct ControllerView {
  std::uint64_t run_ticks = 0;  // since time began
  bool fresh = false;           // it had a reading of every joint, and one to judge
  bool drives_follow = false;
  // What it judges: where it observes velocities, position, velocity and torque of one time a
  // little earlier.
  sim::JointState seen;
  sim::JointVector tau;  // N m or N, that the drives said they gave
  sim::JointVector psi_hat;
  sim::JointVector compensation;  // N m or N, that acts on the joints
  double error_norm = 0;
  double threshold = 0;
  // Of a controller that judges joint by joint; otherwise empty, and -1.
  sim::JointVector error;       // N m or N
  sim::JointVector thresholds;  // N m or N
  sim::JointVector fast_error;  // both behind a second filter; empty: it has none
  sim::JointVector fast_thresholds;
  int first_joint = -1;  // that was detected first, from 0
  double weight_norm = 0;
  bool detected = false;                  // latched
  bool acts = false;                      // the same of the second level
  bool slows = false;                     // its motion is slowed
  double motion_time_s = 0;               // how far that has come
  double behind_s = 0;                    // and how far it is behind the clock by that
  std::optional<IsolatedFault> isolated;  // once there is an answer, of a robot that asks for one
};

/// Counted since the start.
struct ControllerTotals {
  std::uint64_t overruns = 0;
  std::uint64_t missed_samples = 0;  // ticks without a fresh reading of every joint
  hal::DriveCounts counts;
};

class SteppedController {
 public:
  virtual ~SteppedController() = default;
  /// One tick that began at begin_us on the bus's clock.
  virtual void step(hal::Microseconds begin_us, BusPort& bus) = 0;
  /// As JointController::arm(), for the motion of the set-up.
  [[nodiscard]] virtual controller::Fault arm() = 0;
  /// Whether it compensates from the next tick on for what is off nominal; its state and
  /// what was learnt stay.
  virtual void set_accommodation(bool on) = 0;
  [[nodiscard]] virtual hal::ControllerState state() const = 0;
  [[nodiscard]] virtual controller::Fault fault() const = 0;
  [[nodiscard]] virtual ControllerView view() const = 0;
  [[nodiscard]] virtual ControllerTotals totals() const = 0;
};

struct SteppedSetup {
  const RobotDescription& robot;
  ControllerSettings settings;
  hal::DriveLink link{};
  MotionAt motion;
};

/// For a robot of 1 to kMaxJoints joints. Firmware computes in floats. Throws InputError where the
/// controller refuses the robot.
[[nodiscard]] std::unique_ptr<SteppedController> make_stepped_controller(const SteppedSetup& setup,
                                                                         Precision precision);

}  // namespace offnominal::desk
