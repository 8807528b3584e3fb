#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <offnominal/diagnosis/isolation_config.hpp>
#include <offnominal/diagnosis/isolation_law.hpp>
#include <offnominal/diagnosis/isolation_scales.hpp>
#include <offnominal/diagnosis/isolation_size.hpp>
#include <offnominal/diagnosis/isolation_state.hpp>
#include <offnominal/diagnosis/isolation_verdict.hpp>
#include <offnominal/monitor.hpp>
#include <offnominal/status.hpp>

// Which fault it is, once a monitor in torque space has detected one: kind, joint and size, from a
// bank of hypotheses (docs/theory.md, "Which fault it is"). Fed beside the monitor, after each of
// its ticks; a controller that does not use it pays nothing.

namespace offnominal {

// The object is the immutable part; all that changes is in IsolationState. Bounded work per tick,
// no heap.
template <int N, typename Scalar>
class Isolation {
 public:
  using State = IsolationState<N, Scalar>;
  using Sample = JointSample<N, Scalar>;
  using Output = MonitorOutput<N, Scalar, TorqueSpace>;

  // For a monitor of that configuration, which validate() has accepted. kInvalidLimit: `config`;
  // `isolation` is then unchanged.
  [[nodiscard]] static Status create(const IsolationConfig<Scalar>& config,
                                     const MonitorConfig<N, Scalar, TorqueSpace>& watched,
                                     Isolation& isolation) {
    const Status status = validate(config);
    if (status != Status::kOk) return status;
    isolation.config_ = config;
    isolation.period_s_ = watched.estimator.period_s;
    isolation.block_ticks_ = ticks_of(config.block_s, isolation.period_s_);
    const Scalar block_s = static_cast<Scalar>(isolation.block_ticks_) * isolation.period_s_;
    isolation.kept_ = std::exp(-block_s / config.baseline_s);
    isolation.contact_kept_ = std::exp(-block_s / config.contact_s);
    isolation.scales_ = scales_of(watched, config.sign_width);
    isolation.law_rates_ = {isolation.scales_.alpha,
                            1 - std::exp(-isolation.scales_.alpha * isolation.period_s_),
                            isolation.period_s_ / static_cast<Scalar>(detail::kDoubtS)};
    const std::size_t parts = watched.chain.joints.size() + 3;  // judge_part()
    isolation.parts_per_tick_ =
        static_cast<int>((parts + isolation.block_ticks_ - 1) / isolation.block_ticks_);
    return Status::kOk;
  }

  // Begins anew, as the monitor does with its own reset().
  void reset(State& state) const {
    state.started = false;
    state.newest = state.filled = state.pending = 0;
    const std::size_t count = scales_.thresholds.size();
    size_for(count, state.baselines, state.encoders, state.joints, state.alarmed);
    for (std::size_t i = 0; i < count; ++i) {
      state.encoders[i] = {};
      state.baselines[i] = {};
      const Scalar third = scales_.thresholds[i] / 3;
      state.baselines[i].variance = {third * third, scales_.thresholds[i] * scales_.thresholds[i]};
      state.baselines[i].correlation = Scalar(0.5);
    }
    forget(state);
  }

  // After each tick that the monitor has accepted: what it was given, has come to and said. `tick`
  // is MonitorState's. Where ticks are missing, the block that they fall into is left out. The
  // answer stands in state.diagnosis; it is one where its time is above 0.
  void step(const RigidBodyModel<N, Scalar>& model, const Sample& sample, std::uint64_t tick,
            const Output& output, State& state) const {
    step(model, sample, sample.q, joint_transforms(model, sample.q), tick, output, state);
  }
  // `readings`: positions as the encoders say them now, rad or m, where the sample's own are late
  // (observed_motion.hpp): an encoder that sticks or jumps does so at once. `transforms`: of the
  // sample's positions.
  void step(const RigidBodyModel<N, Scalar>& model, const Sample& sample,
            const Vector<N, Scalar>& readings, const JointTransforms<N, Scalar>& transforms,
            std::uint64_t tick, const Output& output, State& state) const {
    const std::uint64_t ticks = state.started ? tick - state.tick : 1;
    const bool gap = !state.started || ticks != 1;
    state.tick = tick;
    state.started = true;
    constexpr std::uint32_t kMost = ~std::uint32_t{0};
    watch_encoders(readings, ticks < kMost ? static_cast<std::uint32_t>(ticks) : kMost, state);
    const IsolationInstant<N, Scalar> at =
        isolation_instant<N, Scalar>(model, sample, transforms, output, scales_.friction);
    bool ended = false;
    if (gap) {
      begin_block(at, state.block);
    } else {
      add_tick(at, state.block);
      ended = state.block.ticks >= block_ticks_;
    }
    if (ended) {
      push(finished(state.block, scales_.alpha, period_s_), state);
      begin_block(at, state.block);
    }
    if (!output.detector.latched) {
      if (state.triggered) forget(state);
      return;
    }
    // Cleared and latched anew in between: another one.
    if (state.triggered && state.detection_tick != output.detector.detection_tick) forget(state);
    if (!state.triggered) {
      state.triggered = true;
      state.detection_tick = output.detector.detection_tick;
    }
    if (state.diagnosis.decided) {
      if (state.law.known) follow_law(at, scales_.thresholds, law_rates_, state.law);
      return;
    }
    for (int i = 0; i < parts_per_tick_ && state.judging; ++i) judge_part(model, sample.q, state);
    if (state.diagnosis.decided) {
      state.law = detail::law_of(state, scales_, config_.confidence);
      if (state.law.known) begin_law(at, scales_.thresholds, state.law);
      return;
    }
    if (!state.looked_back) {
      // In the blocks that had ended by then a fault that was seen at once does not show.
      const std::uint64_t since = state.tick - state.detection_tick;
      if (!ended || 2 * since < block_ticks_) return;
      look_back(output, state);
    }
    for (int i = 0; i < 2 && state.pending > 0; ++i) take_oldest(state);
    if (!ended || state.pending > 0) return;
    state.judging = true;
    state.next_part = 0;
    for (std::size_t i = 0; i < state.alarmed.size(); ++i) {
      state.alarmed[i] = output.detector.joints[i].latched;
    }
  }

 private:
  static void watch_encoders(const Vector<N, Scalar>& readings, std::uint32_t ticks, State& state) {
    std::size_t moving = 0;
    for (std::size_t i = 0; i < state.encoders.size(); ++i) {
      look_at(state.encoders[i], readings[static_cast<Eigen::Index>(i)], ticks);
      if (state.encoders[i].fast_for > 0) ++moving;
    }
    for (EncoderWatch<Scalar>& watch : state.encoders) {
      const bool slow = watch.fast_for == 0;
      const bool others_move = moving > (slow ? 0U : 1U);
      count_alone(watch.exact, watch.still > 0, others_move, !state.triggered, ticks);
      count_alone(watch.slow, slow, others_move, !state.triggered, ticks);
    }
  }
  static std::uint16_t ticks_of(Scalar seconds, Scalar period_s) {
    const Scalar ticks = std::clamp(seconds / period_s, Scalar(1), Scalar(10000));
    return static_cast<std::uint16_t>(ticks + Scalar(0.5));
  }

  static void forget(State& state) {
    state.triggered = state.looked_back = state.judging = false;
    state.pending = 0;
    state.blocks = 0;
    state.moved = 0;
    for (JointEvidence<Scalar>& joint : state.joints) joint = {};
    state.tip = {};
    state.diagnosis = {};
    state.law.known = false;
  }

  [[nodiscard]] Vector<kOwnRegressors, Scalar> scaled(const IsolationBlock<N, Scalar>& block,
                                                      std::size_t joint) const {
    const auto column = static_cast<Eigen::Index>(joint);
    return block.own.col(column).cwiseProduct(scales_.own.col(column));
  }
  [[nodiscard]] static const IsolationBlock<N, Scalar>& block_before(const State& state,
                                                                     std::size_t blocks) {
    return state.ring[(state.newest + kIsolationBlocks - blocks) % kIsolationBlocks];
  }

  [[nodiscard]] BaselineRest<Scalar> rest_at(const IsolationBlock<N, Scalar>& block,
                                             std::size_t joint, const State& state) const {
    return rest_of(state.baselines[joint], scaled(block, joint),
                   block.torque[static_cast<Eigen::Index>(joint)]);
  }
  [[nodiscard]] bool is_still(const IsolationBlock<N, Scalar>& block, std::size_t joint) const {
    return Eigen::numext::abs(block.own(kVelocityRegressor, static_cast<Eigen::Index>(joint))) <
           kStillWidths * config_.sign_width;
  }
  // Of the model's own error.
  [[nodiscard]] Scalar deviation_at(const IsolationBlock<N, Scalar>& block, std::size_t joint,
                                    const State& state) const {
    return std::sqrt(state.baselines[joint].variance[is_still(block, joint) ? 1 : 0]);
  }

  // A block that leaves unseen was one of a healthy robot: as long as there is no detection.
  void push(const IsolationBlock<N, Scalar>& block, State& state) const {
    state.newest = static_cast<std::uint8_t>((state.newest + 1U) % kIsolationBlocks);
    IsolationBlock<N, Scalar>& place = state.ring[state.newest];
    if (state.filled == kIsolationBlocks && !state.triggered) {
      for (std::size_t i = 0; i < scales_.thresholds.size(); ++i) {
        Scalar& told = state.baselines[i].largest_told;
        told = std::max(
            told, Eigen::numext::abs(place.own(kTorqueRegressor, static_cast<Eigen::Index>(i))));
        const Scalar floor = Scalar(0.03) * scales_.thresholds[i];
        learn(state.baselines[i], scaled(place, i), place.torque[static_cast<Eigen::Index>(i)],
              is_still(place, i), kept_, floor * floor);
      }
    }
    place = block;
    if (state.filled < kIsolationBlocks) ++state.filled;
    if (state.looked_back && !state.diagnosis.decided) ++state.pending;
  }

  // For the block in which it began: from which on the mean of what the joint shows that was
  // detected is farthest from nothing, against its deviation.
  void look_back(const Output& output, State& state) const {
    state.looked_back = true;
    const std::size_t joint = output.detector.first_joint;
    const JointBaseline<Scalar>& baseline = state.baselines[joint];
    const Scalar correlation = correlation_of(baseline);
    constexpr Scalar kSeen = Scalar(9);  // three standard deviations
    Scalar best = kSeen * (1 + correlation) / (1 - correlation);
    Scalar sum{};
    for (std::size_t blocks = 1; blocks <= state.filled; ++blocks) {
      const IsolationBlock<N, Scalar>& block = block_before(state, blocks - 1);
      sum += rest_at(block, joint, state).rest / deviation_at(block, joint, state);
      const Scalar score = sum * sum / static_cast<Scalar>(blocks);
      if (score <= best) continue;
      best = score;
      state.pending = static_cast<std::uint8_t>(blocks);
    }
    // One that no torque shows has begun in the last.
    state.pending = std::max(state.pending, std::min<std::uint8_t>(state.filled, 1));
    for (std::size_t i = 0; i < scales_.thresholds.size() && state.pending < state.filled; ++i) {
      const IsolationBlock<N, Scalar>& block = block_before(state, state.pending);
      state.joints[i].last_rest = rest_at(block, i, state).rest;
      state.joints[i].last_deviation = deviation_at(block, i, state);
    }
    const Scalar back_s = static_cast<Scalar>(state.pending * block_ticks_) * period_s_;
    state.diagnosis.onset_s =
        std::min(output.time_s - static_cast<double>(back_s), output.detector.detection_time_s);
  }

  void take_oldest(State& state) const {
    const IsolationBlock<N, Scalar>& block = block_before(state, state.pending - 1U);
    --state.pending;
    // In the first block the fault may have begun at any time.
    const bool first = state.blocks++ == 0;
    if (first) return;
    bool moved = false;
    for (std::size_t i = 0; i < scales_.thresholds.size(); ++i) {
      take_joint(block, i, state);
      moved = moved || !is_still(block, i);
    }
    state.moved += moved ? 1U : 0U;
    detail::follow_contacts(state);
  }

  // What is seen and the regressors, less the part of the block before that the model's own error
  // keeps: what is left of the error is new.
  void take_joint(const IsolationBlock<N, Scalar>& block, std::size_t joint, State& state) const {
    const auto column = static_cast<Eigen::Index>(joint);
    JointEvidence<Scalar>& seen = state.joints[joint];
    const JointBaseline<Scalar>& baseline = state.baselines[joint];
    const Vector<kOwnRegressors, Scalar> own = scaled(block, joint);
    const Vector<kTipParameters, Scalar> tip = block.tip.col(column).cwiseProduct(scales_.tip);
    const BaselineRest<Scalar> now = rest_at(block, joint, state);
    const Scalar deviation = deviation_at(block, joint, state);
    const Scalar lasts = correlation_of(baseline);
    // Of the last block's error, in this one's size; a still joint's says little of a moving one.
    const Scalar correlation =
        seen.last_deviation > 0 ? lasts * std::min(deviation / seen.last_deviation, Scalar(1)) : 0;
    const Scalar whitened = now.rest - correlation * seen.last_rest;
    const Scalar before = correlation * seen.last_deviation;
    // Next to the block that it began in, a velocity that was smoothed still tells of before.
    const bool still = is_still(block, joint);
    const Scalar share = still || state.blocks == 2 ? kNextToOnset : config_.relative_error;
    const Scalar off = share * now.rest;
    const Scalar changed = correlation * (off - seen.last_off);
    // What its friction holds of whatever acts on a joint that stands nobody knows; and it holds
    // the same for as long.
    const Scalar holds = still ? scales_.friction[joint].holding : Scalar(0);
    const Scalar lasting = still ? kBlocksOfARest : Scalar(1);
    const Scalar error = deviation * (deviation - 2 * lasts * before) + before * before +
                         (1 - lasts * lasts) * off * off + changed * changed + holds * holds;
    const Scalar noise = lasting * error + (1 - correlation) * (1 - correlation) * now.variance;
    const Scalar prior = scales_.own(kOneRegressor, column);
    const Scalar weight = 1 / noise;
    take(seen.own, Vector<kOwnRegressors, Scalar>(own - correlation * seen.last_own), whitened,
         weight);
    take(state.tip, Vector<kTipParameters, Scalar>(tip - correlation * seen.last_tip), whitened,
         weight);
    take(seen.any, whitened, noise, correlation, contact_kept_, prior * prior);
    if (Eigen::numext::abs(seen.any.torque) > Eigen::numext::abs(seen.largest)) {
      seen.largest = seen.any.torque;
    }
    seen.largest_own = seen.largest_own.cwiseMax(own.cwiseAbs());
    seen.squares += weight * whitened * whitened;
    if (still) {
      take(seen.held, whitened, noise, correlation, contact_kept_, prior * prior);
      if (Eigen::numext::abs(now.rest) > Eigen::numext::abs(seen.largest_held)) {
        seen.largest_held = now.rest;
      }
    } else {
      seen.speed_sum += Eigen::numext::abs(block.own(kVelocityRegressor, column));
      ++seen.moved;
    }
    seen.last_rest = now.rest;
    seen.last_off = off;
    seen.last_deviation = std::sqrt(deviation * deviation + holds * holds);
    seen.last_own = own;
    seen.last_tip = tip;
  }

  // One part of the verdict: some of the hypotheses, or in the end the answer.
  void judge_part(const RigidBodyModel<N, Scalar>& model, const Vector<N, Scalar>& q,
                  State& state) const {
    const std::size_t count = state.joints.size();
    const std::size_t part = state.next_part++;
    if (part == 0) {
      state.contest = detail::begin_contest(state, scales_);
    } else if (part <= count) {
      detail::enter_joint(state, scales_, part - 1, state.contest);
    } else if (part == count + 1) {
      enter_encoders(model, q, state);
    } else {
      answer(state);
      state.judging = false;
    }
  }

  void enter_encoders(const RigidBodyModel<N, Scalar>& model, const Vector<N, Scalar>& q,
                      State& state) const {
    constexpr Scalar kStillS = Scalar(0.1);
    constexpr Scalar kAheadS = Scalar(0.02);
    constexpr Scalar kBrakingS = Scalar(0.05);
    const Scalar looked_back = static_cast<Scalar>(kIsolationBlocks * block_ticks_) * period_s_;
    const auto ticks = [&](Scalar seconds) {
      return static_cast<std::uint32_t>(seconds / period_s_);
    };
    const std::uint64_t detected_for = state.tick - state.detection_tick;
    constexpr std::uint64_t kMost = 1U << 30U;
    const auto since = static_cast<std::uint32_t>(std::min(detected_for, kMost));
    const EncoderTimes<Scalar> times{ticks(kStillS),
                                     since,
                                     ticks(kAheadS),
                                     ticks(kBrakingS),
                                     since + ticks(looked_back),
                                     config_.baseline_s / period_s_};
    const Matrix<N, N, Scalar> inertia = mass_matrix<N, Scalar>(model, q);
    PerJoint<N, bool> felt{};
    size_for(state.joints.size(), felt);
    for (std::size_t i = 0; i < felt.size(); ++i) {
      felt[i] = detail::runs_away_felt<N, Scalar>(inertia, i, scales_);
    }
    detail::enter_encoders(state, scales_, times, felt, state.contest);
  }

  void answer(State& state) const {
    const Contest<Scalar>& contest = state.contest;
    const Scalar since = static_cast<Scalar>(state.tick - state.detection_tick) * period_s_;
    auto measure = detail::measure_of(state, scales_, contest.kind, contest.joint);
    FaultDiagnosis<Scalar>& diagnosis = state.diagnosis;
    diagnosis.kind = contest.kind;
    diagnosis.confidence = contest.share();
    if (contest.kind == FaultKind::kPayload && !detail::is_body(measure, scales_.last_mass)) {
      diagnosis.kind = FaultKind::kUnknown;
      diagnosis.confidence = 1 - contest.share();
      measure = detail::measure_of(state, scales_, FaultKind::kUnknown, contest.joint);
    }
    diagnosis.joint = contest.joint;
    diagnosis.size = measure.size;
    diagnosis.deviation = measure.deviation;
    diagnosis.time_s = static_cast<double>(state.tick) * static_cast<double>(period_s_);
    Scalar squares{};
    for (const JointEvidence<Scalar>& joint : state.joints) squares += joint.squares;
    const Scalar expected =
        static_cast<Scalar>(state.blocks) * static_cast<Scalar>(state.joints.size());
    const Scalar whole = std::max(squares - expected, Scalar(1));
    diagnosis.unexplained =
        std::clamp((squares - expected - measure.explained) / whole, Scalar(0), Scalar(1));
    // That nothing fits may change as long as there is more to come.
    const bool is_clear = diagnosis.kind != FaultKind::kUnknown &&
                          diagnosis.confidence >= config_.confidence && since >= config_.least_s;
    // An arm that stands says little more, however long it does, but for a joint that is held.
    const Scalar moved = static_cast<Scalar>(state.moved * block_ticks_) * period_s_;
    const bool is_held =
        diagnosis.kind == FaultKind::kEncoderStuck || diagnosis.kind == FaultKind::kLockedJoint;
    const bool is_late = since >= config_.limit_s && (moved >= config_.limit_s || is_held);
    diagnosis.decided = is_clear || is_late;
  }

  static constexpr Scalar kStillWidths = Scalar(4);     // smooth_sign() is 1 from there on
  static constexpr Scalar kBlocksOfARest = Scalar(10);  // that say as much as one
  static constexpr Scalar kNextToOnset = Scalar(0.5);   // relative error

  IsolationConfig<Scalar> config_{};
  Scalar period_s_{};
  Scalar kept_{};          // of the baseline, from block to block
  Scalar contact_kept_{};  // of an arbitrary torque
  LawRates<Scalar> law_rates_{};
  std::uint16_t block_ticks_ = 1;
  int parts_per_tick_ = 1;  // of a verdict: it is made before the next block has ended
  IsolationScales<N, Scalar> scales_{};
};

}  // namespace offnominal
