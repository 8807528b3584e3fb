#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <offnominal/control/computed_torque.hpp>
#include <offnominal/controller/controller_config.hpp>
#include <offnominal/hal/messages.hpp>
#include <offnominal/hal/protocols/can_simple/can_simple.hpp>
#include <offnominal/monitor.hpp>
#include <type_traits>

// What is no number is refused at every gate, whatever the flags say: compiled by check_flags.cmake
// with flags that let a compiler forget NaN and infinity. No test framework: these flags are wrong
// for anybody's code but that which is judged. Ends with 1 and a line per failure.

namespace {

using namespace offnominal;

constexpr int kJoints = 2;
constexpr int kHidden = 8;

int failures = 0;

void expect(bool good, const char* what) {
  if (good) return;
  std::printf("failed: %s\n", what);
  ++failures;
}

// Numbers that no compiler knows when it compiles.
template <typename Scalar>
std::array<Scalar, 3> no_numbers() {
  using Bits = std::conditional_t<sizeof(Scalar) == 4, std::uint32_t, std::uint64_t>;
  volatile int exponent_bits = sizeof(Scalar) == 4 ? 8 : 11;
  const int shift = static_cast<int>(8 * sizeof(Scalar)) - 1 - exponent_bits;
  const Bits infinity = ((Bits{1} << exponent_bits) - 1) << shift;
  const Bits sign = Bits{1} << (8 * sizeof(Scalar) - 1);
  return {std::bit_cast<Scalar>(infinity), std::bit_cast<Scalar>(infinity | sign),
          std::bit_cast<Scalar>(infinity | (Bits{1} << (shift - 1)))};
}

template <typename Scalar>
MonitorConfig<kJoints, Scalar> arm() {
  MonitorConfig<kJoints, Scalar> config;
  config.chain.gravity_m_s2 = {0, static_cast<Scalar>(-9.81), 0};
  for (Joint<Scalar>& joint : config.chain.joints) joint.centre_of_mass_m = {1, 0, 0};
  config.chain.joints[1].origin_m = {1, 0, 0};
  config.estimator.hidden_units = kHidden;
  config.max_compensation = {50, 50};
  return config;
}

// A run in the middle of which a sample holds what is no number, at every place.
template <typename Scalar>
void samples() {
  using Watch = Monitor<kJoints, kHidden, Scalar>;
  Watch monitor;
  typename Watch::State state;
  typename Watch::Output output;
  expect(Watch::create(arm<Scalar>(), monitor) == Status::kOk, "create()");
  // At rest, held against its weight.
  JointSample<kJoints, Scalar> sample;
  sample.tau = bias_torque<kJoints, Scalar>(monitor.model(), sample.q, sample.dq, Scalar(0));
  expect(monitor.reset(sample, state) == Status::kOk, "reset()");
  for (const Scalar bad : no_numbers<Scalar>()) {
    for (Eigen::Index joint = 0; joint < kJoints; ++joint) {
      auto spoilt = sample;
      spoilt.q[joint] = bad;
      expect(monitor.step(spoilt, state, output) == Status::kNonFinitePosition, "position");
      spoilt = sample;
      spoilt.dq[joint] = bad;
      expect(monitor.step(spoilt, state, output) == Status::kNonFiniteVelocity, "velocity");
      expect(monitor.reset(spoilt, state) == Status::kNonFiniteVelocity, "velocity at the start");
      expect(monitor.resume(spoilt, 3, state) == Status::kNonFiniteVelocity, "after a gap");
      spoilt = sample;
      spoilt.tau[joint] = bad;
      expect(monitor.step(spoilt, state, output) == Status::kNonFiniteTorque, "torque");
    }
  }
  expect(state.tick == 0, "no sample of these counts");
  // What overflows inside the tick.
  auto huge = sample;
  huge.tau[0] = std::numeric_limits<Scalar>::max() / 2;
  expect(monitor.step(huge, state, output) != Status::kOk, "a torque whose square is infinite");
  // Learning and detection go on.
  auto pushed = sample;
  for (int tick = 0; tick < 10; ++tick) {
    expect(monitor.step(pushed, state, output) == Status::kOk, "a healthy tick");
  }
  expect(!output.detector.latched, "healthy");
  pushed.tau[0] += Scalar(20);
  for (int tick = 0; tick < 2000; ++tick) {
    expect(monitor.step(pushed, state, output) == Status::kOk, "a tick with a fault");
  }
  expect(output.detector.latched && output.detector.level, "the fault is latched");
  const Scalar most = std::fabs(output.compensation.torque[0]);
  expect(most > Scalar(1) && most <= Scalar(50), "the fault is compensated");
  for (const Scalar bad : no_numbers<Scalar>()) {
    auto spoilt = pushed;
    spoilt.dq[0] = bad;
    expect(monitor.step(spoilt, state, output) == Status::kNonFiniteVelocity, "while it learns");
  }
  expect(all_finite(output.compensation.torque) && all_finite(output.psi_hat), "all finite");
}

template <typename Scalar>
void configurations() {
  using Config = MonitorConfig<kJoints, Scalar>;
  const auto check = [](const Config& config) { return validate<kHidden>(config); };
  expect(check(arm<Scalar>()) == Status::kOk, "a good configuration");
  const auto spoil = [&](const char* what, Scalar& (*field)(Config&)) {
    for (const Scalar bad : no_numbers<Scalar>()) {
      Config spoilt = arm<Scalar>();
      field(spoilt) = bad;
      expect(check(spoilt) != Status::kOk, what);
    }
  };
  spoil("mass", [](Config& c) -> Scalar& { return c.chain.joints[0].mass_kg; });
  spoil("axis", [](Config& c) -> Scalar& { return c.chain.joints[0].axis[2]; });
  spoil("rotation", [](Config& c) -> Scalar& { return c.chain.joints[1].rotation[4]; });
  spoil("origin", [](Config& c) -> Scalar& { return c.chain.joints[1].origin_m[0]; });
  spoil("centre", [](Config& c) -> Scalar& { return c.chain.joints[1].centre_of_mass_m[1]; });
  spoil("inertia", [](Config& c) -> Scalar& { return c.chain.joints[1].inertia_kg_m2[0]; });
  spoil("gravity", [](Config& c) -> Scalar& { return c.chain.gravity_m_s2[1]; });
  spoil("period", [](Config& c) -> Scalar& { return c.estimator.period_s; });
  spoil("alpha", [](Config& c) -> Scalar& { return c.estimator.alpha; });
  spoil("learning rate", [](Config& c) -> Scalar& { return c.estimator.learning_rate; });
  spoil("radius", [](Config& c) -> Scalar& { return c.estimator.weight_radius; });
  spoil("range", [](Config& c) -> Scalar& { return c.estimator.initial_weight_range; });
  spoil("bound", [](Config& c) -> Scalar& { return c.bound.offset; });
  spoil("velocity error", [](Config& c) -> Scalar& { return c.bound.velocity_error; });
  // No limit is a limit.
  const Scalar nan = no_numbers<Scalar>()[2];
  Config config = arm<Scalar>();
  config.max_compensation[1] = nan;
  expect(check(config) == Status::kInvalidLimit, "limit of the compensation");
  for (Scalar Joint<Scalar>::*limit : {&Joint<Scalar>::min_position, &Joint<Scalar>::max_position,
                                       &Joint<Scalar>::max_velocity, &Joint<Scalar>::max_torque}) {
    config = arm<Scalar>();
    config.chain.joints[1].*limit = nan;
    expect(check(config) == Status::kInvalidLimit, "limit of a joint");
  }
  for (const Scalar bad : no_numbers<Scalar>()) {
    config = arm<Scalar>();
    const Effect<Scalar> effect{EffectKind::kCoulombFriction, 1, {bad, Scalar(0.1)}};
    expect(config.chain.effects.add(effect) && check(config) == Status::kInvalidEffect, "effect");
    ComputedTorqueGains<kJoints, Scalar> gains;
    gains.kd[1] = bad;
    expect(validate(gains) == Status::kInvalidGain, "gain");
    VelocityObserverConfig<Scalar> observer;
    observer.bandwidth_rad_s = bad;
    expect(validate(observer) == Status::kInvalidFilterPole, "bandwidth");
    observer = {};
    VelocityObserverState<Scalar> velocity;
    expect(update(observer, bad, velocity) == Status::kNonFinitePosition, "observed position");
    auto watched = controller::controller_config<kJoints, Scalar>(arm<Scalar>(), {});
    watched.monitor.estimator.period_s = bad;
    expect(validate(watched) != Status::kOk, "period of the controller");
  }
}

// What goes out over the bus, and what comes in.
void frames() {
  hal::Record record{};
  hal::CanSimpleDrives<1> drives({}, {hal::CanSimpleAxis{}});
  for (const float bad : no_numbers<float>()) {
    const hal::TorqueCommand command{hal::DriveMode::kTorque, bad};
    expect(encode(command, 0, 1, record) == hal::Status::kInvalidValue, "command");
    const hal::DriveStatus status{hal::DriveMode::kTorque, 0, bad};
    expect(encode(status, 0, 1, record) == hal::Status::kInvalidValue, "drive's torque");
    const hal::EncoderReading reading{bad, 0.0F, false};
    expect(encode(reading, 0, 1, record) == hal::Status::kInvalidValue, "position");
    hal::ReceivedFrame received;
    received.frame.id = 0x09;
    received.frame.length = 8;
    const auto word = std::bit_cast<std::uint32_t>(bad);
    for (unsigned i = 0; i < 4; ++i) {
      received.frame.data[i] = static_cast<std::uint8_t>(word >> (8 * i));
    }
    expect(drives.take(received) == hal::Status::kInvalidValue, "CAN Simple's position");
  }
}

// Sums keep their order.
void arithmetic() {
  expect(std::fabs(sine_cosine(10.3).sine - -0.76768581) < 1e-7, "sine");
  expect(std::fabs(sine_cosine(10.3F).sine - -0.76768581F) < 1e-6F, "sine in float");
  expect(std::fabs(exponential(-1.3) - 0.27253179) < 1e-7, "exponential");
  expect(std::fabs(exponential(-1.3F) - 0.27253179F) < 1e-6F, "exponential in float");
  const Eigen::Array<double, 8, 1> sigma =
      sigmoid(Eigen::Array<double, 8, 1>::Constant(1.3).eval());
  expect(std::fabs(sigma[7] - 0.57166997) < 1e-7, "sigmoid");
}

}  // namespace

int main() {
  samples<float>();
  samples<double>();
  configurations<float>();
  configurations<double>();
  frames();
  arithmetic();
  return failures == 0 ? 0 : 1;
}
