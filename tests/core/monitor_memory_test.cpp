// A slide behind a late drive, with friction that builds up after each reversal, integrated in
// steps far shorter than a tick: a monitor whose model has both effects sees nothing.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <offnominal/monitor.hpp>
#include <vector>

#include "core/diagnosis/state_bits.hpp"
#include "core/print_status.hpp"

namespace offnominal::test {
namespace {

constexpr double kMass = 2;
constexpr double kLevel = 3;
constexpr double kWidth = 0.01;
constexpr int kLateTicks = 7;

class LateSlide {
 public:
  explicit LateSlide(double period_s) : period_s_(period_s) {}

  // One tick in which the drive is told `force`.
  JointSample<1, double> move(double force) {
    told_.push_back(force);
    const std::size_t now = told_.size() - 1;
    const double acts = told_[now < kLateTicks ? 0 : now - kLateTicks];
    constexpr int kSteps = 200;
    const double h = period_s_ / kSteps;
    for (int i = 0; i < kSteps; ++i) {
      const double v = sample_.dq[0];
      sample_.q[0] += h * v;
      sample_.dq[0] += h * (acts - kLevel * z_) / kMass;
      z_ += h * (v - z_ * std::fabs(v)) / kWidth;
    }
    sample_.tau[0] = force;
    return sample_;
  }
  [[nodiscard]] JointSample<1, double> start(double force) {
    told_ = {force};
    sample_.tau[0] = force;
    return sample_;
  }

 private:
  double period_s_;
  std::vector<double> told_;
  JointSample<1, double> sample_;
  double z_ = 0;
};

MonitorConfig<1, double> slide_config() {
  MonitorConfig<1, double> config;
  config.chain.gravity_m_s2 = {0, 0, 0};
  config.chain.joints[0].type = JointType::kPrismatic;
  config.chain.joints[0].mass_kg = kMass;
  config.torque_signal = TorqueSignal::kHeld;
  config.estimator.hidden_units = 4;
  config.estimator.learning_rate = 0;
  return config;
}

double force_at(int tick) { return 12 * std::sin(0.02 * tick) + 5 * std::sin(0.11 * tick); }

template <typename Memory>
double largest_error(const MonitorConfig<1, double>& config) {
  using Watch = Monitor<1, 4, double, Memory>;
  Watch monitor;
  EXPECT_EQ(Watch::create(config, monitor), Status::kOk);
  LateSlide slide(config.estimator.period_s);
  typename Watch::State state;
  typename Watch::Output output;
  EXPECT_EQ(monitor.reset(slide.start(force_at(0)), state), Status::kOk);
  double worst = 0;
  for (int tick = 1; tick < 5000; ++tick) {
    EXPECT_EQ(monitor.step(slide.move(force_at(tick)), state, output), Status::kOk);
    worst = std::max(worst, output.error_norm);
  }
  return worst;
}

TEST(MonitorWithMemory, SeesNothingWhereTheModelHasBothEffects) {
  MonitorConfig<1, double> config = slide_config();
  const double without = largest_error<WithoutMemory>(config);
  ASSERT_TRUE(config.chain.effects.add({EffectKind::kHysteresis, 0, {kLevel, kWidth}}));
  const double late = largest_error<WithMemory>(config);
  ASSERT_TRUE(config.chain.effects.add(
      {EffectKind::kTimeDelay, 0, {kLateTicks * config.estimator.period_s}}));
  const double with = largest_error<WithMemory>(config);
  std::cout << "largest |e| without " << without << ", with hysteresis " << late << ", with both "
            << with << " m/s\n";
  EXPECT_LT(with, 2e-3);
  EXPECT_GT(late, 10 * with);
  EXPECT_GT(without, late);
}

TEST(MonitorWithMemory, IsTheSameAsWithoutWhereNoEffectHasOne) {
  const MonitorConfig<1, double> config = slide_config();
  EXPECT_EQ(largest_error<WithMemory>(config), largest_error<WithoutMemory>(config));
}

TEST(MonitorWithMemory, ARefusedSampleChangesNothing) {
  using Watch = Monitor<1, 4, double, WithMemory>;
  MonitorConfig<1, double> config = slide_config();
  ASSERT_TRUE(config.chain.effects.add({EffectKind::kHysteresis, 0, {kLevel, kWidth}}));
  ASSERT_TRUE(config.chain.effects.add({EffectKind::kTimeDelay, 0, {0.003}}));
  Watch monitor;
  ASSERT_EQ(Watch::create(config, monitor), Status::kOk);
  LateSlide slide(config.estimator.period_s);
  Watch::State state;
  Watch::Output output;
  ASSERT_EQ(monitor.reset(slide.start(1), state), Status::kOk);
  for (int tick = 0; tick < 20; ++tick) {
    ASSERT_EQ(monitor.step(slide.move(tick), state, output), Status::kOk);
  }
  const Bits before = bits_of(state);
  JointSample<1, double> spoilt = slide.move(4);
  spoilt.q[0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(monitor.step(spoilt, state, output), Status::kNonFinitePosition);
  EXPECT_EQ(monitor.resume(spoilt, 3, state), Status::kNonFinitePosition);
  EXPECT_TRUE(bits_of(state) == before);
  spoilt.q[0] = 0.1;
  EXPECT_EQ(monitor.resume(spoilt, 3, state), Status::kOk);
  EXPECT_FALSE(bits_of(state) == before);
}

TEST(MonitorWithoutMemory, RefusesAModelThatNeedsOne) {
  using Watch = Monitor<1, 4, double>;
  MonitorConfig<1, double> config = slide_config();
  ASSERT_TRUE(config.chain.effects.add({EffectKind::kTimeDelay, 0, {0.003}}));
  Watch monitor;
  EXPECT_EQ(Watch::create(config, monitor), Status::kNeedsMemory);
}

}  // namespace
}  // namespace offnominal::test
