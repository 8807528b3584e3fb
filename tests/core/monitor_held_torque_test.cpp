#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <offnominal/monitor.hpp>

#include "core/model/random_chain.hpp"
#include "core/print_status.hpp"
#include "support/seed.hpp"

namespace offnominal::test {
namespace {

// A slide of 2 kg under a torque that jumps at every tick and is constant in between: its velocity
// is then linear inside every tick, and so the estimator's, which owes nothing to interpolation.
class HeldSlide {
 public:
  static MonitorConfig<1, double> config(TorqueSignal signal) {
    MonitorConfig<1, double> config;
    config.chain.gravity_m_s2 = {0, 0, 0};
    config.chain.joints[0].type = JointType::kPrismatic;
    config.chain.joints[0].mass_kg = kMass;
    config.bound.kind = BoundKind::kTable;
    config.bound.variable = BoundVariable::kTorque;
    config.bound.points = 2;
    config.bound.at = {0, 10};
    config.bound.value = {1, 11};  // 1 + |tau|
    config.torque_signal = signal;
    return config;
  }

  JointSample<1, double> move(double period_s, double force) {
    sample_.q[0] += sample_.dq[0] * period_s + 0.5 * force / kMass * period_s * period_s;
    sample_.dq[0] += force / kMass * period_s;
    sample_.tau[0] = force;
    return sample_;
  }
  [[nodiscard]] const JointSample<1, double>& sample() const { return sample_; }

 private:
  static constexpr double kMass = 2;
  JointSample<1, double> sample_;
};

struct SlideErrors {
  double velocity = 0;   // largest |e|
  double threshold = 0;  // largest |mu - filtered bound|
};

SlideErrors errors_under_a_jumping_force(TorqueSignal signal) {
  using Watch = Monitor<1, 4, double>;
  std::mt19937_64 generator = seeded_generator();
  auto config = HeldSlide::config(signal);
  config.estimator.hidden_units = 4;
  Watch monitor;
  EXPECT_EQ(Watch::create(config, monitor), Status::kOk);
  HeldSlide slide;
  Watch::State state;
  Watch::Output output;
  EXPECT_EQ(monitor.reset(slide.sample(), state), Status::kOk);
  const double period = config.estimator.period_s;
  const double decay = std::exp(-config.estimator.alpha * period);
  double filtered_bound = 0;
  SlideErrors worst;
  for (int tick = 0; tick < 2000; ++tick) {
    const double force = uniform(generator, -8, 8);
    EXPECT_EQ(monitor.step(slide.move(period, force), state, output), Status::kOk);
    filtered_bound =
        decay * filtered_bound + (1 - decay) / config.estimator.alpha * (1 + std::fabs(force));
    worst.velocity = std::max(worst.velocity, output.error_norm);
    worst.threshold = std::max(worst.threshold, std::fabs(output.threshold - filtered_bound));
  }
  return worst;
}

TEST(Monitor, GivenAHeldTorqueThatJumpsThenAMonitorThatKnowsItMakesNoErrorOfItsOwn) {
  const SlideErrors held = errors_under_a_jumping_force(TorqueSignal::kHeld);
  EXPECT_LT(held.velocity, 1e-12);
  EXPECT_LT(held.threshold, 1e-9);
  const SlideErrors sampled = errors_under_a_jumping_force(TorqueSignal::kSampled);
  EXPECT_GT(sampled.velocity, 1e-3) << "half a tick late";
  EXPECT_GT(sampled.threshold, 1e-4);
}

}  // namespace
}  // namespace offnominal::test
