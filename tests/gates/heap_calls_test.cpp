#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <span>

#include "heap_counter.hpp"
#include "whole_core.hpp"

// Drives the very object that the symbol gates judge, with malloc and its kin replaced by counters.

namespace offnominal::gates {
namespace {

constexpr std::uint32_t kTicks = 1'000'000;
constexpr std::uint32_t kHealthyTicks = 1000;

template <int Joints, int Hidden, typename Type>
struct Size {
  static constexpr int kJoints = Joints;
  static constexpr int kHidden = Hidden;
  using Scalar = Type;
};

// Of joints whose number is known at run time only.
constexpr std::size_t kJointsAtRunTime = 7;

template <int N, typename Scalar>
MonitorConfig<N, Scalar> config() {
  MonitorConfig<N, Scalar> config;
  size_for(kJointsAtRunTime, config.chain.joints, config.max_compensation);
  size_for(kJointsAtRunTime * kJointsAtRunTime, config.bound.matrix);
  for (std::size_t i = 0; i < config.chain.joints.size(); ++i) {
    auto& joint = config.chain.joints[i];
    // One prismatic joint, then axes in turn.
    joint.type = i == 1 ? JointType::kPrismatic : JointType::kRevolute;
    joint.axis = {0, 0, 0};
    joint.axis[i % 3] = 1;
    joint.origin_m = {Scalar(0.3), 0, Scalar(0.1)};
    joint.centre_of_mass_m = {Scalar(0.15), Scalar(0.05), 0};
    joint.inertia_kg_m2 = {Scalar(0.01), Scalar(0.02), Scalar(0.02), 0, 0, 0};
  }
  // All of them; two joints have no room for the first ones.
  const std::size_t room = config.chain.effects.items.size();
  const std::size_t first = kAllEffectInfos.size() - std::min(room, kAllEffectInfos.size());
  for (const EffectInfo& info : std::span(kAllEffectInfos).subspan(first)) {
    Effect<Scalar> effect;
    effect.kind = info.kind;
    // The samples are those of joints without a memory: what has one is too small to see.
    const Scalar small = remembers(info.kind) ? Scalar(1e-5) : Scalar(0.05);
    for (std::size_t k = 0; k < info.parameters.size(); ++k) {
      const bool other_joint = info.parameters[k].quantity == Quantity::kJointNumber;
      effect.parameters[k] = other_joint ? Scalar(2) : small;
    }
    if (!config.chain.effects.add(effect)) throw std::length_error("effects do not fit");
  }
  config.bound.kind = BoundKind::kScaledNorm;
  config.bound.matrix[0] = 1;
  config.max_compensation.fill(50);
  return config;
}

template <typename S>
class HeapCalls : public ::testing::Test {};

using Sizes = ::testing::Types<Size<2, 35, float>, Size<2, 35, double>, Size<6, 35, float>,
                               Size<7, 64, float>, Size<kRuntimeJoints, 35, double>>;
TYPED_TEST_SUITE(HeapCalls, Sizes);

TYPED_TEST(HeapCalls, AreNoneInAMillionTicksHealthyAndAdapting) {
  using Scalar = typename TypeParam::Scalar;
  constexpr int kJoints = TypeParam::kJoints;
  constexpr int kHidden = TypeParam::kHidden;
  const auto controller = std::make_unique<Controller<kJoints, kHidden, Scalar>>();
  const MonitorConfig<kJoints, Scalar> settings = config<kJoints, Scalar>();
  ComputedTorqueGains<kJoints, Scalar> gains;
  size_for(kJointsAtRunTime, gains.kp, gains.kd);
  gains.kp.fill(100);
  gains.kd.fill(20);
  Vector<kJoints, Scalar> q;
  size_for(kJointsAtRunTime, q);
  q.fill(Scalar(0.1));

  const std::uint64_t before = bench::heap_calls();
  const Status started = start(settings, gains, *controller);
  const Status healthy = run(*controller, kHealthyTicks, Scalar(0));
  const bool latched_while_healthy = controller->output.detector.latched;
  const Status adapting = run(*controller, kTicks - kHealthyTicks, Scalar(40));
  const double rest = call_the_rest(*controller, q);
  const std::uint64_t calls = bench::heap_calls() - before;

  EXPECT_EQ(calls, 0u);
  EXPECT_STREQ(name_of(started), "Ok");
  EXPECT_STREQ(name_of(healthy), "Ok");
  EXPECT_FALSE(latched_while_healthy);
  EXPECT_STREQ(name_of(adapting), "Ok");
  EXPECT_TRUE(controller->output.detector.latched);
  EXPECT_GT(controller->output.psi_hat.norm(), Scalar(0));
  EXPECT_EQ(controller->state.tick, kTicks);
  EXPECT_TRUE(std::isfinite(rest));
}

TEST(HeapCounter, SeesAnAllocation) {
  const std::uint64_t before = bench::heap_calls();
  const auto block = std::make_unique<int[]>(1000);
  EXPECT_NE(block.get(), nullptr);
  EXPECT_GT(bench::heap_calls(), before);
}

}  // namespace
}  // namespace offnominal::gates
