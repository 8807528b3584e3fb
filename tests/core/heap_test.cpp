// Eigen asserts that it does not allocate while allocation is forbidden; the assertion has to be on
// in every build, and to be a failed test instead of an abort.
#include <stdexcept>

#define EIGEN_RUNTIME_NO_MALLOC
#define eigen_assert(condition)                                     \
  do {                                                              \
    if (!(condition)) throw std::logic_error("Eigen: " #condition); \
  } while (false)

#include <gtest/gtest.h>

#include <offnominal/control/computed_torque.hpp>
#include <offnominal/diagnosis/isolation.hpp>
#include <offnominal/monitor.hpp>

#include "core/model/random_chain.hpp"
#include "core/print_status.hpp"
#include "core/watched_arm.hpp"

namespace offnominal::test {
namespace {

class HeapForbidden {
 public:
  HeapForbidden() { Eigen::internal::set_is_malloc_allowed(false); }
  ~HeapForbidden() { Eigen::internal::set_is_malloc_allowed(true); }
  HeapForbidden(const HeapForbidden&) = delete;
  HeapForbidden& operator=(const HeapForbidden&) = delete;
};

TEST(Heap, TheForbiddanceIsNoticed) {
  Eigen::VectorXd grown;
  const HeapForbidden forbidden;
  EXPECT_THROW(grown.resize(100), std::logic_error);
}

template <int N, int L, typename Scalar, typename Space>
MonitorConfig<N, Scalar, Space> any_config(std::mt19937_64& generator) {
  MonitorConfig<N, Scalar, Space> config;
  config.chain = random_chain<N, Scalar>(generator);
  for (int i = 0; i < N; ++i) {
    const auto joint = static_cast<std::uint8_t>(i);
    EXPECT_TRUE(config.chain.effects.add({EffectKind::kViscousFriction, joint, {Scalar(0.5)}}));
    EXPECT_TRUE(config.chain.effects.add(
        {EffectKind::kStribeckFriction, joint, {Scalar(0.5), Scalar(0.1), Scalar(0.01)}}));
  }
  config.estimator.hidden_units = L;
  if constexpr (std::is_same_v<Space, TorqueSpace>) {
    for (JointBound<Scalar>& joint : config.bound.joints) joint.value[0] = Scalar(0.01);
    config.bound.fast.alpha = 60;
  } else {
    config.bound.kind = BoundKind::kScaledNorm;
    config.bound.offset = Scalar(0.01);
    config.bound.matrix.fill(Scalar(0.01));
  }
  config.max_compensation.fill(Scalar(10));
  return config;
}

// Beside a monitor in torque space: which fault it is.
template <int N, typename Scalar, typename Space>
struct Beside {
  explicit Beside(const MonitorConfig<N, Scalar, Space>& /*config*/) {}
  template <typename Watch>
  void step(const Watch& /*monitor*/, const typename Watch::State& /*state*/,
            const typename Watch::Output& /*output*/) {}
  bool has_answered() { return true; }
};
template <int N, typename Scalar>
struct Beside<N, Scalar, TorqueSpace> {
  explicit Beside(const MonitorConfig<N, Scalar, TorqueSpace>& config) {
    EXPECT_EQ((Isolation<N, Scalar>::create({}, config, isolation)), Status::kOk);
    isolation.reset(isolating);
  }
  template <typename Watch>
  void step(const Watch& monitor, const typename Watch::State& state,
            const typename Watch::Output& output) {
    isolation.step(monitor.model(), state.sample, state.tick, output, isolating);
    // The law of a fault, whatever was answered.
    PerJoint<N, Scalar> thresholds{};
    size_for(isolating.joints.size(), thresholds);
    for (Scalar& threshold : thresholds) threshold = Scalar(1);
    FaultLaw<N, Scalar>& law = isolating.law;
    law.of_body = !law.of_body;
    begin_law(isolating.block.last, thresholds, law);
    follow_law(isolating.block.last, thresholds, LawRates<Scalar>{}, law);
    EXPECT_EQ(monitor.compensation_of(law.load, output).torque.size(), law.load.size());
  }
  bool has_answered() { return isolating.diagnosis.time_s > 0; }

  Isolation<N, Scalar> isolation;
  IsolationState<N, Scalar> isolating;
};

// A thousand ticks with learning and projection, and a controller beside them.
template <int N, int L, typename Scalar, typename Space = AccelerationSpace>
void expect_no_heap(std::mt19937_64& generator) {
  using Watch = Monitor<N, L, Scalar, WithoutMemory, Space>;
  auto config = any_config<N, L, Scalar, Space>(generator);
  config.estimator.weight_radius = 4;
  Watch monitor;
  typename Watch::State state;
  typename Watch::Output output;
  JointSample<N, Scalar> sample;
  const ComputedTorqueGains<N, Scalar> gains{};
  const Reference<N, Scalar> reference;
  int learnt = 0;
  Beside<N, Scalar, Space> beside(config);
  {
    const HeapForbidden forbidden;
    ASSERT_EQ(Watch::create(config, monitor), Status::kOk);
    ASSERT_EQ(monitor.reset(sample, state), Status::kOk);
    for (int tick = 0; tick < 1000; ++tick) {
      sample.q += Scalar(0.001) * sample.dq;
      sample.dq = random_vector<N, Scalar>(generator, 1.0);
      sample.tau =
          computed_torque(monitor.model(), gains, reference, sample.q, sample.dq, tick * 0.001);
      ASSERT_EQ(monitor.step(sample, state, output), Status::kOk);
      beside.step(monitor, state, output);
      learnt += output.detector.level ? 1 : 0;
    }
  }
  EXPECT_GT(learnt, 100);
  EXPECT_TRUE(beside.has_answered());
}

TEST(Heap, IsNotUsedByATickOfAnyShape) {
  std::mt19937_64 generator = seeded_generator();
  expect_no_heap<1, 1, float>(generator);
  expect_no_heap<2, 35, float>(generator);
  expect_no_heap<2, 35, double>(generator);
  expect_no_heap<6, 48, float>(generator);
  expect_no_heap<7, 64, double>(generator);
  expect_no_heap<1, 1, float, TorqueSpace>(generator);
  expect_no_heap<7, 64, float, TorqueSpace>(generator);
  expect_no_heap<7, 64, double, TorqueSpace>(generator);
}

}  // namespace
}  // namespace offnominal::test
