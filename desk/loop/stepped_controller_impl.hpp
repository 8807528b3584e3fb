// Body of make_stepped_controller_of(); included only where it is instantiated.
#pragma once

#include <cmath>
#include <cstddef>
#include <memory>
#include <offnominal/controller/joint_controller.hpp>

#include "loop/drive_port.hpp"
#include "loop/stepped_controller.hpp"

namespace offnominal::desk::detail {

template <int N, typename Scalar>
class SteppedControllerOf final : public SteppedController {
 public:
  using Controller = controller::JointController<N, kControllerCapacity, Scalar, WithMemory>;
  explicit SteppedControllerOf(const SteppedSetup& setup)
      : motion_(setup.motion),
        drives_(make_drive_port<static_cast<std::size_t>(N)>(setup.robot.drive_settings(),
                                                             setup.link)) {
    create_controller(setup.robot, setup.settings, controller_);
  }

  void step(hal::Microseconds begin_us, BusPort& bus) override {
    controller_.step(begin_us, 0, reference(), bus, *drives_, *data_);
  }
  [[nodiscard]] controller::Fault arm() override { return controller_.arm(reference(), *data_); }
  [[nodiscard]] hal::ControllerState state() const override { return data_->state; }
  [[nodiscard]] controller::Fault fault() const override { return data_->fault; }

  [[nodiscard]] ControllerView view() const override {
    const auto doubles = [](const Vector<N, Scalar>& values) -> sim::JointVector {
      return values.template cast<double>();
    };
    ControllerView view;
    view.run_ticks = data_->run_ticks;
    view.fresh = data_->fresh;
    view.drives_follow = data_->drives_follow;
    view.seen = {doubles(data_->sample.q), doubles(data_->sample.dq)};
    view.tau = doubles(data_->sample.tau);
    view.psi_hat = doubles(data_->output.psi_hat);
    view.error_norm = static_cast<double>(data_->output.error_norm);
    view.threshold = static_cast<double>(data_->output.threshold);
    view.weight_norm =
        std::sqrt(static_cast<double>(squared_norm(data_->monitor.estimator.weights)));
    view.detected = data_->output.detector.latched;
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
    return [this](double time_s) { return reference_of<N, Scalar>(motion_(time_s)); };
  }

  MotionAt motion_;
  std::unique_ptr<DrivePort<static_cast<std::size_t>(N)>> drives_;
  Controller controller_;
  // On the heap: 128 hidden units do not belong on a stack.
  std::unique_ptr<typename Controller::Data> data_ = std::make_unique<typename Controller::Data>();
};

template <int N, typename Scalar>
std::unique_ptr<SteppedController> make_stepped_controller_of(const SteppedSetup& setup) {
  return std::make_unique<SteppedControllerOf<N, Scalar>>(setup);
}

}  // namespace offnominal::desk::detail
