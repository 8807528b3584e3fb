#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <offnominal/diagnosis/isolation_state.hpp>

// Which hypothesis the evidence speaks for. Each has a prior probability and the evidence of its
// regression, or of an arbitrary torque on the joints that it acts on; the posterior is their
// share. A hypothesis whose kind needs an event of the encoder is there only with the event.

namespace offnominal {

// Sizes that turn scaled parameters into units; constants of a robot.
template <int N, typename Scalar>
struct IsolationScales {
  OwnValues<N, Scalar> own = no_values<OwnValues<N, Scalar>>();
  Vector<kTipParameters, Scalar> tip = Vector<kTipParameters, Scalar>::Ones();
};

// The best of the hypotheses and the sum over all, in one way through them.
template <typename Scalar>
struct Contest {
  FaultKind kind = FaultKind::kUnknown;
  std::uint8_t joint = 0;
  Scalar best = -std::numeric_limits<Scalar>::infinity();  // log of prior times evidence
  Scalar total = Scalar(0);                                // of all, over that of the best

  void enter(FaultKind of, std::size_t on, Scalar logarithm) {
    if (logarithm > best) {
      total = total * std::exp(best - logarithm) + Scalar(1);
      best = logarithm;
      kind = of;
      joint = static_cast<std::uint8_t>(on);
    } else {
      total += std::exp(logarithm - best);
    }
  }
  [[nodiscard]] Scalar share() const { return Scalar(1) / total; }
};

namespace detail {

// Prior probabilities; of kinds of one joint shared by all joints.
inline constexpr double kPriorFriction = 0.25;
inline constexpr double kPriorLostTorque = 0.25;
inline constexpr double kPriorOffset = 0.05;
inline constexpr double kPriorPayload = 0.2;
inline constexpr double kPriorContact = 0.2;
inline constexpr double kPriorUnknown = 0.01;
inline constexpr double kPriorNothing = 0.04;
// A hypothesis has to explain at least this share of what an arbitrary torque on each joint does.
inline constexpr double kLeastExplained = 0.7;
// Nats that a contact loses by going on, from which it is taken for over.
inline constexpr double kOver = 5;
// Nats that an event of the encoder brings: what no motion does, and what is merely odd.
inline constexpr double kImpossible = 15;
inline constexpr double kOdd = -3;
inline constexpr double kWithinOneTick = 2;

// What the encoder of a joint says: nats for one that sticks and for a joint that is locked, or
// none of either.
template <typename Scalar>
struct StopEvidence {
  bool is_there = false;
  Scalar stuck{};
  Scalar locked{};
};

template <int N, typename Scalar>
[[nodiscard]] StopEvidence<Scalar> stop_evidence(const IsolationState<N, Scalar>& state,
                                                 std::size_t joint, std::uint32_t odd_after,
                                                 std::uint32_t within) {
  const EncoderWatch<Scalar>& watch = state.encoders[joint];
  if (watch.still < kEncoderLag || !watch.moved) return {};
  if (watch.stopped) {
    const auto sooner =
        static_cast<Scalar>(watch.stopped_at_once ? kWithinOneTick : -kWithinOneTick);
    return {true, static_cast<Scalar>(kImpossible) + sooner,
            static_cast<Scalar>(kImpossible) - sooner};
  }
  bool others_move = false;
  for (std::size_t i = 0; i < state.encoders.size(); ++i) {
    others_move = others_move || (i != joint && state.encoders[i].still < kEncoderLag);
  }
  if (!others_move || watch.still < odd_after || watch.still > within) return {};
  return {true, static_cast<Scalar>(kOdd), static_cast<Scalar>(kOdd)};
}

template <typename Scalar>
[[nodiscard]] Scalar log_prior(double probability, std::size_t joints) {
  return static_cast<Scalar>(std::log(probability / static_cast<double>(joints)));
}

// log(e^a + e^b)
template <typename Scalar>
[[nodiscard]] Scalar log_sum(Scalar a, Scalar b) {
  const Scalar larger = std::max(a, b);
  return larger + std::log1p(std::exp(std::min(a, b) - larger));
}

// Torques on a joint and those before it, none behind: of a push on that link, wherever and
// however, until now. Joints before it may happen to feel nothing. Kept where it is the likeliest
// end of the contact so far.
template <int N, typename Scalar>
void follow_contacts(IsolationState<N, Scalar>& state) {
  constexpr auto kFeelsIt = static_cast<Scalar>(0.9);
  Scalar before{};
  for (JointEvidence<Scalar>& joint : state.joints) {
    const Scalar here = before + joint.any.evidence;
    if (state.blocks <= 2 || here > joint.contact) joint.contact = here;
    joint.contact_ended = here < joint.contact - static_cast<Scalar>(kOver);
    before += log_sum(std::log(kFeelsIt) + joint.any.evidence, std::log(1 - kFeelsIt));
  }
}

// One entry, of the likeliest link, with the weight of all. A push that goes on can be anything: it
// has to leave no hypothesis that explains the stated share.
template <int N, typename Scalar>
void enter_contacts(const IsolationState<N, Scalar>& state, Contest<Scalar>& contest) {
  const std::size_t count = state.joints.size();
  Scalar best{};
  Scalar all{};
  std::size_t link = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const JointEvidence<Scalar>& joint = state.joints[i];
    const bool goes_on = !joint.contact_ended && joint.contact > 0;
    const Scalar here =
        (goes_on ? static_cast<Scalar>(kLeastExplained) : Scalar(1)) * joint.contact;
    if (i == 0 || here > best) {
      best = here;
      link = i;
    }
    all = i == 0 ? here : log_sum(all, here);
  }
  const auto ends = static_cast<Scalar>(std::max(state.blocks, std::uint32_t{1}));
  contest.enter(FaultKind::kContact, link,
                all - std::log(ends) + log_prior<Scalar>(kPriorContact, count));
}

// Friction is dry, or dry and viscous. Less of it than the model says is rarer than more.
template <typename Scalar>
void enter_own(const JointEvidence<Scalar>& joint, std::size_t index, std::size_t count,
               Contest<Scalar>& contest) {
  const auto dry = fit_of(part_of<kSignRegressor>(joint.own));
  const auto both = fit_of(part_of<kSignRegressor, kVelocityRegressor>(joint.own));
  const double prior = kPriorFriction / (dry.theta[0] < 0 ? 6 : 2);
  contest.enter(FaultKind::kFriction, index,
                log_sum(dry.evidence, both.evidence) + log_prior<Scalar>(prior, count));
  contest.enter(FaultKind::kLostTorque, index,
                fit_of(part_of<kTorqueRegressor>(joint.own)).evidence +
                    log_prior<Scalar>(kPriorLostTorque, count));
  contest.enter(
      FaultKind::kOffset, index,
      fit_of(part_of<kOneRegressor>(joint.own)).evidence + log_prior<Scalar>(kPriorOffset, count));
}

// More friction holds a joint that stands still against what is not much more than it.
template <int N, typename Scalar>
void enter_holding_friction(const IsolationState<N, Scalar>& state,
                            const IsolationScales<N, Scalar>& scales, Contest<Scalar>& contest) {
  constexpr auto kHolds = static_cast<Scalar>(1.5);
  const std::size_t count = state.joints.size();
  for (std::size_t i = 0; i < count; ++i) {
    const JointEvidence<Scalar>& joint = state.joints[i];
    const auto dry = fit_of(part_of<kSignRegressor>(joint.own));
    const Scalar size = scales.own(kSignRegressor, static_cast<Eigen::Index>(i)) * dry.theta[0];
    if (!(joint.held.evidence > 0) || !(Eigen::numext::abs(joint.largest_held) < kHolds * size))
      continue;
    contest.enter(
        FaultKind::kFriction, i,
        dry.evidence + joint.held.evidence + log_prior<Scalar>(kPriorFriction / 2, count));
  }
}

// What an encoder says that sticks or jumps fits no model of the arm: it is as good as the best of
// the others, `best`, and the event decides, with what is seen of the joint while it stands. A
// locked joint is one that alone has an unknown torque; `chosen`: the evidence for any joints that
// have one.
template <int N, typename Scalar>
void enter_encoders(const IsolationState<N, Scalar>& state, Scalar chosen, Scalar best,
                    std::uint32_t odd_after, std::uint32_t within, Contest<Scalar>& contest) {
  for (std::size_t i = 0; i < state.joints.size(); ++i) {
    if (state.encoders[i].since_jump <= within) {
      contest.enter(FaultKind::kEncoderJump, i, best + static_cast<Scalar>(kImpossible));
    }
    const StopEvidence<Scalar> stop = stop_evidence(state, i, odd_after, within);
    if (!stop.is_there) continue;
    const Scalar held = std::max(state.joints[i].held.evidence, Scalar(0));
    contest.enter(FaultKind::kEncoderStuck, i, best + stop.stuck + held);
    contest.enter(FaultKind::kLockedJoint, i,
                  best + stop.locked + held + state.joints[i].any.evidence - chosen);
  }
}

// Samples: `within` since the earliest event of an encoder that counts; `odd_after` of a position
// that does not change while others do, which may be one that sticks.
template <int N, typename Scalar>
[[nodiscard]] Contest<Scalar> contest_of(const IsolationState<N, Scalar>& state,
                                         const IsolationScales<N, Scalar>& scales,
                                         std::uint32_t odd_after, std::uint32_t within) {
  const std::size_t count = state.joints.size();
  Contest<Scalar> contest;
  Scalar chosen{};    // any torque on some of the joints, until now
  Scalar anything{};  // the same, or until some earlier time
  const Scalar half = std::log(Scalar(0.5));
  for (const JointEvidence<Scalar>& joint : state.joints) {
    chosen += half + log_sum(joint.any.evidence, Scalar(0));
    anything = std::max(anything, joint.contact);
  }
  anything = std::max(anything, chosen);
  contest.enter(FaultKind::kUnknown, 0,
                static_cast<Scalar>(kLeastExplained) * std::max(chosen, Scalar(0)) +
                    log_prior<Scalar>(kPriorUnknown, 1));
  contest.enter(FaultKind::kUnknown, 0, log_prior<Scalar>(kPriorNothing, 1));
  contest.enter(FaultKind::kPayload, count - 1,
                fit_of(state.tip).evidence + log_prior<Scalar>(kPriorPayload, 1));
  enter_contacts(state, contest);
  for (std::size_t i = 0; i < count; ++i) enter_own(state.joints[i], i, count, contest);
  const Scalar best = std::max(anything, contest.best);
  enter_holding_friction(state, scales, contest);
  enter_encoders(state, chosen, best, odd_after, within, contest);
  return contest;
}

// Size, deviation and what it explains of the squares, of the hypothesis that is told.
template <int N, typename Scalar>
struct Measure {
  Scalar size{};
  Scalar deviation{};
  Scalar explained{};
};

// Of a hypothesis of one parameter among a joint's own.
template <int Which, int N, typename Scalar>
[[nodiscard]] Measure<N, Scalar> measure_of_one(const IsolationState<N, Scalar>& state,
                                                const IsolationScales<N, Scalar>& scales,
                                                std::size_t joint) {
  const auto fit = fit_of(part_of<Which>(state.joints[joint].own));
  const Scalar scale = scales.own(Which, static_cast<Eigen::Index>(joint));
  return {scale * fit.theta[0], scale * std::sqrt(fit.covariance(0, 0)), fit.explained};
}

// Dry and viscous together, at the mean speed.
template <int N, typename Scalar>
[[nodiscard]] Measure<N, Scalar> measure_of_friction(const IsolationState<N, Scalar>& state,
                                                     const IsolationScales<N, Scalar>& scales,
                                                     std::size_t joint) {
  const JointEvidence<Scalar>& seen = state.joints[joint];
  const auto fit = fit_of(part_of<kSignRegressor, kVelocityRegressor>(seen.own));
  const auto column = static_cast<Eigen::Index>(joint);
  const Scalar speed =
      seen.speed_sum / static_cast<Scalar>(std::max(state.blocks, std::uint32_t{1}));
  const Scalar dry = scales.own(kSignRegressor, column);
  const Scalar viscous = scales.own(kVelocityRegressor, column) * speed;
  const Scalar variance = dry * dry * fit.covariance(0, 0) +
                          2 * dry * viscous * fit.covariance(0, 1) +
                          viscous * viscous * fit.covariance(1, 1);
  return {dry * fit.theta[0] + viscous * fit.theta[1], std::sqrt(variance), fit.explained};
}

// Of any torque on the joints up to `last`: the largest.
template <int N, typename Scalar>
[[nodiscard]] Measure<N, Scalar> measure_of_torque(const IsolationState<N, Scalar>& state,
                                                   std::size_t first, std::size_t last) {
  Measure<N, Scalar> measure;
  for (std::size_t i = first; i <= last; ++i) {
    const JointEvidence<Scalar>& joint = state.joints[i];
    measure.explained += joint.squares;
    if (Eigen::numext::abs(joint.largest) <= Eigen::numext::abs(measure.size)) continue;
    measure.size = joint.largest;
    measure.deviation = std::sqrt(joint.any.variance);
  }
  return measure;
}

template <int N, typename Scalar>
[[nodiscard]] Measure<N, Scalar> measure_of(const IsolationState<N, Scalar>& state,
                                            const IsolationScales<N, Scalar>& scales,
                                            FaultKind kind, std::size_t joint) {
  const std::size_t last = state.joints.size() - 1;
  switch (kind) {
    case FaultKind::kFriction:
      return measure_of_friction(state, scales, joint);
    case FaultKind::kLostTorque:
      return measure_of_one<kTorqueRegressor>(state, scales, joint);
    case FaultKind::kOffset:
      return measure_of_one<kOneRegressor>(state, scales, joint);
    case FaultKind::kPayload: {
      const auto fit = fit_of(state.tip);
      return {scales.tip[0] * fit.theta[0], scales.tip[0] * std::sqrt(fit.covariance(0, 0)),
              fit.explained};
    }
    case FaultKind::kContact:
      return measure_of_torque(state, 0, joint);
    case FaultKind::kLockedJoint: {
      Measure<N, Scalar> measure = measure_of_torque(state, joint, joint);
      const JointEvidence<Scalar>& seen = state.joints[joint];
      if (Eigen::numext::abs(seen.largest_held) > Eigen::numext::abs(measure.size)) {
        measure.size = seen.largest_held;
        measure.deviation = std::sqrt(seen.held.variance);
      }
      return measure;
    }
    case FaultKind::kEncoderJump: {
      Measure<N, Scalar> measure = measure_of_torque(state, 0, last);
      measure.size = state.encoders[joint].jump;
      measure.deviation = state.encoders[joint].jerk[2];
      return measure;
    }
    case FaultKind::kEncoderStuck:
    case FaultKind::kUnknown:
      break;
  }
  return {Scalar(0), Scalar(0), measure_of_torque(state, 0, last).explained};
}

}  // namespace detail
}  // namespace offnominal
