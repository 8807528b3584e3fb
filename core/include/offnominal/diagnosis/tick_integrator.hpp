#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <offnominal/diagnosis/dead_zone.hpp>
#include <offnominal/diagnosis/estimator_config.hpp>
#include <offnominal/diagnosis/estimator_state.hpp>
#include <offnominal/diagnosis/gradient_span.hpp>
#include <offnominal/diagnosis/hidden_pass.hpp>
#include <offnominal/diagnosis/space.hpp>
#include <type_traits>

namespace offnominal::detail {

// What drives the filters at one place inside the tick.
template <int N, typename Scalar, typename Space>
struct StageSignals {
  const Vector<N, Scalar>& nominal_rate;
  const typename Space::template Threshold<N, Scalar>& mu_bar;
};

// Inner products z_i . z_j of the tick's beginning (0), middle (m) and end (1).
template <typename Scalar>
struct InputProducts {
  Scalar z00{}, z0m{}, z01{}, zmm{}, zm1{}, z11{};
};

// What one Runge-Kutta stage starts from.
template <int N, typename Scalar, typename Space>
struct StagePoint {
  typename Space::template Threshold<N, Scalar> mu{};
  Vector<N, Scalar> e;
  SpanPoint<Scalar> theta;
  SpanNorms<Scalar> norms;
};

// The network's output at a stage, with the stage's theta, and with its hidden layer but W2 as the
// tick began.
template <int N, typename Scalar>
struct StageOutput {
  Vector<N, Scalar> psi_hat;
  Vector<N, Scalar> with_w2_begin;
  std::array<Scalar, kStages> with_sigma{};  // sigma_j . sigma_s, j < s
};

// Where the tick ends: omega, mu and the coordinates of theta before it is shrunk into the ball.
template <int N, typename Scalar, typename Space>
struct TickEnd {
  Vector<N, Scalar> omega;
  typename Space::template Threshold<N, Scalar> mu{};
  SpanPoint<Scalar> theta;
};

// Learning is meant for steps that are small against theta. A step beyond this many times |W2| (and
// of the unit square's size for W2) says nothing, and its fourth power must not overflow.
template <typename Scalar>
inline constexpr Scalar kLargestStep = 1000;

// One tick in progress: takes omega, mu and the coordinates of theta through the four stages.
template <int N, int L, typename Scalar, typename Space>
class TickIntegrator {
 public:
  using Threshold = typename Space::template Threshold<N, Scalar>;
  using End = TickEnd<N, Scalar, Space>;
  using Signals = StageSignals<N, Scalar, Space>;
  using Point = StagePoint<N, Scalar, Space>;
  static constexpr bool kPerJoint = !std::is_same_v<Threshold, Scalar>;
  EIGEN_ALWAYS_INLINE TickIntegrator(const EstimatorConfig<Scalar>& config,
                                     const TickBegin<N, Scalar, Space>& model,
                                     const EstimatorInput<N, Scalar, Space>& input,
                                     const EstimatorState<N, L, Scalar, Space>& begin)
      : config_(config),
        model_(model),
        input_(input),
        begin_(begin),
        factors_{{}, begin.sigma, {}},
        w1_z_{begin.w1_z, {}, factors_.sigma_later.back()} {
    const Scalar half(0.5);
    z_.z00 = begin.z_squared_norm;
    z_.z01 = dot_of_inputs<N, Scalar>(begin.z, input.z);
    z_.z11 = squared_norm_of_input<N, Scalar>(input.z);
    z_.z0m = half * (z_.z00 + z_.z01);
    z_.zm1 = half * (z_.z01 + z_.z11);
    z_.zmm = half * (z_.z0m + z_.zm1);
    largest_d_ = kLargestStep<Scalar> /
                 (config.period_s * config.learning_rate * std::sqrt(z_.z00 + z_.z11));
    radius_squared_ = config.weight_radius * config.weight_radius;
    look_at_end<N, L, Scalar>(begin.weights, input.z, w1_z_);
  }

  [[nodiscard]] EIGEN_ALWAYS_INLINE End integrate() {
    const Scalar h = config_.period_s;
    const Scalar half = Scalar(0.5);
    const auto& y_begin = measured_at<N, Scalar, Space>(begin_);
    const auto& y_end = measured_at<N, Scalar, Space>(input_);
    const Vector<N, Scalar> y_middle = half * (y_begin + y_end);
    const Vector<N, Scalar> middle_rate = half * (model_.nominal_rate + input_.nominal_rate);
    const Threshold middle_mu_bar = half * (model_.mu_bar + input_.mu_bar);
    const Signals begin{model_.nominal_rate, model_.mu_bar};
    const Signals middle{middle_rate, middle_mu_bar};
    const Signals end{input_.nominal_rate, input_.mu_bar};
    Point at;
    at.mu = begin_.mu;
    at.e = y_begin - begin_.omega;
    d_[0] = dead_zone<N, Scalar>(at.e, at.mu, config_.dead_zone, largest_d_);
    at.theta.keep = Scalar(1);
    at.norms = {begin_.theta_squared_norm, begin_.theta_squared_norm};
    // A tick that begins inside the dead-zone learns nothing, whatever its inner stages look like.
    rate_ = squared_length(d_[0]) > Scalar(0) ? config_.learning_rate : Scalar(0);
    if constexpr (kPerJoint) {
      const Eigen::Index joints = at.e.size();
      if constexpr (N == kRuntimeJoints) learns_.resize(joints);
      repeat<N>(
          joints, [&](int i) __attribute__((always_inline)) {
            learns_[i] = d_[0][i] == Scalar(0) ? Scalar(0) : Scalar(1);
          });
    }
    End sum{begin_.omega, begin_.mu, {Scalar(1), {}}};
    Point next;
    stage<0>(begin, y_middle, {}, z_.z00, h * half, h / 6, at, next, sum);
    stage<1>(middle, y_middle, {z_.z0m}, z_.zmm, h * half, h / 3, next, at, sum);
    stage<2>(middle, y_end, {z_.z0m, z_.zmm}, z_.zmm, h, h / 3, at, next, sum);
    stage<3>(end, y_end, {z_.z01, z_.zm1, z_.zm1}, z_.z11, h, h / 6, next, at, sum);
    return sum;
  }

  // Squared size that no part of theta_end or of W1 z1 exceeds by more than the factor 8, so that
  // nothing overflows where this is far from the scalar's largest number.
  [[nodiscard]] EIGEN_ALWAYS_INLINE Scalar squared_reach(const SpanPoint<Scalar>& theta) const {
    Scalar sum = theta.keep * theta.keep * begin_.theta_squared_norm;
    repeat<kStages>([&](int i) __attribute__((always_inline)) {
      const auto j = static_cast<std::size_t>(i);
      sum += theta.gain[j] * theta.gain[j] * gradient_reach_[j];
    });
    return sum;
  }
  [[nodiscard]] EIGEN_ALWAYS_INLINE const InputProducts<Scalar>& input_products() const {
    return z_;
  }

  // Moves the weights and leaves them and what depends on them ready for the next tick. `state` is
  // the state that the tick began with; `reach` is squared_reach() of theta.
  EIGEN_ALWAYS_INLINE void finish(SpanPoint<Scalar> theta, Scalar reach,
                                  EstimatorState<N, L, Scalar, Space>& state) {
    // The norm is known before the weights are touched, so that they are shrunk on the way.
    const Scalar margin = rounding_allowance<L, Scalar>(Scalar(1));
    const Scalar most = products_.squared_norm(theta, begin_.theta_squared_norm) + margin * reach;
    const Scalar to_ball = std::sqrt(radius_squared_ * (Scalar(1) - margin) / most);
    const Scalar shrink = most > radius_squared_ ? to_ball : Scalar(1);
    theta.keep *= shrink;
    for (Scalar& gain : theta.gain) gain *= shrink;
    Matrix<N, kStages, Scalar> share;
    const Eigen::Index joints = d_[0].size();
    share.resize(joints, kStages);
    repeat<kStages>([&](int j) __attribute__((always_inline)) {
      const auto stage = static_cast<std::size_t>(j);
      repeat<N>(
          joints, [&](int k) __attribute__((always_inline)) {
            share(k, j) = theta.gain[stage] * d_[stage][k];
          });
    });
    const MovedWeights<N, Scalar> moved =
        move_weights<N, L, Scalar>(theta, share, w1_z_.at_end, state.z, input_.z, z_.z01, z_.z11,
                                   factors_, state.weights, state.w1_z, state.sigma);
    state.theta_squared_norm = moved.squared_norm;
    state.psi_hat = moved.psi_hat;
    state.z_squared_norm = z_.z11;
  }

 private:
  struct NoJoints {};

  // One stage, from `at` to `next`, but for the last. z_z[j] = z_j . z_s for the stages j before,
  // zz = |z_s|^2.
  template <int S, typename Measured>
  EIGEN_ALWAYS_INLINE void stage(const Signals& signals, const Measured& next_y,
                                 const std::array<Scalar, kStages>& z_z, Scalar zz, Scalar advance,
                                 Scalar weight, const Point& at, Point& next, End& sum) {
    std::array<Scalar, kStages> kappa{};
    repeat<S>([&](int i) __attribute__((always_inline)) {
      const auto j = static_cast<std::size_t>(i);
      kappa[j] = at.theta.gain[j] * z_z[j];
    });
    const StageOutput<N, Scalar> output = network_output_at<S>(kappa, at);
    const Eigen::Index joints = at.e.size();
    if constexpr (N == kRuntimeJoints) next.e.resize(joints);
    repeat<N>(
        joints, [&](int i) __attribute__((always_inline)) {
          const Scalar omega_dot =
              config_.alpha * at.e[i] + signals.nominal_rate[i] + output.psi_hat[i];
          sum.omega[i] += weight * omega_dot;
          if constexpr (S + 1 < kStages) {
            next.e[i] = next_y[i] - (begin_.omega[i] + advance * omega_dot);
          }
        });
    advance_threshold<S>(signals.mu_bar, at.mu, advance, weight, next.mu, sum.mu);
    if constexpr (S + 1 < kStages) {
      Vector<N, Scalar>& next_d = d_[static_cast<std::size_t>(S) + 1];
      next_d = dead_zone<N, Scalar>(next.e, next.mu, config_.dead_zone, largest_d_);
      if constexpr (kPerJoint) {
        repeat<N>(
            joints, [&](int i) __attribute__((always_inline)) { next_d[i] *= learns_[i]; });
      }
    }
    learn<S>(gradient_at<S>(z_z, kappa, zz, at, output), at, advance, weight, next, sum);
  }

  // The threshold's part of a stage.
  template <int S>
  EIGEN_ALWAYS_INLINE void advance_threshold(const Threshold& mu_bar, const Threshold& at,
                                             Scalar advance, Scalar weight, Threshold& next,
                                             Threshold& sum) const {
    const auto move = [&](Scalar bound, Scalar mu, Scalar begin, Scalar & to, Scalar & end)
        __attribute__((always_inline)) {
      const Scalar mu_dot = bound - config_.alpha * mu;
      end += weight * mu_dot;
      if constexpr (S + 1 < kStages) to = begin + advance * mu_dot;
    };
    if constexpr (kPerJoint) {
      if constexpr (N == kRuntimeJoints) next.resize(at.size());
      repeat<N>(
          at.size(), [&](int i) __attribute__((always_inline)) {
            move(mu_bar[i], at[i], begin_.mu[i], next[i], sum[i]);
          });
    } else {
      move(mu_bar, at, begin_.mu, next, sum);
    }
  }

  // psi_hat at a stage; needs the directions d of the stages before.
  template <int S>
  EIGEN_ALWAYS_INLINE StageOutput<N, Scalar> network_output_at(
      const std::array<Scalar, kStages>& kappa, const Point& at) {
    if constexpr (S == 0) {
      return {begin_.psi_hat, begin_.psi_hat, {}};
    } else {
      const SigmaSums<N, Scalar> sums =
          sigma_pass<S, N, L, Scalar>(w1_z_, begin_.weights, at.theta.keep, kappa, factors_);
      StageOutput<N, Scalar> output{at.theta.keep * sums.w2_sigma, sums.w2_sigma, sums.before};
      repeat<S>([&](int i) __attribute__((always_inline)) {
        const auto j = static_cast<std::size_t>(i);
        output.psi_hat += (at.theta.gain[j] * sums.before[j]) * d_[j];
      });
      return output;
    }
  }

  // The inner products of a stage's gradient, with those before too; its factors stay in factors_.
  template <int S>
  EIGEN_ALWAYS_INLINE GradientProducts<Scalar> gradient_at(const std::array<Scalar, kStages>& z_z,
                                                           const std::array<Scalar, kStages>& kappa,
                                                           Scalar zz, const Point& at,
                                                           const StageOutput<N, Scalar>& output) {
    constexpr auto s = static_cast<std::size_t>(S);
    const Vector<N, Scalar>& d = d_[s];
    std::array<Scalar, kStages> d_d{};
    std::array<Scalar, kStages> nu{};
    repeat<S>([&](int i) __attribute__((always_inline)) {
      const auto j = static_cast<std::size_t>(i);
      d_d[j] = dot(d_[j], d);
      nu[j] = Scalar(0.5) * at.theta.gain[j] * d_d[j];
    });
    const GradientSums<Scalar> sums = gradient_pass<S, N, L, Scalar>(
        w1_z_, begin_.weights, (Scalar(0.5) * at.theta.keep) * d, nu, factors_);
    const Scalar w2_squared = sums.sigma_squared * squared_length(d);
    gradient_reach_[s] = sums.b_squared * (z_.z00 + z_.z11) + w2_squared;
    Scalar with_w1 = at.theta.keep * sums.with_begin;
    repeat<S>([&](int i) __attribute__((always_inline)) {
      const auto j = static_cast<std::size_t>(i);
      with_w1 += kappa[j] * sums.with_b[j];
      products_.pairs[s][j] = sums.with_b[j] * z_z[j] + output.with_sigma[j] * d_d[j];
    });
    products_.of_stage[s] = {sums.with_begin + dot(d, output.with_w2_begin),
                             with_w1 + dot(d, output.psi_hat), sums.b_squared * zz + w2_squared};
    return products_.of_stage[s];
  }

  // Moves theta's coordinates along a stage's gradient, less the pull of projection.
  template <int S>
  EIGEN_ALWAYS_INLINE void learn(const GradientProducts<Scalar>& gradient, const Point& at,
                                 Scalar advance, Scalar weight, Point& next, End& sum) const {
    constexpr auto s = static_cast<std::size_t>(S);
    const Scalar pull =
        projection_rate(at.norms.squared) * Eigen::numext::maxi(gradient.with_theta, Scalar(0));
    const Scalar step = weight * rate_;
    const Scalar step_pull = step * pull;
    sum.theta.keep -= step_pull * at.theta.keep;
    repeat<S>([&](int i) __attribute__((always_inline)) {
      const auto j = static_cast<std::size_t>(i);
      sum.theta.gain[j] -= step_pull * at.theta.gain[j];
    });
    sum.theta.gain[s] = step;
    if constexpr (S + 1 < kStages) {
      const Scalar move = advance * rate_;
      next.theta = moved<S>(at.theta, move, pull);
      next.norms = moved(at.norms, gradient, begin_.theta_squared_norm, move, pull);
    }
  }

  // The pull of projection, eq. (9) with scalar Gamma, is <theta, g> / |theta|^2 where |theta| has
  // reached M and the gradient points outwards: this rate times the outward part of <theta, g>.
  [[nodiscard]] EIGEN_ALWAYS_INLINE Scalar projection_rate(Scalar norm) const {
    // Shrinking leaves |theta| below M by the rounding allowance; that still counts as on the ball.
    const bool on_ball = norm + Scalar(4) * rounding_allowance<L, Scalar>(norm) >= radius_squared_;
    const Scalar inverse = Scalar(1) / norm;
    return on_ball ? inverse : Scalar(0);
  }

  const EstimatorConfig<Scalar>& config_;
  const TickBegin<N, Scalar, Space>& model_;
  const EstimatorInput<N, Scalar, Space>& input_;
  const EstimatorState<N, L, Scalar, Space>& begin_;
  Scalar largest_d_{};
  Scalar rate_{};  // of learning, in this tick
  // The same for each joint, 0 or 1, where each has its own dead-zone.
  [[no_unique_address]] std::conditional_t<kPerJoint, Vector<N, Scalar>, NoJoints> learns_{};
  Scalar radius_squared_{};
  InputProducts<Scalar> z_;
  StageFactors<L, Scalar> factors_;
  FirstLayer<L, Scalar> w1_z_;  // lies in part in factors_
  std::array<Vector<N, Scalar>, kStages> d_;
  std::array<Scalar, kStages> gradient_reach_{};
  SpanProducts<Scalar> products_;
};

}  // namespace offnominal::detail
