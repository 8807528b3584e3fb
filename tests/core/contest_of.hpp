#pragma once

#include <cstddef>
#include <offnominal/diagnosis/isolation_verdict.hpp>

namespace offnominal::test {

// A verdict in one go. The others feel a joint that runs away.
template <int N>
Contest<double> contest_of(const IsolationState<N, double>& state,
                           const IsolationScales<N, double>& scales,
                           const EncoderTimes<double>& times) {
  Contest<double> contest = detail::begin_contest(state, scales);
  for (std::size_t i = 0; i < N; ++i) detail::enter_joint(state, scales, i, contest);
  PerJoint<N, bool> felt{};
  for (bool& joint : felt) joint = true;
  detail::enter_encoders(state, scales, times, felt, contest);
  return contest;
}

}  // namespace offnominal::test
