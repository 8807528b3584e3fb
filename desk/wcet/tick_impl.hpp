#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <offnominal/controller/joint_controller.hpp>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>

#include "loop/controller_settings.hpp"
#include "wcet/tick.hpp"
#include "wcet/tick_bus.hpp"

// Body of a Tick; CMakeLists.txt makes a source file for each size that is compiled in.

namespace offnominal::desk::wcet {

template <int N, int L, typename Scalar, typename Space>
class TickOf final : public Tick {
 public:
  using Controller = controller::JointController<N, L, Scalar, WithMemory, Space>;
  using Data = typename Controller::Data;
  using Drives = MarkedDrives<static_cast<std::size_t>(N)>;

  TickOf(const RobotDescription& robot, hal::FrameFormat format)
      : format_(format),
        used_units_(robot.estimator.hidden_units),
        period_us_(period_us_of(robot.estimator.period_s)) {
    ControllerSettings settings;
    settings.accommodate = true;
    create_controller(ready_to_arm(robot), settings, work_.controller);
  }

  void prepare(const TickInput& input) override {
    arm(input);
    make_monitor_state(input);
    next_frames(input);
    for (int i = 0; i < input.foreign_frames; ++i) {
      frames_.push_back(frames_[static_cast<std::size_t>(i) % own_frames_]);
    }
    work_.bus.set_frames(frames_);
    prepared_data_ = work_.data;
    prepared_drives_ = work_.drives;
  }

  void restore() override {
    work_.data = prepared_data_;
    work_.drives = prepared_drives_;
    work_.bus.rewind();
  }

  void run() override {
    work_.controller.step(
        now_us_, 0,
        [this](double /*time_s*/) {
          marks_.end_of(Phase::kDiagnose);
          return reference_;
        },
        work_.bus, work_.drives, work_.data);
  }

  void run_phases(std::array<std::int64_t, kPhases>& duration_ns) override {
    marks_.start();
    run();
    marks_.stop(duration_ns);
  }

  void run_part(Part part) override {
    const auto& monitor = work_.controller.monitor();
    const auto& config = monitor.config();
    const double end_s = static_cast<double>(work_.data.monitor.tick + 1) *
                         static_cast<double>(config.estimator.period_s);
    if (part == Part::kModel) {
      static_cast<void>(Form::look(monitor.model(), joint_transforms(monitor.model(), sample_.q),
                                   sample_.q, sample_.dq, sample_.tau, end_s, nominal_));
      return;
    }
    State& estimator = work_.data.monitor.estimator;
    const EstimatorInput<N, Scalar, Space> at_end{
        network_input<N, Scalar>(sample_.q, sample_.dq, sample_.tau), estimator.nominal_rate,
        estimator.mu_bar, estimator.measured};
    static_cast<void>(offnominal::step(config.estimator, at_end, estimator));
  }

  TickFacts facts() override {
    restore();
    const State before = work_.data.monitor.estimator;
    run();
    const State& after = work_.data.monitor.estimator;
    const Scalar radius = work_.controller.monitor().config().estimator.weight_radius;
    TickFacts facts;
    facts.watched = work_.data.fresh && work_.data.state == hal::ControllerState::kArmed;
    facts.learned =
        (after.weights.w1.array() != before.weights.w1.array()).any() ||
        (after.weights.w2_transposed.array() != before.weights.w2_transposed.array()).any();
    // Shrinking leaves theta below M by the rounding allowance.
    facts.began_on_ball =
        before.theta_squared_norm +
            4 * offnominal::detail::rounding_allowance<L, Scalar>(before.theta_squared_norm) >=
        radius * radius;
    facts.gradient_outwards = outward_gradient(before) > 0;
    facts.error_to_threshold = static_cast<double>(error_to_threshold(before));
    facts.weight_norm = static_cast<double>(std::sqrt(after.theta_squared_norm));
    facts.weight_radius = static_cast<double>(radius);
    facts.smallest_sigmoid = static_cast<double>(before.sigma.head(used_units_).abs().minCoeff());
    facts.share_subnormal = subnormal_share(before);
    facts.q = values_of(work_.data.sample.q);
    facts.dq = values_of(work_.data.sample.dq);
    facts.tau = values_of(work_.data.sample.tau);
    facts.frames = work_.bus.handed_out();
    return facts;
  }

  [[nodiscard]] std::span<const std::byte> memory() const override {
    return std::as_bytes(std::span(&work_, 1));
  }
  [[nodiscard]] int hidden_capacity() const override { return kHiddenRows<L, Scalar>; }

 private:
  static constexpr bool kByJoint = std::is_same_v<Space, TorqueSpace>;
  using Form = MonitorForm<Space, N, Scalar>;
  using State = EstimatorState<N, L, Scalar, Space>;

  // What a tick touches, in one piece.
  struct Work {
    Work(const hal::SourceConfig& source, hal::FrameFormat format, PhaseMarks& marks)
        : drives(source, format, marks) {}
    Controller controller;
    Data data;
    Drives drives;
    ReadyBus bus;
  };

  // What is measured is a tick, whether the arm should be armed so or not.
  static RobotDescription ready_to_arm(RobotDescription robot) {
    constexpr double kMostTorque = 1e30;
    for (RobotJoint& joint : robot.joints) {
      if (joint.kp == 0) joint.kp = 1;
      if (joint.kd == 0) joint.kd = 1;
      joint.joint.max_torque = std::min(joint.joint.max_torque, kMostTorque);
    }
    robot.arming.speed.assign(robot.joints.size(), kMaxFrameVelocity + 1);
    return robot;
  }
  static void require(Status status) {
    if (status != Status::kOk) throw std::runtime_error(name_of(status));
  }
  static std::vector<double> values_of(const Vector<N, Scalar>& v) {
    std::vector<double> values;
    for (const Scalar x : v) values.push_back(static_cast<double>(x));
    return values;
  }
  [[nodiscard]] double subnormal_share(const State& state) const {
    int count = 0;
    for (int unit = 0; unit < used_units_; ++unit) {
      for (int joint = 0; joint < N; ++joint) {
        count += std::fpclassify(state.weights.w2_transposed(unit, joint)) == FP_SUBNORMAL ? 1 : 0;
      }
    }
    return static_cast<double>(count) / (used_units_ * N);
  }
  // |e| / mu; of several thresholds, of the joint that is nearest to its own.
  static Scalar error_to_threshold(const State& state) {
    if constexpr (kByJoint) {
      return (state.error.array().abs() / state.mu.array()).maxCoeff();
    } else {
      return state.error.norm() / state.mu;
    }
  }
  // Of what is learnt: the direction of D[e].
  static Vector<N, Scalar> learnt_from(const State& state) {
    if constexpr (kByJoint) {
      const auto e = state.error.array();
      return (e.abs() > state.mu.array())
          .select(e - e.sign() * state.mu.array(), Scalar(0))
          .matrix();
    } else {
      return state.error;
    }
  }
  // <theta, g> of the learning law's gradient g for the error's direction: above 0 learning would
  // lengthen theta.
  static double outward_gradient(const State& state) {
    const Vector<N, Scalar> learnt = learnt_from(state);
    const HiddenVector<L, Scalar> back = state.weights.w2_transposed.lazyProduct(learnt).array();
    const HiddenVector<L, Scalar> slope = Scalar(0.5) * (Scalar(1) - state.sigma.square());
    return static_cast<double>((back * slope * state.w1_z).sum() + learnt.dot(state.psi_hat));
  }

  // The sample's frames, one tick later than the last ones; sample_ is what they carry.
  void next_frames(const TickInput& input) {
    now_us_ += period_us_;
    ++counter_;
    constexpr auto kJoints = static_cast<std::size_t>(N);
    std::array<hal::Record, kJoints> readings{};
    std::array<hal::Record, kJoints> statuses{};
    for (std::size_t j = 0; j < kJoints; ++j) {
      const auto node = static_cast<std::uint8_t>(j);
      const hal::EncoderReading reading{static_cast<float>(input.q[j]),
                                        static_cast<float>(input.dq[j]), true};
      const hal::DriveStatus status{hal::DriveMode::kTorque, 0, static_cast<float>(input.tau[j])};
      const std::uint16_t id = hal::data_id_of(hal::MessageKind::kEncoder, node);
      const std::uint16_t drive_id = hal::data_id_of(hal::MessageKind::kDriveStatus, node);
      const bool carried = encode(reading, counter_, id, readings[j]) == hal::Status::kOk &&
                           encode(status, counter_, drive_id, statuses[j]) == hal::Status::kOk;
      if (!carried) throw std::runtime_error("a sample that frames cannot carry");
      std::uint8_t count = 0;
      hal::EncoderReading seen;
      static_cast<void>(
          decode(std::span<const std::uint8_t, hal::kRecordLength>(readings[j]), id, seen, count));
      const auto i = static_cast<Eigen::Index>(j);
      sample_.q[i] = static_cast<Scalar>(seen.position);
      sample_.dq[i] = static_cast<Scalar>(seen.velocity);
      sample_.tau[i] = static_cast<Scalar>(status.applied_torque);
    }
    std::array<hal::Frame, 2 * kJoints> frames;
    std::size_t count = hal::pack(hal::MessageKind::kEncoder, readings, format_, frames);
    count += hal::pack(hal::MessageKind::kDriveStatus, statuses, format_,
                       std::span(frames).subspan(count));
    frames_.clear();
    for (std::size_t i = 0; i < count; ++i) frames_.push_back({frames[i], now_us_});
    own_frames_ = count;
  }

  // From the start to a controller that is armed and whose monitor runs.
  void arm(const TickInput& input) {
    work_.data = Data{};
    work_.drives = Drives(hal::source_config(period_us_), format_, marks_);
    constexpr int kTicksToStart = 12;
    const auto reference_at = [&](double /*time_s*/) { return reference_; };
    controller::Fault refusal = controller::Fault::kNone;
    for (int i = 0; i < kTicksToStart && refusal == controller::Fault::kNone; ++i) {
      next_frames(input);
      reference_ = {sample_.q, sample_.dq, Vector<N, Scalar>::Zero()};
      work_.bus.set_frames(frames_);
      run();
      if (i == kTicksToStart / 2) refusal = work_.controller.arm(reference_at, work_.data);
    }
    if (work_.data.state != hal::ControllerState::kArmed || !work_.data.monitor.initialised) {
      const bool refused = refusal != controller::Fault::kNone;
      throw std::runtime_error(std::string("the controller does not take this sample (") +
                               name_of(refused ? refusal : work_.data.fault) + ")");
    }
  }

  void make_monitor_state(const TickInput& input) {
    auto& monitor = work_.data.monitor;
    require(work_.controller.monitor().reset(sample_, monitor));
    monitor.tick = input.ticks;
    State& state = monitor.estimator;
    state.weights = weights_of(input, state.z);
    state.theta_squared_norm = squared_norm(state.weights);
    state.w1_z = state.weights.w1.lazyProduct(state.z).array();
    state.sigma = sigmoid(state.w1_z);
    state.psi_hat = state.weights.w2_transposed.transpose().lazyProduct(state.sigma.matrix());
    if constexpr (kByJoint) {
      state.mu.setConstant(static_cast<Scalar>(input.threshold));
    } else {
      state.mu = static_cast<Scalar>(input.threshold);
    }
    // Along psi_hat: such an error makes learning lengthen theta.
    const Scalar length = state.psi_hat.stableNorm();
    Vector<N, Scalar> direction = Vector<N, Scalar>::Constant(1 / std::sqrt(Scalar(N)));
    if (length > std::numeric_limits<Scalar>::min()) direction = state.psi_hat / length;
    if constexpr (kByJoint) direction /= direction.cwiseAbs().maxCoeff();
    const Vector<N, Scalar> measured =
        offnominal::detail::measured_at<N, Scalar, Space>(std::as_const(state));
    state.omega =
        measured - static_cast<Scalar>(input.error_to_threshold * input.threshold) * direction;
    state.error = measured - state.omega;
  }

  // Weights with the pattern of the start's, scaled as the input says.
  [[nodiscard]] NetworkWeights<N, L, Scalar> weights_of(const TickInput& input,
                                                        const NetworkInput<N, Scalar>& z) const {
    const EstimatorConfig<Scalar>& config = work_.controller.monitor().config().estimator;
    const int units = config.hidden_units;
    // Uniform in [-sqrt(3), sqrt(3)]: of root mean square 1.
    const auto pattern = initial_weights<N, L, Scalar>(config.seed, units, std::sqrt(Scalar(3)));
    NetworkWeights<N, L, Scalar> weights;
    weights.w1 = static_cast<Scalar>(input.input_weights) * pattern.w1;
    const auto inputs = static_cast<Scalar>(z.norm());
    const Scalar within =
        Scalar(0.7) * config.weight_radius * inputs / std::sqrt(static_cast<Scalar>(units));
    const Scalar pre = std::min(static_cast<Scalar>(input.pre_activation), within);
    for (Eigen::Index unit = 0; unit < units; ++unit) {
      const Scalar sign = pattern.w1(unit, 0) < 0 ? Scalar(-1) : Scalar(1);
      if (pre > 0) weights.w1.row(unit) = (sign * pre / (inputs * inputs)) * z.transpose();
      for (Eigen::Index joint = 0; joint < N; ++joint) {
        weights.w2_transposed(unit, joint) =
            static_cast<Scalar>(input.output_weights) * pattern.w1(unit, 1 + joint);
      }
    }
    const Scalar norm = std::sqrt(squared_norm(weights));
    // Below M by what a step leaves; that counts as on the ball.
    const Scalar most =
        config.weight_radius * (1 - offnominal::detail::rounding_allowance<L, Scalar>(Scalar(1)));
    const bool scaled = input.on_ball || norm > most;
    if (scaled) {
      weights.w1 *= most / norm;
      weights.w2_transposed *= most / norm;
    }
    return weights;
  }

  hal::FrameFormat format_;
  int used_units_;
  hal::Microseconds period_us_;
  hal::Microseconds now_us_ = 0;
  std::uint8_t counter_ = 0;
  PhaseMarks marks_;
  Reference<N, Scalar> reference_;
  JointSample<N, Scalar> sample_;
  typename Form::Dynamics nominal_;
  std::vector<hal::ReceivedFrame> frames_;
  std::size_t own_frames_ = 0;
  Work work_{hal::source_config(period_us_), format_, marks_};
  Data prepared_data_;
  Drives prepared_drives_ = work_.drives;
};

}  // namespace offnominal::desk::wcet
