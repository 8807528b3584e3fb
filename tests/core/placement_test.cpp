#include <alloca.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <new>
#include <optional>

// Eigen starts a loop where memory is aligned and does what lies before number by number, in
// another order of summation: the result's last bits follow the address. It asks for that place
// here, which the tests count.
namespace offnominal::test {

inline int addresses_asked_for = 0;

template <std::size_t Alignment, typename Scalar>
Eigen::Index first_aligned(const Scalar* at, Eigen::Index size) {
  ++addresses_asked_for;
  const std::size_t beyond = reinterpret_cast<std::uintptr_t>(at) % Alignment;
  const auto first = static_cast<Eigen::Index>((Alignment - beyond) % Alignment / sizeof(Scalar));
  return first < size ? first : size;
}

}  // namespace offnominal::test

namespace Eigen::internal {
#define OFFNOMINAL_COUNT(Alignment, Scalar)                                            \
  template <>                                                                          \
  inline Index first_aligned<Alignment, Scalar, Index>(const Scalar* at, Index size) { \
    return offnominal::test::first_aligned<Alignment>(at, size);                       \
  }
OFFNOMINAL_COUNT(16, float)
OFFNOMINAL_COUNT(32, float)
OFFNOMINAL_COUNT(64, float)
OFFNOMINAL_COUNT(16, double)
OFFNOMINAL_COUNT(32, double)
OFFNOMINAL_COUNT(64, double)
#undef OFFNOMINAL_COUNT
}  // namespace Eigen::internal

#include <offnominal/control/computed_torque.hpp>
#include <offnominal/monitor.hpp>

#include "core/diagnosis/state_bits.hpp"
#include "core/print_status.hpp"

// Where the objects and the stack lie in memory changes no bit of what comes out. Compiled for
// several processors (CMakeLists.txt): the length of their vectors decides how much is done at
// once.

namespace offnominal::test {
namespace {

constexpr std::size_t kCacheLine = 64;
constexpr int kTicks = 1023;

// Room for one T that begins `bytes` behind a cache line, as far as T's own alignment lets it.
template <typename T>
class Placed {
 public:
  explicit Placed(std::size_t bytes)
      : at_(new (room_.data() + bytes / alignof(T) * alignof(T)) T) {}
  ~Placed() { at_->~T(); }
  Placed(const Placed&) = delete;
  Placed& operator=(const Placed&) = delete;
  T& operator*() const { return *at_; }
  T* operator->() const { return at_; }

 private:
  alignas(kCacheLine) std::array<std::byte, sizeof(T) + kCacheLine> room_{};
  T* at_;
};

template <int N, int L, typename Scalar>
MonitorConfig<N, Scalar> arm_with_friction() {
  MonitorConfig<N, Scalar> config;
  config.estimator.hidden_units = L;
  for (std::size_t i = 0; i < static_cast<std::size_t>(N); ++i) {
    auto& joint = config.chain.joints[i];
    joint.type = i == 2 ? JointType::kPrismatic : JointType::kRevolute;
    joint.axis = {0, 0, 0};
    joint.axis[i % 3] = 1;
    joint.origin_m = {Scalar(0.3), 0, Scalar(0.1)};
    joint.mass_kg = Scalar(1.3);
    joint.centre_of_mass_m = {Scalar(0.15), Scalar(0.05), Scalar(0.02)};
    joint.inertia_kg_m2 = {Scalar(0.011), Scalar(0.023), Scalar(0.019), 0, 0, 0};
    const auto number = static_cast<std::uint8_t>(i);
    auto& effects = config.chain.effects;
    const bool added =
        effects.add({EffectKind::kCoulombFriction, number, {Scalar(0.3), Scalar(0.1)}}) &&
        effects.add({EffectKind::kLoadDependentFriction, number, {Scalar(0.1), Scalar(0.1)}}) &&
        effects.add({EffectKind::kTimeDelay, number, {Scalar(0.0015)}});
    EXPECT_TRUE(added);
  }
  config.bound.kind = BoundKind::kScaledNorm;
  config.bound.scale = Scalar(0.3);
  for (std::size_t i = 0; i < config.bound.matrix.size(); ++i) {
    config.bound.matrix[i] = Scalar(0.1) * static_cast<Scalar>(i % 5);
  }
  config.torque_signal = TorqueSignal::kHeld;
  config.max_compensation.fill(50);
  return config;
}

// The motion's sample at `tick`, with far more torque than it needs: a violent fault.
template <int N, typename Scalar>
void move(const RigidBodyModel<N, Scalar>& model, int tick, JointSample<N, Scalar>& sample) {
  const double t = 0.001 * tick;
  Reference<N, Scalar> reference;
  for (Eigen::Index i = 0; i < N; ++i) {
    const double w = 2 + 0.7 * static_cast<double>(i);
    sample.q[i] = static_cast<Scalar>(0.3 * std::sin(w * t));
    sample.dq[i] = static_cast<Scalar>(0.3 * w * std::cos(w * t));
    reference.q[i] = sample.q[i] + Scalar(0.01);
    reference.ddq[i] = static_cast<Scalar>(-0.3 * w * w * std::sin(w * t));
  }
  reference.dq = sample.dq;
  ComputedTorqueGains<N, Scalar> gains;
  gains.kp.fill(100);
  gains.kd.fill(20);
  sample.tau = computed_torque(model, gains, reference, sample.q, sample.dq, t);
  for (Eigen::Index i = 0; i < N; ++i) {
    sample.tau[i] += static_cast<Scalar>(60 * std::sin(37 * t + static_cast<double>(i)));
  }
}

// What a tick reads and writes, each in a place of its own.
template <int N, int L, typename Number>
struct Objects {
  using Scalar = Number;
  using Watch = Monitor<N, L, Scalar, WithMemory>;
  Placed<Watch> monitor;
  Placed<typename Watch::State> state;
  Placed<typename Watch::Output> output;
  Placed<JointSample<N, Scalar>> sample;

  explicit Objects(std::size_t bytes) : monitor(bytes), state(bytes), output(bytes), sample(bytes) {
    EXPECT_EQ(Watch::create(arm_with_friction<N, L, Scalar>(), *monitor), Status::kOk);
  }
};

template <typename Arm>
[[gnu::noinline]] Status run(const Arm& arm) {
  move(arm.monitor->model(), 0, *arm.sample);
  Status status = arm.monitor->reset(*arm.sample, *arm.state);
  for (int tick = 1; tick <= kTicks && status == Status::kOk; ++tick) {
    move(arm.monitor->model(), tick, *arm.sample);
    const bool gap = tick % 100 == 0;
    status = gap ? arm.monitor->resume(*arm.sample, 0, *arm.state)
                 : arm.monitor->step(*arm.sample, *arm.state, *arm.output);
  }
  return status;
}

// The same further down the stack. No frame between here and there may ask for more alignment than
// the 16 bytes that compilers keep: the shift would be lost.
template <typename Arm>
[[gnu::noinline]] Status run_below(std::size_t stack_bytes, const Arm& arm) {
  auto* const room = static_cast<volatile char*>(alloca(stack_bytes + 1));
  room[0] = 0;
  const Status status = run(arm);
  room[stack_bytes] = 0;
  return status;
}

template <typename Arm>
class Placement : public testing::Test {
 protected:
  void SetUp() override {
#ifdef __AVX512F__
    if (!__builtin_cpu_supports("avx512f")) GTEST_SKIP() << "this processor has no AVX-512";
#endif
#ifdef __AVX2__
    if (!__builtin_cpu_supports("avx2")) GTEST_SKIP() << "this processor has no AVX2";
#endif
  }
};

using Arms = testing::Types<Objects<2, 35, float>, Objects<7, 64, double>, Objects<9, 8, double>>;
TYPED_TEST_SUITE(Placement, Arms);

TYPED_TEST(Placement, OfObjectsAndStackChangesNoBitInAThousandTicksOfAViolentFault) {
  std::optional<std::array<Bits, 2>> first;
  for (std::size_t bytes = 0; bytes < kCacheLine; bytes += sizeof(typename TypeParam::Scalar)) {
    const auto arm = std::make_unique<TypeParam>(bytes);
    for (std::size_t stack = 0; stack < kCacheLine; stack += 16) {
      ASSERT_EQ(run_below(stack, *arm), Status::kOk);
      ASSERT_TRUE(arm->output->detector.latched);
      const std::array<Bits, 2> bits{bits_of(*arm->state), bits_of(*arm->output)};
      if (!first) first = bits;
      EXPECT_TRUE(bits == *first) << stack << " bytes further down the stack, objects " << bytes
                                  << " bytes behind a cache line";
    }
  }
}

// Of more joints than these Eigen asks before it copies a matrix, which rounds nothing.
TYPED_TEST(Placement, IsNothingThatATickAsksFor) {
  const auto arm = std::make_unique<TypeParam>(0);
  addresses_asked_for = 0;
  ASSERT_EQ(run(*arm), Status::kOk);
  EXPECT_EQ(addresses_asked_for, 0);
}

// What is counted is what Eigen asks.
TEST(PlacementCount, SeesEigenAskForAnAddress) {
  Eigen::Matrix<double, 11, 11> matrix;
  matrix.setIdentity();
  Eigen::Matrix<double, 11, 1> vector;
  vector.setOnes();
  addresses_asked_for = 0;
  const Eigen::Matrix<double, 11, 1> result = matrix.lazyProduct(vector);
  EXPECT_EQ(result[10], 1);
  EXPECT_GT(addresses_asked_for, 0);
}

}  // namespace
}  // namespace offnominal::test
