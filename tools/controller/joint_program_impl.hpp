// Body of make_program_of(); included only where it is instantiated.
#pragma once

#include <offnominal/realtime/recorded_bus.hpp>

#include "controller/joint_program.hpp"
#include "offnominal/sim/trajectory.hpp"

namespace offnominal::tools::detail {

// Fewer hidden units are exactly a smaller network.
inline constexpr int kControllerCapacity = 128;

template <int N>
class JointProgramOf final : public JointProgram {
 public:
  using Scalar = float;
  using Controller = controller::JointController<N, kControllerCapacity, Scalar>;
  using Drives = hal::ProtectedDrives<static_cast<std::size_t>(N)>;

  explicit JointProgramOf(const JointProgramSetup& setup)
      : setup_(setup),
        source_(sil::source_config(setup.timer.period_us())),
        drives_(source_, source_, setup.format),
        bus_(setup.bus, setup.recorder) {
    sil::create_controller(setup.robot, setup.settings, controller_);
  }

  void run() override {
    report_.grant = realtime::ask_for(setup_.wish);
    const auto reference_at = [this](Scalar time_s) { return reference(time_s); };
    using Loop =
        realtime::ControlLoop<N, kControllerCapacity, Scalar, realtime::RecordedBus<sil::BusPort>,
                              Drives, TickTimer, decltype(reference_at)>;
    Loop loop(setup_.loop, {controller_, setup_.timer, bus_, drives_, reference_at, setup_.recorder,
                            setup_.panel, *data_});
    report_.loop = loop.run();
    for (std::size_t j = 0; j < static_cast<std::size_t>(N); ++j) {
      for (const hal::Source* source : {&drives_.encoder_source(j), &drives_.drive_source(j)}) {
        report_.lost += source->lost;
        report_.rejected += std::uint64_t{source->rejected} + source->repeated;
      }
    }
  }

  [[nodiscard]] const JointProgramReport& report() const override { return report_; }

 private:
  Reference<N, Scalar> reference(Scalar time_s) {
    Reference<N, Scalar> wanted;
    const auto time = static_cast<double>(time_s);
    if (setup_.reference.motion) {
      for (int i = 0; i < N; ++i) {
        const paper::RecordedMotion::Joint joint = setup_.reference.motion->at(time, i);
        wanted.q[i] = static_cast<Scalar>(joint.q);
        wanted.dq[i] = static_cast<Scalar>(joint.dq);
        wanted.ddq[i] = static_cast<Scalar>(joint.ddq);
      }
      return wanted;
    }
    if constexpr (N == 2) {
      if (setup_.reference.paper) {
        const sim::DesiredMotion desired = sim::paper_trajectory(time);
        return {desired.q.template cast<Scalar>(), desired.dq.template cast<Scalar>(),
                desired.ddq.template cast<Scalar>()};
      }
    }
    if (time_s == 0) held_ = data_->sample.q;
    wanted.q = held_;
    return wanted;
  }

  JointProgramSetup setup_;
  hal::SourceConfig source_;
  Drives drives_;
  realtime::RecordedBus<sil::BusPort> bus_;
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

}  // namespace offnominal::tools::detail
