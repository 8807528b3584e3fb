#pragma once

#include <Eigen/Core>
#include <cmath>

// The estimator written down from the paper's equations (2), (4), (7), (8), (9) and nothing else:
// theta is one long vector, its derivative is formed with the dense gradient Z at every Runge-Kutta
// stage. Slow and plain, the oracle of the product's form.

namespace offnominal::test {

// The signals at one instant; inside a tick all of them are linear between its ends.
struct PlainSample {
  Eigen::VectorXd q;
  Eigen::VectorXd dq;
  Eigen::VectorXd tau;
  Eigen::VectorXd nominal;  // f(q, dq, tau)
  double mu_bar = 0;
};

inline PlainSample between(const PlainSample& a, const PlainSample& b, double part) {
  return {a.q + part * (b.q - a.q), a.dq + part * (b.dq - a.dq), a.tau + part * (b.tau - a.tau),
          a.nominal + part * (b.nominal - a.nominal), a.mu_bar + part * (b.mu_bar - a.mu_bar)};
}

struct PlainEstimator {
  int joints = 1;
  int hidden = 1;
  double period_s = 0.001;
  double alpha = 10;
  double gamma = 2.5;
  double radius = 10;
  bool continuous_dead_zone = true;
  bool learns = false;  // in the tick that runs: it began outside the dead-zone
  // |theta|^2 within this fraction of M^2 counts as on the ball: the end of a step has set it there
  // to rounding only.
  double ball_slack = 1e-13;

  Eigen::VectorXd omega;
  double mu = 0;
  Eigen::VectorXd theta;  // vec(W1^T), then vec(W2): W1 row by row, W2 column by column
  PlainSample last;

  Eigen::Index inputs() const { return 3 * joints + 1; }
  Eigen::Index weight_count() const { return (inputs() + joints) * hidden; }

  Eigen::MatrixXd w1(const Eigen::VectorXd& weights) const {
    return weights.head(inputs() * hidden).reshaped(inputs(), hidden).transpose();
  }
  Eigen::MatrixXd w2(const Eigen::VectorXd& weights) const {
    return weights.tail(joints * hidden).reshaped(joints, hidden);
  }

  Eigen::VectorXd network_input(const PlainSample& sample) const {
    Eigen::VectorXd z(inputs());
    z[0] = 1;
    for (Eigen::Index i = 0; i < joints; ++i) {
      z[1 + i] = sample.q[i];
      z[1 + joints + i] = sample.dq[i];
      z[1 + 2 * joints + i] = sample.tau[i];
    }
    return z;
  }

  Eigen::VectorXd sigma(const Eigen::VectorXd& weights, const Eigen::VectorXd& z) const {
    return (w1(weights) * z).unaryExpr([](double x) { return std::tanh(x / 2); });
  }

  Eigen::VectorXd psi_hat(const Eigen::VectorXd& weights, const Eigen::VectorXd& z) const {
    return w2(weights) * sigma(weights, z);
  }

  // Z = d psi_hat / d theta, n x p.
  Eigen::MatrixXd gradient(const Eigen::VectorXd& weights, const Eigen::VectorXd& z) const {
    const Eigen::VectorXd s = sigma(weights, z);
    const Eigen::MatrixXd out = w2(weights);
    Eigen::MatrixXd result = Eigen::MatrixXd::Zero(joints, weight_count());
    for (Eigen::Index unit = 0; unit < hidden; ++unit) {
      const double slope = (1 - s[unit] * s[unit]) / 2;
      for (Eigen::Index input = 0; input < inputs(); ++input) {
        result.col(unit * inputs() + input) = out.col(unit) * (slope * z[input]);
      }
      for (Eigen::Index joint = 0; joint < joints; ++joint) {
        result(joint, inputs() * hidden + unit * joints + joint) = s[unit];
      }
    }
    return result;
  }

  Eigen::VectorXd dead_zone(const Eigen::VectorXd& e, double threshold) const {
    const double norm = e.norm();
    if (norm <= threshold) return Eigen::VectorXd::Zero(joints);
    return continuous_dead_zone ? Eigen::VectorXd(e * (1 - threshold / norm)) : e;
  }

  // Eq. (9).
  Eigen::VectorXd projected(const Eigen::VectorXd& weights, const Eigen::VectorXd& rate) const {
    const double squared = weights.squaredNorm();
    const bool on_ball = squared >= radius * radius * (1 - ball_slack);
    const double outward = weights.dot(rate);
    if (!on_ball || outward <= 0) return rate;
    return rate - weights * (outward / squared);
  }

  // Derivative of [omega; mu; theta].
  Eigen::VectorXd derivative(const Eigen::VectorXd& state, const PlainSample& sample) const {
    const Eigen::VectorXd at_omega = state.head(joints);
    const double at_mu = state[joints];
    const Eigen::VectorXd weights = state.tail(weight_count());
    const Eigen::VectorXd z = network_input(sample);
    const Eigen::VectorXd e = sample.dq - at_omega;
    Eigen::VectorXd rate(state.size());
    rate.head(joints) =
        -alpha * at_omega + alpha * sample.dq + sample.nominal + psi_hat(weights, z);
    rate[joints] = -alpha * at_mu + sample.mu_bar;
    const double gain = learns ? gamma : 0;
    const Eigen::VectorXd learning = gain * gradient(weights, z).transpose() * dead_zone(e, at_mu);
    rate.tail(weight_count()) = projected(weights, learning);
    return rate;
  }

  void step(const PlainSample& sample) {
    const PlainSample middle = between(last, sample, 0.5);
    learns = (last.dq - omega).norm() > mu;
    Eigen::VectorXd start(joints + 1 + weight_count());
    start << omega, mu, theta;
    const double h = period_s;
    const Eigen::VectorXd k1 = derivative(start, last);
    const Eigen::VectorXd k2 = derivative(start + h / 2 * k1, middle);
    const Eigen::VectorXd k3 = derivative(start + h / 2 * k2, middle);
    const Eigen::VectorXd k4 = derivative(start + h * k3, sample);
    const Eigen::VectorXd end = start + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
    omega = end.head(joints);
    mu = end[joints];
    theta = end.tail(weight_count());
    if (theta.norm() > radius) theta *= radius / theta.norm();
    last = sample;
  }
};

}  // namespace offnominal::test
