#pragma once

#include <offnominal/control/computed_torque.hpp>
#include <offnominal/model/rigid_body_model.hpp>

// The way from where an arm is when a controller takes hold of it to where its reference is: what
// is between the two fades out of the reference along polynomials of fifth order. The reference
// that comes of it begins with the arm's own position and velocity, ends in the one that was asked
// for, and its velocity and acceleration are its derivatives all the way.

namespace offnominal {

// The reference less the arm, at time 0.
template <int N, typename Scalar>
struct ReferenceRamp {
  Vector<N, Scalar> q = zeros<N, Scalar>();   // rad or m
  Vector<N, Scalar> dq = zeros<N, Scalar>();  // rad/s or m/s
};

// Takes off `reference` what is left of the ramp at time_s of its ramp_s > 0; nothing from its end
// on.
template <int N, typename Scalar>
void ramp_in(const ReferenceRamp<N, Scalar>& ramp, double time_s, Scalar ramp_s,
             Reference<N, Scalar>& reference) {
  if (time_s >= static_cast<double>(ramp_s)) return;
  const Scalar s = static_cast<Scalar>(time_s) / ramp_s;
  const Scalar left = 1 - s;
  const Scalar cube = left * left * left;
  // Of a position: 1, 0, 0 at the beginning, 0, 0, 0 at the end. Of a velocity, in its ramp_s:
  // 0, 1, 0 and 0, 0, 0.
  const Scalar q_of_q = cube * (1 + 3 * s + 6 * s * s);
  const Scalar dq_of_q = -30 * s * s * left * left;
  const Scalar ddq_of_q = -60 * s * left * (1 - 2 * s);
  const Scalar q_of_dq = s * cube * (1 + 3 * s);
  const Scalar dq_of_dq = left * left * (1 + 2 * s - 15 * s * s);
  const Scalar ddq_of_dq = -12 * s * left * (3 - 5 * s);
  reference.q -= q_of_q * ramp.q + (q_of_dq * ramp_s) * ramp.dq;
  reference.dq -= (dq_of_q / ramp_s) * ramp.q + dq_of_dq * ramp.dq;
  reference.ddq -= (ddq_of_q / (ramp_s * ramp_s)) * ramp.q + (ddq_of_dq / ramp_s) * ramp.dq;
}

}  // namespace offnominal
