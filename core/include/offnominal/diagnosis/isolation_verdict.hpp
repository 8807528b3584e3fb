#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <offnominal/diagnosis/isolation_contest.hpp>
#include <offnominal/diagnosis/isolation_scales.hpp>
#include <offnominal/diagnosis/isolation_state.hpp>

// Which hypothesis the evidence speaks for. Each has a prior probability and the evidence of its
// regression, or of an arbitrary torque on the joints that it acts on; the posterior is their
// share. A hypothesis whose kind needs an event of the encoder is there only with the event.

namespace offnominal {

// Of encoders, in ticks.
template <typename Scalar>
struct EncoderTimes {
  std::uint32_t odd_after = 0;  // of a position that does not change while others do
  std::uint32_t since = 0;      // the detection, which what stopped before has caused
  std::uint32_t ahead = 0;     // that a velocity which was smoothed both ways may tell of it before
  std::uint32_t braking = 0;   // that a joint which is locked may take until it stands
  std::uint32_t within = 0;    // since the earliest event that counts
  Scalar history{};            // that a joint has to be known for
  std::uint32_t standing = 1;  // joints that stand oddly
};

namespace detail {

// Prior probabilities; of kinds of one joint shared by all joints.
inline constexpr double kPriorFriction = 0.25;
inline constexpr double kPriorLostTorque = 0.25;
inline constexpr double kPriorOffset = 0.05;
inline constexpr double kPriorPayload = 0.2;
inline constexpr double kPriorContact = 0.2;
inline constexpr double kPriorUnknown = 0.01;
// That nothing is to be seen of it yet, in odds: before there is evidence, no kind is named.
inline constexpr double kPriorNothing = 1;
// A hypothesis has to explain at least this share of what an arbitrary torque on each joint does.
inline constexpr double kLeastExplained = 0.7;
// Nats that a contact loses by going on, from which it is taken for over.
inline constexpr double kOver = 5;
// Nats that an event of the encoder brings: what no motion does, and what is merely odd.
inline constexpr double kImpossible = 15;
inline constexpr double kOdd = -3;
inline constexpr double kNeverBefore = 1;  // and more, the longer the joint is known
inline constexpr double kWithinOneTick = 2;
inline constexpr double kNotACount = 2;
inline constexpr double kForced = 8;

// What the encoder of a joint says: nats for one that sticks and for a joint that is locked, each
// where it is there at all.
template <typename Scalar>
struct StopEvidence {
  bool may_stick = false;
  bool may_lock = false;
  Scalar stuck{};
  Scalar locked{};
};

// That a joint stands for long while others move, and began to with the fault.
template <typename Scalar>
[[nodiscard]] bool stands_oddly(const Standing& standing, const EncoderTimes<Scalar>& times) {
  return standing.alone >= times.odd_after && standing.alone <= times.within;
}

// Nats of that: little, unless it is the only one that does and never stood for so long before.
template <typename Scalar>
[[nodiscard]] Scalar standing_evidence(const Standing& standing, std::uint32_t known_for,
                                       const EncoderTimes<Scalar>& times) {
  if (times.standing > 1 || standing.alone <= 2 * standing.longest_alone) {
    return static_cast<Scalar>(kOdd);
  }
  constexpr auto kLonger = static_cast<Scalar>(3);  // at most, that it goes on
  const Scalar longer = static_cast<Scalar>(standing.alone) /
                            static_cast<Scalar>(standing.longest_alone + times.odd_after) -
                        1;
  return static_cast<Scalar>(kNeverBefore) +
         std::log1p(static_cast<Scalar>(known_for) / times.history) +
         std::clamp(longer, Scalar(0), kLonger);
}

template <typename Scalar>
[[nodiscard]] StopEvidence<Scalar> stop_evidence(const EncoderWatch<Scalar>& watch,
                                                 const EncoderTimes<Scalar>& times) {
  if (watch.steps == 0) return {};
  const bool stuck = watch.still >= times.since - std::min(times.since, times.ahead);
  const std::uint32_t locked_for = times.since - std::min(times.since, times.braking);
  StopEvidence<Scalar> stop;
  if (watch.stopped && watch.still >= kEncoderLag) {
    const auto sooner =
        static_cast<Scalar>(watch.stopped_at_once ? kWithinOneTick : -kWithinOneTick);
    stop.may_stick = stuck;
    stop.may_lock = watch.still >= locked_for;
    stop.stuck = static_cast<Scalar>(kImpossible) + sooner;
    stop.locked = static_cast<Scalar>(kImpossible) - sooner;
    if (stop.may_lock) return stop;
  }
  stop.may_stick = stuck && stands_oddly(watch.exact, times);
  stop.may_lock = watch.slow_for >= locked_for && stands_oddly(watch.slow, times);
  if (stop.may_stick) stop.stuck = standing_evidence(watch.exact, watch.known_for, times);
  if (stop.may_lock) stop.locked = standing_evidence(watch.slow, watch.known_for, times);
  // What is locked gives way under a torque that changes, by a count of a fine encoder.
  if (stop.may_stick) stop.locked -= static_cast<Scalar>(kNotACount);
  return stop;
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

// Nats that a size costs which is beyond what there can be, `most`: the size that is possible fits
// worse by so many.
template <typename Scalar>
[[nodiscard]] Scalar beyond(Scalar size, Scalar most, Scalar variance) {
  constexpr auto kTolerance = static_cast<Scalar>(1.1);
  const Scalar off = size - kTolerance * most;
  return off > 0 ? -off * off / (2 * variance) : Scalar(0);
}

// Whether a joint's friction, the model's and `more`, N m or N, holds it against a torque.
template <int N, typename Scalar>
[[nodiscard]] bool holds(Scalar torque, Scalar more, std::size_t joint,
                         const IsolationScales<N, Scalar>& scales) {
  constexpr auto kUncertain = static_cast<Scalar>(1.5);
  return Eigen::numext::abs(torque) < kUncertain * (more + scales.friction[joint].holding);
}

// Of the evidence for a hypothesis what counts where its torque on a joint, at most `largest`, was
// never near the threshold that was crossed, or where another joint's was: an error of the model,
// not the fault.
template <int N, typename Scalar>
[[nodiscard]] Scalar of_alarm(Scalar evidence, Scalar largest,
                              const IsolationState<N, Scalar>& state,
                              const IsolationScales<N, Scalar>& scales, std::size_t joint) {
  constexpr auto kNear = static_cast<Scalar>(0.05);
  constexpr auto kMost = static_cast<Scalar>(10);  // nats against it
  const Scalar least = kNear * scales.thresholds[joint];
  const Scalar torque = state.alarmed[joint] ? Eigen::numext::abs(largest) : Scalar(0);
  if (!(torque < least)) return evidence;
  const Scalar share = std::max(2 * torque / least - 1, Scalar(0));
  return share * evidence - (1 - share) * kMost;
}

// Friction is dry, or dry and viscous. Less of it than the model says is rarer than more, and not
// less than none.
template <int N, typename Scalar>
void enter_friction(const IsolationState<N, Scalar>& state,
                    const IsolationScales<N, Scalar>& scales, std::size_t index,
                    Contest<Scalar>& contest) {
  const JointEvidence<Scalar>& joint = state.joints[index];
  const auto dry = fit_of(part_of<kSignRegressor>(joint.own));
  const auto both = fit_of(part_of<kSignRegressor, kVelocityRegressor>(joint.own));
  const double prior = kPriorFriction / (dry.theta[0] < 0 ? 6 : 2);
  const Scalar scale = scales.own(kSignRegressor, static_cast<Eigen::Index>(index));
  const KnownFriction<Scalar>& known = scales.friction[index];
  const Scalar most = known.dry + known.viscous * mean_speed(state, index);
  const Scalar evidence = log_sum(dry.evidence, both.evidence) +
                          beyond(-scale * dry.theta[0], most, scale * scale * dry.covariance(0, 0));
  const Scalar largest = dry.theta[0] * joint.largest_own[kSignRegressor];
  contest.enter(FaultKind::kFriction, index,
                of_alarm(evidence, largest, state, scales, index) +
                    log_prior<Scalar>(prior, state.joints.size()));
}

// No drive loses more than all of its torque.
template <int N, typename Scalar>
void enter_drive(const IsolationState<N, Scalar>& state, const IsolationScales<N, Scalar>& scales,
                 std::size_t index, Contest<Scalar>& contest) {
  const std::size_t count = state.joints.size();
  const JointEvidence<Scalar>& joint = state.joints[index];
  const auto lost = fit_of(part_of<kTorqueRegressor>(joint.own));
  const Scalar scale = scales.own(kTorqueRegressor, static_cast<Eigen::Index>(index));
  const Scalar evidence = lost.evidence + beyond(scale * lost.theta[0], Scalar(1),
                                                 scale * scale * lost.covariance(0, 0));
  const Scalar largest = lost.theta[0] * joint.largest_own[kTorqueRegressor];
  contest.enter(FaultKind::kLostTorque, index,
                of_alarm(evidence, largest, state, scales, index) +
                    log_prior<Scalar>(kPriorLostTorque, count));
  const auto offset = fit_of(part_of<kOneRegressor>(joint.own));
  const Scalar constant = offset.theta[0] * joint.largest_own[kOneRegressor];
  contest.enter(FaultKind::kOffset, index,
                of_alarm(offset.evidence, constant, state, scales, index) +
                    log_prior<Scalar>(kPriorOffset, count));
}

// Of a body on the last link that is farther than `reach_m` from its frame: nats against it.
template <typename Scalar>
[[nodiscard]] Scalar beyond_reach(const RegressionFit<kTipParameters, Scalar>& fit,
                                  const Vector<kTipParameters, Scalar>& scale, Scalar reach_m) {
  const Vector<kTipParameters, Scalar> body = scale.cwiseProduct(fit.theta);
  const Scalar moment = body.template tail<3>().norm();
  if (!(moment > 0)) return Scalar(0);
  Vector<kTipParameters, Scalar> off;  // of moment - reach * mass, per parameter
  off << (body[0] < 0 ? reach_m : -reach_m), body.template tail<3>() / moment;
  off = off.cwiseProduct(scale);
  constexpr auto kRounding = static_cast<Scalar>(1e-6);
  const Scalar least = kRounding * off.squaredNorm() * fit.covariance.trace();
  const Scalar variance = std::max(off.dot(fit.covariance.lazyProduct(off)), least);
  return beyond(moment, reach_m * Eigen::numext::abs(body[0]), variance);
}

// Of a payload that is lost no more than the last link has.
template <int N, typename Scalar>
void enter_payload(const IsolationState<N, Scalar>& state, const IsolationScales<N, Scalar>& scales,
                   Contest<Scalar>& contest) {
  const auto fit = fit_of(state.tip);
  const Scalar scale = scales.tip[0];
  contest.enter(
      FaultKind::kPayload, state.joints.size() - 1,
      fit.evidence +
          beyond(-scale * fit.theta[0], scales.last_mass, scale * scale * fit.covariance(0, 0)) +
          beyond_reach(fit, scales.tip, scales.reach_m) + log_prior<Scalar>(kPriorPayload, 1));
}

// More friction holds a joint that stands, against no more than itself. `stands`: nats of that it
// does.
template <int N, typename Scalar>
void enter_holding_friction(const IsolationState<N, Scalar>& state,
                            const IsolationScales<N, Scalar>& scales, std::size_t index,
                            Scalar stands, Contest<Scalar>& contest) {
  const JointEvidence<Scalar>& joint = state.joints[index];
  const Scalar more = std::max(joint.held.evidence, Scalar(0)) + std::max(stands, Scalar(0));
  if (!(more > 0) || !state.alarmed[index]) return;
  const auto dry = fit_of(part_of<kSignRegressor>(joint.own));
  const Scalar size = scales.own(kSignRegressor, static_cast<Eigen::Index>(index)) * dry.theta[0];
  if (!(size > 0) || !holds(joint.largest_held, size, index, scales)) return;
  contest.enter(FaultKind::kFriction, index,
                dry.evidence + more + log_prior<Scalar>(kPriorFriction / 2, state.joints.size()));
}

// Whether the others would feel a joint that runs away, of the joint-space inertia M: its momentum
// on them is M_ji dq_i, and a residual alpha times that.
template <int N, typename Scalar>
[[nodiscard]] bool runs_away_felt(const Matrix<N, N, Scalar>& inertia, std::size_t index,
                                  const IsolationScales<N, Scalar>& scales) {
  constexpr auto kRunsAway = static_cast<Scalar>(2);  // times its largest velocity
  const auto column = static_cast<Eigen::Index>(index);
  for (Eigen::Index j = 0; j < inertia.rows(); ++j) {
    const Scalar residual =
        scales.alpha * kRunsAway * scales.speeds[index] * Eigen::numext::abs(inertia(j, column));
    if (j != column && residual > scales.thresholds[static_cast<std::size_t>(j)]) return true;
  }
  return false;
}

// What an encoder says that sticks or jumps fits no model of the arm: it is as good as the best of
// the others, `best`, and the event decides. A locked joint is one that alone has an unknown
// torque; `chosen`: the evidence for any joints that have one.
template <int N, typename Scalar>
void enter_encoder(const IsolationState<N, Scalar>& state, const IsolationScales<N, Scalar>& scales,
                   std::size_t index, bool felt, Scalar chosen, Scalar best,
                   const EncoderTimes<Scalar>& times, Contest<Scalar>& contest) {
  const EncoderWatch<Scalar>& watch = state.encoders[index];
  const JointEvidence<Scalar>& joint = state.joints[index];
  if (watch.since_jump <= times.within) {
    contest.enter(FaultKind::kEncoderJump, index, best + static_cast<Scalar>(kImpossible));
  }
  const StopEvidence<Scalar> stop = stop_evidence(watch, times);
  if (stop.may_stick) contest.enter(FaultKind::kEncoderStuck, index, best + stop.stuck);
  // Held against more than any motion took: an encoder that sticks leaves the joint to run away,
  // and the others to feel it.
  const Scalar held = Eigen::numext::abs(joint.largest_held);
  const bool forced = felt && held > Scalar(1.5) * state.baselines[index].largest_told;
  const Scalar locked = stop.locked + static_cast<Scalar>(forced ? kForced : 0.0);
  enter_holding_friction(state, scales, index, stop.may_lock ? locked : Scalar(0), contest);
  if (!stop.may_lock || (!stop.may_stick && held < scales.friction[index].holding)) return;
  const Scalar alone = std::min(joint.any.evidence - chosen, Scalar(0));
  contest.enter(FaultKind::kLockedJoint, index, best + locked + alone);
}

// Joints that stand although others move.
template <int N, typename Scalar>
[[nodiscard]] std::uint32_t standing_joints(const IsolationState<N, Scalar>& state,
                                            const EncoderTimes<Scalar>& times) {
  std::uint32_t standing = 0;
  for (const EncoderWatch<Scalar>& watch : state.encoders) {
    standing += stands_oddly(watch.slow, times) ? 1U : 0U;
  }
  return standing;
}

// What the hypotheses of encoders stand against: the evidence for any torque on some of the joints.
template <typename Scalar>
struct AnyTorques {
  Scalar chosen{};    // until now
  Scalar anything{};  // the same, or until some earlier time
};

template <int N, typename Scalar>
[[nodiscard]] AnyTorques<Scalar> any_torques(const IsolationState<N, Scalar>& state) {
  AnyTorques<Scalar> any;
  const Scalar half = std::log(Scalar(0.5));
  for (const JointEvidence<Scalar>& joint : state.joints) {
    any.chosen += half + log_sum(joint.any.evidence, Scalar(0));
    any.anything = std::max(any.anything, joint.contact);
  }
  any.anything = std::max(any.anything, any.chosen);
  return any;
}

// A verdict is reached in parts: first what is of no one joint, then of each joint what is no event
// of its encoder, in the end what is. All of the same evidence, but each as soon as there is time.
template <int N, typename Scalar>
[[nodiscard]] Contest<Scalar> begin_contest(const IsolationState<N, Scalar>& state,
                                            const IsolationScales<N, Scalar>& scales) {
  Contest<Scalar> contest;
  const Scalar chosen = std::max(any_torques(state).chosen, Scalar(0));
  const Scalar other =
      static_cast<Scalar>(kLeastExplained) * chosen + log_prior<Scalar>(kPriorUnknown, 1);
  contest.enter(FaultKind::kUnknown, 0, log_sum(other, log_prior<Scalar>(kPriorNothing, 1)));
  enter_payload(state, scales, contest);
  enter_contacts(state, contest);
  return contest;
}

template <int N, typename Scalar>
void enter_joint(const IsolationState<N, Scalar>& state, const IsolationScales<N, Scalar>& scales,
                 std::size_t index, Contest<Scalar>& contest) {
  enter_friction(state, scales, index, contest);
  enter_drive(state, scales, index, contest);
}

// `felt`: as runs_away_felt() says, of each joint.
template <int N, typename Scalar>
void enter_encoders(const IsolationState<N, Scalar>& state,
                    const IsolationScales<N, Scalar>& scales, EncoderTimes<Scalar> times,
                    const PerJoint<N, bool>& felt, Contest<Scalar>& contest) {
  const AnyTorques<Scalar> any = any_torques(state);
  const Scalar best = std::max(any.anything, contest.best);
  times.standing = standing_joints(state, times);
  for (std::size_t i = 0; i < state.joints.size(); ++i) {
    enter_encoder(state, scales, i, felt[i], any.chosen, best, times, contest);
  }
}

}  // namespace detail
}  // namespace offnominal
