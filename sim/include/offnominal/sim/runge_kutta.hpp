// Classical Runge-Kutta integration of order 4.
#pragma once

namespace offnominal::sim {

/// One step of dx/dt = derivative(t, x) from t to t + h. State is a vector type that adds and
/// scales; derivative returns the same type.
template <class State, class Derivative>
State runge_kutta4_step(double t, const State& x, double h, Derivative&& derivative) {
  const State k1 = derivative(t, x);
  const State k2 = derivative(t + 0.5 * h, State(x + 0.5 * h * k1));
  const State k3 = derivative(t + 0.5 * h, State(x + 0.5 * h * k2));
  const State k4 = derivative(t + h, State(x + h * k3));
  return State(x + (h / 6.0) * (k1 + 2.0 * k2 + 2.0 * k3 + k4));
}

}  // namespace offnominal::sim
