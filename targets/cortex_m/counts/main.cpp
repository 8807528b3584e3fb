// Counts the instructions and the stack of one tick, under QEMU's -icount shift=0: there every
// instruction takes 1 ns and SysTick, at 25 MHz, counts one in 40. A tick repeated 40 times from
// the same memory, less 40 times putting the memory back, is therefore its number of instructions,
// to one. One line per scenario: name, whole tick, monitor alone, stack bytes.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <offnominal/controller/static_object.hpp>
#include <offnominal/cortex_m/semihosting.hpp>
#include <offnominal/cortex_m/systick.hpp>

#include "motion.hpp"
#include "rig.hpp"

extern "C" {
extern std::uint32_t firmware_stack_bottom;
}

namespace offnominal::cortex_m {
namespace {

constexpr std::uint32_t kRepetitions = 40;  // instructions per count
constexpr std::uint32_t kPaint = 0xDEADBEEF;

constinit controller::StaticObject<Controller> controller;
constinit controller::StaticObject<Memory> memory;
constinit controller::StaticObject<Memory> before;   // the tick that is measured
constinit controller::StaticObject<Memory> working;  // what is measured on
constinit Random random;

using Reference = offnominal::Reference<kJoints, Scalar>;
using Sample = JointSample<kJoints, Scalar>;

struct Counts {
  std::uint32_t tick = 0;     // instructions
  std::uint32_t monitor = 0;  // instructions
  std::uint32_t stack = 0;    // bytes
};

[[noreturn]] void give_up(const char* scenario, const char* reason) {
  print(scenario);
  print(": ");
  print(reason);
  print("\n");
  exit(1);
}

__attribute__((noinline)) void copy(const Memory& from, Memory& to) { to = from; }
void put_back() { copy(*before, *working); }

// Instructions of body() on the memory of `before`.
template <typename Body>
std::uint32_t instructions_of(const Body& body) {
  const std::uint32_t begin = systick_now();
  for (std::uint32_t i = 0; i < kRepetitions; ++i) {
    put_back();
    body();
  }
  const std::uint32_t both = counts_since(begin);
  const std::uint32_t again = systick_now();
  for (std::uint32_t i = 0; i < kRepetitions; ++i) put_back();
  return both - counts_since(again);
}

// Stack that body() uses, below this function's own.
template <typename Body>
__attribute__((noinline)) std::uint32_t stack_of(const Body& body) {
  std::uint32_t* top = nullptr;
  asm volatile("mov %0, sp" : "=r"(top));
  for (std::uint32_t* at = &firmware_stack_bottom; at < top; ++at) {
    *const_cast<volatile std::uint32_t*>(at) = kPaint;
  }
  body();
  const std::uint32_t* lowest = &firmware_stack_bottom;
  while (lowest < top && *const_cast<const volatile std::uint32_t*>(lowest) == kPaint) ++lowest;
  return static_cast<std::uint32_t>((top - lowest) * static_cast<std::ptrdiff_t>(sizeof(*top)));
}

void put_frames(const Sample& sample, std::uint8_t counter, Memory& into) {
  into.bus.begin(into.bus.now() + kPeriodUs);
  for (std::size_t j = 0; j < kCount; ++j) {
    const auto node = static_cast<std::uint8_t>(j);
    const auto i = static_cast<Eigen::Index>(j);
    const hal::EncoderReading reading{static_cast<float>(sample.q[i]),
                                      static_cast<float>(sample.dq[i]), true};
    const hal::DriveStatus status{hal::DriveMode::kTorque, 0, static_cast<float>(sample.tau[i])};
    hal::Record record{};
    using hal::MessageKind;
    if (encode(reading, counter, data_id_of(MessageKind::kEncoder, node), record) !=
        hal::Status::kOk) {
      give_up("frames", "a reading does not fit");
    }
    into.bus.put(frame_of(MessageKind::kEncoder, node, record));
    if (encode(status, counter, data_id_of(MessageKind::kDriveStatus, node), record) !=
        hal::Status::kOk) {
      give_up("frames", "a torque does not fit");
    }
    into.bus.put(frame_of(MessageKind::kDriveStatus, node, record));
  }
}

Counts counts_of(const Reference& reference) {
  Counts counts;
  counts.tick = instructions_of([&] { offnominal_tick(*controller, reference, *working); });
  put_back();
  offnominal_tick(*controller, reference, *working);
  const Sample decoded = working->data.sample;
  counts.monitor = instructions_of(
      [&] { static_cast<void>(offnominal_monitor(*controller, decoded, *working)); });
  put_back();
  counts.stack = stack_of([&] { offnominal_tick(*controller, reference, *working); });
  return counts;
}

void create(const char* scenario, Scalar weight_radius) {
  Controller::Config config = controller::controller_config(
      robot_model::kMonitorConfig<Scalar>, robot_model::kComputedTorqueGains<Scalar>,
      robot_model::kArmingConfig<Scalar>);
  // Whatever the first sample is, and the torque is in at once: the drives here give what the path
  // needs, not what they are told.
  config.arming.speed.fill(Scalar(1000));
  config.arming.torque_rate.fill(Scalar(1e9));
  // Also of a robot file that says nothing of its control.
  for (std::size_t j = 0; j < kCount; ++j) {
    Scalar& limit = config.monitor.chain.joints[j].max_torque;
    limit = std::min(limit, Scalar(1e6));
    if (config.gains.kp[j] <= 0) config.gains.kp[j] = 1;
    if (config.gains.kd[j] <= 0) config.gains.kd[j] = 1;
  }
  if (weight_radius > 0) config.monitor.estimator.weight_radius = weight_radius;
  for (std::size_t j = 0; j < kCount; ++j) {
    config.monitor.max_compensation[j] = config.monitor.chain.joints[j].max_torque;
  }
  if (Controller::create(config, controller.make()) != Status::kOk) give_up(scenario, "refused");
  memory.make();
}

void arm(const char* scenario, const Reference& reference) {
  const controller::Fault refusal =
      controller->arm([&](double /*time_s*/) { return reference; }, memory->data);
  if (refusal != controller::Fault::kNone) give_up(scenario, name_of(refusal));
}

// Ticks with the samples of `sample_at`, after so many that arm the controller. The counts of the
// longest of those from tick `from` on; a quick look at every tick finds it.
template <typename SampleAt>
Counts longest(const char* scenario, std::uint32_t from, std::uint32_t ticks,
               const SampleAt& sample_at) {
  constexpr std::uint32_t kArmed = 6;
  std::uint32_t most = 0;
  Counts counts;
  for (std::uint32_t tick = 0; tick < ticks + kArmed; ++tick) {
    const Sample sample = sample_at(tick);
    put_frames(sample, static_cast<std::uint8_t>(tick), *memory);
    const Reference reference{sample.q, sample.dq, {}};
    copy(*memory, *before);
    const std::uint32_t begin = systick_now();
    offnominal_tick(*controller, reference, *memory);
    const std::uint32_t taken = counts_since(begin);
    if (memory->data.fault != controller::Fault::kNone) {
      give_up(scenario, name_of(memory->data.fault));
    }
    if (tick == kArmed - 2) arm(scenario, reference);
    if (tick < from + kArmed || taken <= most) continue;
    most = taken;
    counts = counts_of(reference);
  }
  return counts;
}

void tell(const char* scenario, const Counts& counts) {
  print(scenario);
  for (const std::uint32_t number : {counts.tick, counts.monitor, counts.stack}) {
    print(",");
    print(std::uint64_t{number});
  }
  print("\n");
}

void raise(Counts& worst, const Counts& counts) {
  worst.tick = std::max(worst.tick, counts.tick);
  worst.monitor = std::max(worst.monitor, counts.monitor);
  worst.stack = std::max(worst.stack, counts.stack);
}

// The weights at any size that the ball allows.
void draw_weights(Memory& into) {
  auto& estimator = into.data.monitor.estimator;
  const Scalar radius = controller->monitor().config().estimator.weight_radius;
  const auto count =
      static_cast<Scalar>(estimator.weights.w1.size() + estimator.weights.w2_transposed.size());
  const Scalar most = Scalar(0.99) * radius / std::sqrt(count);
  for (Scalar& w : estimator.weights.w1.reshaped()) w = random.any_size(most);
  for (Scalar& w : estimator.weights.w2_transposed.reshaped()) w = random.any_size(most);
  estimator.theta_squared_norm = squared_norm(estimator.weights);
  estimator.w1_z = (estimator.weights.w1 * estimator.z).array();
  estimator.sigma = sigmoid(estimator.w1_z);
}

void run() {
  constexpr std::uint32_t kTicks = 200;
  constexpr Scalar kExtra = Scalar(0.1);
  start_systick_counter();

  before.make();
  working.make();
  create("healthy", Scalar(0));
  const auto path = [&](std::uint32_t tick) { return on_path(*controller, tick, Scalar(0)); };
  Counts worst = longest("healthy", 1, kTicks, path);
  tell("healthy", worst);
  if (memory->data.output.detector.latched) give_up("healthy", "detected a fault");

  create("adapting", Scalar(0));
  const auto pushed = [&](std::uint32_t tick) { return on_path(*controller, tick, kExtra); };
  Counts counts = longest("adapting", kTicks / 2, kTicks, pushed);
  tell("adapting", counts);
  raise(worst, counts);
  if (!memory->data.output.detector.level) give_up("adapting", "is not");

  // A ball that is hardly larger than the initial weights.
  const Scalar radius =
      Scalar(1.01) * std::sqrt(initial_squared_norm<kJoints, robot_model::kHiddenUnits, Scalar>(
                         robot_model::kEstimatorConfig<Scalar>.seed, robot_model::kHiddenUnits,
                         robot_model::kEstimatorConfig<Scalar>.initial_weight_range));
  create("projecting", radius);
  const auto harder = [&](std::uint32_t tick) { return on_path(*controller, tick, 5 * kExtra); };
  counts = longest("projecting", kTicks, 2 * kTicks, harder);
  tell("projecting", counts);
  raise(worst, counts);
  if (memory->data.monitor.estimator.theta_squared_norm < Scalar(0.999) * radius * radius) {
    give_up("projecting", "the weights have not reached the ball");
  }

  create("worst", Scalar(0));
  const auto any = [&](std::uint32_t tick) {
    if (tick > 10 && tick % 3 == 0) draw_weights(*memory);
    return anything(*controller, random);
  };
  counts = longest("worst", 1, 3 * kTicks, any);
  raise(worst, counts);
  tell("worst", worst);

  // The tick that starts the monitor: another path, without an estimator's step.
  create("arming", Scalar(0));
  constexpr std::uint32_t kArmingTick = 5;
  for (std::uint32_t tick = 0; tick <= kArmingTick; ++tick) {
    const Sample sample = path(tick);
    put_frames(sample, static_cast<std::uint8_t>(tick), *memory);
    const Reference reference{sample.q, sample.dq, {}};
    if (tick == kArmingTick) {
      copy(*memory, *before);
      put_back();
      counts.stack = stack_of([&] { offnominal_tick(*controller, reference, *working); });
      counts.tick = instructions_of([&] { offnominal_tick(*controller, reference, *working); });
      counts.monitor = 0;
      offnominal_tick(*controller, reference, *memory);
      if (!memory->data.monitor.initialised) give_up("arming", "has not started the monitor");
    } else {
      offnominal_tick(*controller, reference, *memory);
      if (tick == kArmingTick - 1) arm("arming", reference);
    }
  }
  tell("arming", counts);

  print("ram,");
  print(std::uint64_t{sizeof(Controller)});
  print(",");
  print(std::uint64_t{sizeof(Controller::Data)});
  print(",");
  print(std::uint64_t{sizeof(Drives)});
  print("\n");
}

}  // namespace
}  // namespace offnominal::cortex_m

int main() {
  offnominal::cortex_m::run();
  return 0;
}
