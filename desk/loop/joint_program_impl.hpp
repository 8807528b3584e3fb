// Body of make_program_of(); included only where it is instantiated.
#pragma once

#include <algorithm>
#include <array>
#include <memory>
#include <offnominal/hal/bus/in_process_bus.hpp>
#include <offnominal/realtime/recorded_bus.hpp>
#include <optional>

#include "common/error.hpp"
#include "drives/drive_table.hpp"
#include "loop/drive_port.hpp"
#include "loop/joint_program.hpp"

namespace offnominal::desk::detail {

// Healthy drives at the other end of an in-process bus, whose ticks take no time.
template <int N>
class RehearsalTimer final : public TickTimer {
 public:
  using Net = hal::InProcessNet<2>;
  using Positions = Vector<N, float>;
  // Ends what is not over by itself.
  RehearsalTimer(Net& net, realtime::LoopPanel& panel, realtime::Microseconds period_us,
                 std::unique_ptr<sim::Drives> drives, const Positions& positions)
      : net_(net),
        panel_(panel),
        port_(net.port(1)),
        period_us_(period_us),
        positions_(positions),
        drives_(std::move(drives)) {}
  realtime::Tick wait() override {
    constexpr int kMostTicks = 1000;
    if (++ticks_ == kMostTicks) panel_.end.store(true);
    now_us_ += period_us_;
    net_.set_time(now_us_);
    std::array<hal::ReceivedFrame, 2 * kJoints> come;
    const std::size_t count = port_.receive(come);
    for (std::size_t i = 0; i < count; ++i) drives_->take(come[i]);
    drives_->tick(now_us_);
    std::array<std::optional<hal::EncoderReading>, kJoints> readings;
    for (std::size_t j = 0; j < kJoints; ++j) {
      readings[j] = hal::EncoderReading{positions_[static_cast<Eigen::Index>(j)], 0, true};
    }
    std::array<hal::Frame, sim::Drives::kMostFrames> frames;
    const std::size_t made = drives_->frames(readings, std::array<double, kJoints>{}, frames);
    for (std::size_t i = 0; i < made; ++i) static_cast<void>(port_.send(frames[i], now_us_));
    return {now_us_, 0, 0};
  }
  [[nodiscard]] realtime::Microseconds period_us() const override { return period_us_; }

 private:
  static constexpr auto kJoints = static_cast<std::size_t>(N);
  Net& net_;
  realtime::LoopPanel& panel_;
  Net::Port port_;
  realtime::Microseconds period_us_;
  Positions positions_;
  std::unique_ptr<sim::Drives> drives_;
  realtime::Microseconds now_us_ = 0;
  int ticks_ = 0;
};

template <int N>
class JointProgramOf final : public JointProgram {
 public:
  using Scalar = float;
  using Controller = controller::JointController<N, kControllerCapacity, Scalar, WithMemory>;
  using Drives = DrivePort<static_cast<std::size_t>(N)>;

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
  }

  [[nodiscard]] const JointProgramReport& report() const override { return report_; }

 private:
  using Bus = realtime::RecordedBus<BusPort>;
  using Data = typename Controller::Data;

  [[nodiscard]] std::unique_ptr<Drives> make_drives() const {
    return make_drive_port<static_cast<std::size_t>(N)>(drive_settings_, link_);
  }

  template <typename ReferenceAt>
  using Loop =
      realtime::ControlLoop<N, kControllerCapacity, Scalar, Bus, Drives, TickTimer, ReferenceAt>;

  // Joints at rest, where they can be and a frame can say it, away from the ends that its counts
  // may round to. At 0 where that is such a place.
  [[nodiscard]] Vector<N, float> a_position() const {
    constexpr double kCarried = 32;
    constexpr double kMargin = 1e-3;
    Vector<N, float> position;
    for (int i = 0; i < N; ++i) {
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
    const std::unique_ptr<Drives> drives = make_drives();
    realtime::LoopPanel panel;
    RehearsalTimer<N> timer(
        *net, panel, link_.period_us,
        emulated_drives(drive_settings_, {.joints = static_cast<std::size_t>(N), .link = link_}),
        a_position());
    // Wherever the motion is, these joints are asked to stay.
    const auto reference_at = [&](double time_s) {
      Reference<N, Scalar> wanted = reference(time_s, *data);
      wanted = {};
      wanted.q = data->sample.q;
      return wanted;
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

  Reference<N, Scalar> reference(double time_s, const Data& data) {
    if (setup_.motion) return reference_of<N, Scalar>(setup_.motion(time_s));
    Reference<N, Scalar> wanted;
    if (data.state != hal::ControllerState::kArmed) held_ = data.sample.q;
    wanted.q = held_;
    return wanted;
  }

  JointProgramSetup setup_;
  hal::DriveLink link_;
  DriveSettings drive_settings_;
  std::unique_ptr<Drives> drives_;
  Bus bus_;
  Controller controller_;
  // On the heap: 128 hidden units do not belong on a stack.
  std::unique_ptr<typename Controller::Data> data_ = std::make_unique<typename Controller::Data>();
  Vector<N, Scalar> held_ = Vector<N, Scalar>::Zero();
  JointProgramReport report_;
};

template <int N>
std::unique_ptr<JointProgram> make_program_of(const JointProgramSetup& setup) {
  return std::make_unique<JointProgramOf<N>>(setup);
}

}  // namespace offnominal::desk::detail
