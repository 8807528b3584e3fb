#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <offnominal/diagnosis/estimator.hpp>

#include "core/diagnosis/estimator_run.hpp"
#include "core/model/random_chain.hpp"
#include "core/print_status.hpp"
#include "support/repetitions.hpp"
#include "support/seed.hpp"

namespace offnominal::test {
namespace {

constexpr int kJoints = 2;
constexpr int kHidden = 6;

template <typename Scalar>
using State = EstimatorState<kJoints, kHidden, Scalar>;
template <typename Scalar>
using Input = EstimatorInput<kJoints, Scalar>;

// Numbers of every size that the scalar has, both signs.
template <typename Scalar>
Scalar absurd(std::mt19937_64& generator) {
  const double digits = std::numeric_limits<Scalar>::max_exponent10;
  const double size = std::pow(10.0, uniform(generator, -digits, digits));
  return static_cast<Scalar>(uniform(generator, 0, 1) < 0.5 ? size : -size);
}

enum class Mood { kCalm, kWild, kHuge, kAlternating, kAbsurd, kNotFinite };

template <typename Scalar>
Input<Scalar> random_input(Mood mood, const Input<Scalar>& before, std::mt19937_64& generator) {
  const auto draw = [&](double size) {
    return static_cast<Scalar>(uniform(generator, -size, size));
  };
  Input<Scalar> input = before;
  const auto fill = [&](auto&& number) {
    for (Eigen::Index i = 1; i < input.z.size(); ++i) input.z[i] = number(input.z[i]);
    for (Scalar& f : input.nominal_rate) f = number(f);
  };
  switch (mood) {
    case Mood::kCalm:
      fill([&](Scalar x) { return std::fabs(x) < 10 ? Scalar(0.99) * x + draw(0.1) : draw(10); });
      break;
    case Mood::kWild:
      fill([&](Scalar) { return draw(10); });
      break;
    case Mood::kHuge:
      fill([&](Scalar) { return draw(1e5); });
      break;
    case Mood::kAlternating:
      fill([&](Scalar x) { return -x * (1 + draw(1e-3)); });
      break;
    case Mood::kAbsurd:
      fill([&](Scalar) { return absurd<Scalar>(generator); });
      break;
    case Mood::kNotFinite:
      fill([&](Scalar x) {
        const double which = uniform(generator, 0, 3);
        return which < 1   ? std::numeric_limits<Scalar>::quiet_NaN()
               : which < 2 ? std::numeric_limits<Scalar>::infinity()
                           : x;
      });
      break;
  }
  input.mu_bar = static_cast<Scalar>(uniform(generator, 0, 0.2));
  return input;
}

// One mood for a while, then another one; now and then a fresh start.
template <typename Scalar>
class RandomLife {
 public:
  explicit RandomLife(const EstimatorConfig<Scalar>& config, std::mt19937_64& generator)
      : config_(config), generator_(generator) {
    EXPECT_EQ(validate<kHidden>(config), Status::kOk);
    restart();
  }

  Status step_once() {
    if (uniform(generator_, 0, 1) < 1e-3) mood_ = static_cast<Mood>(generator_() % 6);
    if (uniform(generator_, 0, 1) < 1e-3) restart();
    const Input<Scalar> input = random_input(mood_, last_, generator_);
    const Status status = step(config_, input, state);
    // Whatever came before, an ordinary sample is taken.
    if (mood_ == Mood::kCalm) {
      EXPECT_EQ(status, Status::kOk);
    }
    if (status == Status::kOk) last_ = input;
    return status;
  }

  State<Scalar> state;

 private:
  void restart() {
    last_.z.setZero();
    last_.z[0] = 1;
    last_.nominal_rate.setZero();
    last_.mu_bar = Scalar(0.1);
    EXPECT_EQ(reset(config_, last_, state), Status::kOk);
    mood_ = static_cast<Mood>(generator_() % 6);
  }

  EstimatorConfig<Scalar> config_;
  std::mt19937_64& generator_;
  Input<Scalar> last_;
  Mood mood_ = Mood::kCalm;
};

template <typename Scalar>
EstimatorConfig<Scalar> config_for(int turn) {
  EstimatorConfig<Scalar> config;
  config.hidden_units = kHidden;
  config.weight_radius = static_cast<Scalar>(turn % 2 == 0 ? 1.2 : 20);
  config.dead_zone = turn < 2 ? DeadZone::kContinuous : DeadZone::kDiscontinuous;
  return config;
}

template <typename Scalar>
void expect_ball_never_left() {
  std::mt19937_64 generator = seeded_generator();
  int refused = 0;
  int on_ball = 0;
  for (int turn = 0; turn < 4; ++turn) {
    const EstimatorConfig<Scalar> config = config_for<Scalar>(turn);
    const auto radius = static_cast<double>(config.weight_radius);
    RandomLife<Scalar> life(config, generator);
    for (int tick = 0; tick < repetitions(250000); ++tick) {
      const Status status = life.step_once();
      ASSERT_TRUE(status == Status::kOk || status == Status::kNumericOverflow);
      const double norm = weight_norm(life.state.weights);
      ASSERT_LE(norm, radius) << "turn " << turn << ", tick " << tick;
      refused += status == Status::kOk ? 0 : 1;
      on_ball += norm > 0.999 * radius ? 1 : 0;
    }
  }
  EXPECT_GT(refused, repetitions(1000));
  EXPECT_GT(on_ball, repetitions(10000));
}

TEST(WeightBall, IsNeverLeftInAMillionRandomStepsInDouble) { expect_ball_never_left<double>(); }

TEST(WeightBall, IsNeverLeftInAMillionRandomStepsInFloat) { expect_ball_never_left<float>(); }

}  // namespace
}  // namespace offnominal::test
