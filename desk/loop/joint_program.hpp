// The controller program's loop, for any number of joints behind one face.
#pragma once

#include <cstdint>
#include <memory>
#include <offnominal/hal/drive_description.hpp>
#include <offnominal/hal/drive_protocol.hpp>
#include <offnominal/realtime/control_loop.hpp>
#include <offnominal/realtime/privileges.hpp>
#include <optional>
#include <string>

#include "loop/bus_port.hpp"
#include "loop/controller_settings.hpp"
#include "loop/motion_at.hpp"
#include "robot/isolated_fault.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk {

/// What waits for the next tick.
class TickTimer {
 public:
  virtual ~TickTimer() = default;
  virtual realtime::Tick wait() = 0;
  [[nodiscard]] virtual realtime::Microseconds period_us() const = 0;
};

/// All that is referred to has to outlive the program.
struct JointProgramSetup {
  const RobotDescription& robot;
  ControllerSettings settings;
  hal::FrameFormat format = hal::FrameFormat::kClassic;
  realtime::LoopConfig loop;
  realtime::Wish wish;
  MotionAt motion;  // none: the joints stay where they are when the controller is armed
  BusPort& bus;
  TickTimer& timer;
  realtime::Recorder& recorder;
  realtime::LoopPanel& panel;
};

struct JointProgramReport {
  realtime::LoopReport loop;
  realtime::Grant grant;
  hal::DriveCounts counts;
  std::optional<IsolatedFault> isolated;  // the newest answer, of a robot that asks for one
};

class JointProgram {
 public:
  virtual ~JointProgram() = default;
  /// The loop from its first tick to its end, in the calling thread. Throws InputError, before the
  /// first tick, for a robot that the controller would never hear: a joint that cannot be where a
  /// frame can say.
  virtual void run() = 0;
  [[nodiscard]] virtual const JointProgramReport& report() const = 0;
};

/// For a robot of 1 to kMaxJoints joints. Throws InputError where the controller refuses the robot.
[[nodiscard]] std::unique_ptr<JointProgram> make_joint_program(const JointProgramSetup& setup);

}  // namespace offnominal::desk
