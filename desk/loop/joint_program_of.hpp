// Body of a JointProgram; a source file for each space includes it.
#pragma once

#include <algorithm>
#include <array>
#include <memory>
#include <offnominal/hal/bus/in_process_bus.hpp>
#include <offnominal/realtime/recorded_bus.hpp>
#include <optional>
#include <span>

#include "common/error.hpp"
#include "drives/drive_port.hpp"
#include "drives/drive_table.hpp"
#include "loop/joint_program.hpp"
#include "loop/rehearsal_timer.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk {

template <typename Space>
class JointProgramOf final : public JointProgram {
 public:
  using Scalar = float;
  using Controller = controller::JointController<kRuntimeJoints, kMaxHiddenUnits, Scalar,
                                                 WithMemory, Space, IsolationIn<Space>>;

  explicit JointProgramOf(const JointProgramSetup& setup)
      : setup_(setup),
        link_{.period_us = setup.timer.period_us(), .format = setup.format},
        drive_settings_(setup.robot.drive_settings()),
        drives_(make_drives()),
        bus_(setup.bus, setup.recorder) {
    create_controller(setup.robot, setup.settings, controller_);
  }

  void run() override {
    report_.grant = realtime::ask_for(setup_.wish);
    rehearse();
    const auto reference_at = [this](double time_s) { return reference(time_s, *data_); };
    report_.loop = Loop<decltype(reference_at)>(
                       setup_.loop, {controller_, setup_.timer, bus_, *drives_, reference_at,
                                     setup_.recorder, setup_.panel, *data_})
                       .run();
    report_.counts = drives_->counts();
    const realtime::LoopReport& loop = report_.loop;
    if (loop.isolated.time_s > 0) {
      report_.isolated = isolated_fault_of(loop.isolated, joint_types(setup_.robot),
                                           loop.detection_time_s, loop.isolated.time_s);
    }
  }

  [[nodiscard]] const JointProgramReport& report() const override { return report_; }

 private:
  using Bus = realtime::RecordedBus<BusPort>;
  using Data = typename Controller::Data;
  using Joints = Vector<kRuntimeJoints, Scalar>;
  using Wanted = Reference<kRuntimeJoints, Scalar>;

  [[nodiscard]] std::unique_ptr<DrivePort> make_drives() const {
    return make_drive_port(drive_settings_, setup_.robot.joints.size(), link_);
  }

  template <typename ReferenceAt>
  using Loop = realtime::ControlLoop<kRuntimeJoints, kMaxHiddenUnits, Scalar, Bus, DrivePort,
                                     TickTimer, ReferenceAt, Space, IsolationIn<Space>>;

  // Joints at rest, where they can be and a frame can say it, away from the ends that its counts
  // may round to. At 0 where that is such a place.
  [[nodiscard]] Joints a_position() const {
    constexpr double kCarried = 32;
    constexpr double kMargin = 1e-3;
    Joints position(setup_.robot.joint_count());
    for (Eigen::Index i = 0; i < position.size(); ++i) {
      const auto& joint = setup_.robot.joints[static_cast<std::size_t>(i)].joint;
      const double lowest = std::clamp(joint.min_position, -kCarried, kCarried);
      const double highest = std::clamp(joint.max_position, -kCarried, kCarried);
      const bool at_zero = lowest < -kMargin && highest > kMargin;
      position[i] = static_cast<float>(at_zero ? 0.0 : (lowest + highest) / 2);
    }
    return position;
  }

  // Code that has not run before is slow: it is still to be paged in, where the machine is emulated
  // to be translated. The first ticks that count are to be on time.
  void rehearse() {
    const auto net = std::make_unique<hal::InProcessNet<2>>();
    const auto data = std::make_unique<Data>();
    BusPortOf<hal::InProcessNet<2>::Port> port(net->port(0));
    realtime::Recorder nobody;
    Bus bus(port, nobody);
    const std::unique_ptr<DrivePort> drives = make_drives();
    realtime::LoopPanel panel;
    RehearsalTimer timer(
        *net, panel, link_.period_us,
        emulated_drives(drive_settings_, {.joints = setup_.robot.joints.size(), .link = link_}),
        a_position());
    // Wherever the motion is, these joints are asked to stay.
    const auto reference_at = [&](double time_s) {
      static_cast<void>(reference(time_s, *data));
      return at_rest(data->sample.q);
    };
    constexpr int kTicks = 50;
    const realtime::LoopConfig config{.arm_when_passive = true,
                                      .duration_us = kTicks * timer.period_us()};
    const realtime::LoopReport report =
        Loop<decltype(reference_at)>(
            config, {controller_, timer, bus, *drives, reference_at, nobody, panel, *data})
            .run();
    if (report.state != hal::ControllerState::kInit) return;
    throw InputError({"robot " + setup_.robot.name, "joint limits",
                      "a joint whose positions no frame can say",
                      "a range within -32 to 32 rad or m",
                      "count the joint's positions from another place, in the encoder and here"});
  }

  Wanted reference(double time_s, const Data& data) {
    if (setup_.motion) return reference_of<Scalar>(setup_.motion(time_s));
    if (data.state != hal::ControllerState::kArmed) held_ = data.sample.q;
    return at_rest(held_);
  }
  static Wanted at_rest(const Joints& q) {
    const Joints zero = Joints::Zero(q.size());
    return {q, zero, zero};
  }

  JointProgramSetup setup_;
  hal::DriveLink link_;
  DriveSettings drive_settings_;
  std::unique_ptr<DrivePort> drives_;
  Bus bus_;
  Controller controller_;
  // On the heap: 128 hidden units do not belong on a stack.
  std::unique_ptr<Data> data_ = std::make_unique<Data>();
  Joints held_;
  JointProgramReport report_;
};

}  // namespace offnominal::desk
