#pragma once

#include <cstring>
#include <offnominal/monitor.hpp>
#include <string>
#include <type_traits>
#include <vector>

namespace offnominal::test {

// The bytes of a state's numbers one after the other, without the padding between them: two states
// are the same bit by bit where these are equal.
class Bits {
 public:
  template <typename Derived>
  void add(const Eigen::PlainObjectBase<Derived>& values) {
    add_bytes(values.data(),
              sizeof(typename Derived::Scalar) * static_cast<std::size_t>(values.size()));
  }
  template <typename Number>
  requires std::is_arithmetic_v<Number>
  void add(Number value) { add_bytes(&value, sizeof value); }

  bool operator==(const Bits&) const = default;

 private:
  void add_bytes(const void* from, std::size_t count) {
    const std::size_t at = bytes_.size();
    bytes_.resize(at + count);
    std::memcpy(bytes_.data() + at, from, count);
  }

  std::vector<unsigned char> bytes_;
};

template <int N, int L, typename Scalar>
Bits bits_of(const NetworkWeights<N, L, Scalar>& weights) {
  Bits bits;
  bits.add(weights.w1);
  bits.add(weights.w2_transposed);
  return bits;
}

template <int N, int L, typename Scalar>
void add_bits(const EstimatorState<N, L, Scalar>& state, Bits& bits) {
  bits.add(state.weights.w1);
  bits.add(state.weights.w2_transposed);
  bits.add(state.omega);
  bits.add(state.mu);
  bits.add(state.error);
  bits.add(state.psi_hat);
  bits.add(state.z);
  bits.add(state.nominal_rate);
  bits.add(state.mu_bar);
  bits.add(state.w1_z);
  bits.add(state.sigma);
  bits.add(state.theta_squared_norm);
  bits.add(state.z_squared_norm);
}

template <int N, int L, typename Scalar>
Bits bits_of(const EstimatorState<N, L, Scalar>& state) {
  Bits bits;
  add_bits(state, bits);
  return bits;
}

template <typename Scalar>
void add_bits(const DetectorState<Scalar>& state, Bits& bits) {
  bits.add(state.level);
  bits.add(state.latched);
  bits.add(state.detection_tick);
  bits.add(state.detection_time_s);
}

template <int N, int L, typename Scalar, typename Memory>
Bits bits_of(const MonitorState<N, L, Scalar, Memory>& state) {
  Bits bits;
  bits.add(state.initialised);
  bits.add(state.tick);
  bits.add(state.sample.q);
  bits.add(state.sample.dq);
  bits.add(state.sample.tau);
  bits.add(state.inertia_factor);
  add_bits(state.estimator, bits);
  add_bits(state.detector, bits);
  if constexpr (std::is_same_v<Memory, WithMemory>) {
    bits.add(state.memory.tau);
    bits.add(state.memory.remembered);
    bits.add(state.memory.q);
    for (const Scalar z : state.memory.z) bits.add(z);
    for (const Vector<N, Scalar>& logged : state.memory.logged) bits.add(logged);
    bits.add(state.memory.newest);
  }
  return bits;
}

template <int N, typename Scalar>
Bits bits_of(const MonitorOutput<N, Scalar>& output) {
  Bits bits;
  bits.add(output.time_s);
  bits.add(output.error);
  bits.add(output.error_norm);
  bits.add(output.threshold);
  bits.add(output.psi_hat);
  add_bits(output.detector, bits);
  bits.add(output.compensation.torque);
  bits.add(output.compensation.saturated);
  return bits;
}

}  // namespace offnominal::test
