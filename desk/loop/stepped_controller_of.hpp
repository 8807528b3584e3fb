// Body of a SteppedController; a source file for each space includes it.
#pragma once

#include <cmath>
#include <memory>
#include <offnominal/controller/joint_controller.hpp>
#include <type_traits>

#include "drives/drive_port.hpp"
#include "loop/stepped_controller.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk {

template <typename Scalar, typename Space>
class SteppedControllerOf final : public SteppedController {
 public:
  using Controller = controller::JointController<kRuntimeJoints, kMaxHiddenUnits, Scalar,
                                                 WithMemory, Space, IsolationIn<Space>>;
  explicit SteppedControllerOf(const SteppedSetup& setup)
      : robot_(setup.robot),
        settings_(setup.settings),
        motion_(setup.motion),
        drives_(
            make_drive_port(setup.robot.drive_settings(), setup.robot.joints.size(), setup.link)) {
    create_controller(setup.robot, setup.settings, controller_);
  }

  void step(hal::Microseconds begin_us, BusPort& bus) override {
    controller_.step(begin_us, 0, reference(), bus, *drives_, *data_);
  }
  [[nodiscard]] controller::Fault arm() override { return controller_.arm(reference(), *data_); }
  void set_accommodation(bool on) override {
    settings_.accommodate = on;
    // The immutable part alone; data_ is what it has come to.
    create_controller(robot_, settings_, controller_);
  }
  [[nodiscard]] hal::ControllerState state() const override { return data_->state; }
  [[nodiscard]] controller::Fault fault() const override { return data_->fault; }

  [[nodiscard]] ControllerView view() const override {
    const auto doubles = [](const Vector<kRuntimeJoints, Scalar>& values) -> sim::JointVector {
      return values.template cast<double>();
    };
    ControllerView view;
    view.run_ticks = data_->run_ticks;
    view.fresh = data_->fresh && !controller_.is_settling(*data_);
    view.drives_follow = data_->drives_follow;
    const JointSample<kRuntimeJoints, Scalar>& judged = data_->judged();
    view.seen = {doubles(judged.q), doubles(judged.dq)};
    view.tau = doubles(judged.tau);
    view.psi_hat = doubles(data_->output.psi_hat);
    view.compensation = doubles(controller_.acting_compensation(*data_));
    view.error_norm = static_cast<double>(data_->output.error_norm);
    view.threshold = static_cast<double>(data_->output.threshold);
    view.weight_norm =
        std::sqrt(static_cast<double>(squared_norm(data_->monitor.estimator.weights)));
    view.detected = data_->output.detector.latched;
    view.acts = data_->output.detector.acts;
    view.slows = data_->slows;
    view.behind_s = controller_.pace(*data_).behind_s;
    view.motion_time_s =
        static_cast<double>(data_->run_ticks) * robot_.estimator.period_s - view.behind_s;
    if constexpr (std::is_same_v<Space, TorqueSpace>) {
      view.error = doubles(data_->output.error);
      view.thresholds = doubles(data_->output.thresholds);
      if (controller_.monitor().config().bound.fast.alpha > 0) {
        view.fast_error = doubles(data_->output.fast_error);
        view.fast_thresholds = doubles(data_->output.fast_thresholds);
      }
      if (view.detected) view.first_joint = data_->output.detector.first_joint;
      const FaultDiagnosis<Scalar>& found = data_->isolation.diagnosis;
      if (data_->isolation.triggered && found.time_s > 0) {
        view.isolated = isolated_fault_of(found, joint_types(robot_),
                                          data_->output.detector.detection_time_s, found.time_s);
      }
    }
    return view;
  }

  [[nodiscard]] ControllerTotals totals() const override {
    ControllerTotals totals;
    totals.overruns = data_->overruns;
    totals.missed_samples = data_->missed_samples;
    totals.counts = drives_->counts();
    return totals;
  }

 private:
  [[nodiscard]] auto reference() const {
    return [this](double time_s) { return reference_of<Scalar>(motion_(time_s)); };
  }

  RobotDescription robot_;
  ControllerSettings settings_;
  MotionAt motion_;
  std::unique_ptr<DrivePort> drives_;
  Controller controller_;
  // On the heap: 128 hidden units do not belong on a stack.
  std::unique_ptr<typename Controller::Data> data_ = std::make_unique<typename Controller::Data>();
};

template <typename Space>
[[nodiscard]] std::unique_ptr<SteppedController> stepped_controller_in(const SteppedSetup& setup,
                                                                       Precision precision) {
  if (precision == Precision::kFloat) {
    return std::make_unique<SteppedControllerOf<float, Space>>(setup);
  }
  return std::make_unique<SteppedControllerOf<double, Space>>(setup);
}

}  // namespace offnominal::desk
