#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <offnominal/controller/controller_config.hpp>
#include <offnominal/diagnosis/observed_motion.hpp>
#include <offnominal/finite.hpp>
#include <offnominal/hal/drive_protocol.hpp>
#include <offnominal/sample.hpp>
#include <utility>

// From what drives have said of the joints to the sample of a tick.

namespace offnominal::controller {

// Where a joint that may turn for ever is, beyond what a frame carries (hal::carried_position()).
template <typename Scalar>
struct TurnCount {
  bool started = false;
  std::int32_t tens = 0;  // of turns, above what was carried last
  Scalar carried{};       // rad
};

// Plain data.
template <int N, typename Scalar>
struct SampleData {
  JointSample<N, Scalar> sample;    // the newest of everything: what controls
  JointSample<N, Scalar> observed;  // of one time, while `observes`
  bool observes = false;            // a joint of this sample had no velocity
  bool fresh = false;               // this tick had a sample of its own
  std::uint32_t unseen_ticks = 0;   // periods without one, since the last
  // Readings of a position that cannot be, of one joint or of several in a tick; of the last, why.
  std::uint8_t implausible_in_a_row = 0;
  Status implausible = Status::kOk;
  PerJoint<N, Microseconds> implausible_time_us{};
  PerJoint<N, Microseconds> used_time_us{};  // of the last sample
  PerJoint<N, ObservedMotionState<Scalar>> motion{};
  PerJoint<N, TurnCount<Scalar>> turns{};

  // What is judged: position, velocity and torque of one time.
  [[nodiscard]] const JointSample<N, Scalar>& judged() const {
    return observes ? observed : sample;
  }
};

template <int N, typename Scalar>
class SampleTaker {
 public:
  using Data = SampleData<N, Scalar>;
  using Feedback = PerJoint<N, hal::JointFeedback>;

  SampleTaker() = default;
  // Of a configuration that validate() accepts.
  template <typename Space>
  explicit SampleTaker(const ControllerConfig<N, Scalar, Space>& config)
      : range_(position_range_of(config)), observer_(observer_of(config)) {
    const Joint<Scalar> unlimited;
    size_for(config.monitor.chain.joints.size(), turns_for_ever_);
    for (std::size_t j = 0; j < turns_for_ever_.size(); ++j) {
      const Joint<Scalar>& joint = config.monitor.chain.joints[j];
      turns_for_ever_[j] = joint.type == JointType::kRevolute &&
                           joint.min_position <= unlimited.min_position &&
                           joint.max_position >= unlimited.max_position;
    }
  }

  // Periods that had no tick of their own.
  static void leave_out(std::uint32_t late_ticks, Data& data) {
    const std::uint32_t room = std::numeric_limits<std::uint32_t>::max() - data.unseen_ticks;
    data.unseen_ticks += std::min(late_ticks, room);
  }

  // A position that cannot be is as none: it enters nothing. One that stands for several ticks, of
  // a source slower than they are, is one.
  void screen(const Feedback& feedback, Data& data) const {
    data.implausible = Status::kOk;
    bool is_new = false;
    for (std::size_t j = 0; j < turns_for_ever_.size(); ++j) {
      const auto i = static_cast<Eigen::Index>(j);
      const Scalar position = position_in(counted(feedback[j].reading, j, data));
      const bool valid = feedback[j].encoder == hal::SourceState::kValid;
      const bool inside =
          is_finite(position) && position >= range_.lowest[i] && position <= range_.highest[i];
      if (!valid || inside) continue;
      data.implausible =
          is_finite(position) ? Status::kPositionOutOfRange : Status::kNonFinitePosition;
      is_new = is_new || feedback[j].encoder_time_us != data.implausible_time_us[j];
      data.implausible_time_us[j] = feedback[j].encoder_time_us;
    }
    if (data.implausible == Status::kOk) {
      data.implausible_in_a_row = 0;
    } else if (is_new && data.implausible_in_a_row < std::numeric_limits<std::uint8_t>::max()) {
      ++data.implausible_in_a_row;
    }
  }

  // After screen(). Fresh: every joint has been read since the last sample, where it can be.
  void take(const Feedback& feedback, Data& data) const {
    data.fresh = data.implausible == Status::kOk;
    for (std::size_t j = 0; j < turns_for_ever_.size(); ++j) {
      const bool valid = feedback[j].encoder == hal::SourceState::kValid;
      const bool is_new = feedback[j].encoder_time_us != data.used_time_us[j];
      data.fresh = data.fresh && valid && is_new;
    }
    if (!data.fresh) {
      if (data.unseen_ticks < std::numeric_limits<std::uint32_t>::max()) ++data.unseen_ticks;
      return;
    }
    // One joint alone without a velocity makes all late: they carry each other.
    const bool observes = std::any_of(feedback.begin(), feedback.end(), [](const auto& joint) {
      return !joint.reading.has_velocity;
    });
    if (std::exchange(data.observes, observes) && !observes) data.motion.fill({});
    for (std::size_t j = 0; j < turns_for_ever_.size(); ++j) {
      const auto i = static_cast<Eigen::Index>(j);
      data.used_time_us[j] = feedback[j].encoder_time_us;
      data.turns[j] = counted(feedback[j].reading, j, data);
      data.sample.q[i] = position_in(data.turns[j]);
      data.sample.tau[i] = static_cast<Scalar>(feedback[j].status.applied_torque);
      if (observes) observe(j, data);
      data.sample.dq[i] = feedback[j].reading.has_velocity
                              ? static_cast<Scalar>(feedback[j].reading.velocity)
                              : data.observed.dq[i];
    }
  }

  // Every velocity is one that was sent, or that the observer knows by now.
  [[nodiscard]] bool is_settled(const Data& data) const {
    return std::all_of(data.motion.begin(), data.motion.end(), [&](const auto& motion) {
      return motion.observer.updates == 0 || offnominal::is_settled(observer_, motion.observer);
    });
  }

  // So many ticks ago nothing is judged of any more.
  [[nodiscard]] bool has_forgotten(std::uint64_t ticks) const {
    constexpr std::uint64_t kMost = std::numeric_limits<std::uint32_t>::max();
    VelocityObserverState<Scalar> since;
    since.updates = static_cast<std::uint32_t>(std::min(ticks, kMost));
    return offnominal::is_settled(observer_, since);
  }

  // Velocities have to be observed anew, and turns counted from what is carried.
  void forget(Data& data) const {
    data.motion.fill({});
    data.turns.fill({});
  }

  [[nodiscard]] const PositionRange<N, Scalar>& range() const { return range_; }

 private:
  // A joint passes from one end of what is carried to the other, and not from one half of it to the
  // other within a reading; what is beyond the ends was not carried modulo anything.
  [[nodiscard]] TurnCount<Scalar> counted(const hal::EncoderReading& reading, std::size_t joint,
                                          const Data& data) const {
    TurnCount<Scalar> count = data.turns[joint];
    const auto carried = static_cast<Scalar>(reading.position);
    if (turns_for_ever_[joint] && count.started && is_near_end(carried) &&
        is_near_end(count.carried)) {
      if (carried < 0 && count.carried > 0) ++count.tens;
      if (carried > 0 && count.carried < 0) --count.tens;
    }
    count.started = true;
    count.carried = carried;
    return count;
  }
  // By no more than a quarter of the range: two turns and a half, which no joint does in a tick.
  static bool is_near_end(Scalar carried) {
    constexpr auto kHalf = static_cast<Scalar>(hal::kCarriedRangeRad / 2);
    return std::fabs(carried) > kHalf / 2 && std::fabs(carried) < kHalf + 1;
  }
  static Scalar position_in(const TurnCount<Scalar>& count) {
    constexpr auto kTen = static_cast<Scalar>(hal::kCarriedRangeRad);
    return count.carried + static_cast<Scalar>(count.tens) * kTen;
  }

  void observe(std::size_t joint, Data& data) const {
    ObservedMotionState<Scalar>& state = data.motion[joint];
    const auto i = static_cast<Eigen::Index>(joint);
    const Scalar position = data.sample.q[i];
    const Scalar torque = data.sample.tau[i];
    ObservedMotion<Scalar> motion;
    const Status status =
        offnominal::observe(observer_, position, torque, data.unseen_ticks, state, motion);
    // What it cannot follow it starts anew from, which nothing that is finite keeps it from.
    if (status != Status::kOk) {
      state = {};
      static_cast<void>(offnominal::observe(observer_, position, torque, 0, state, motion));
    }
    data.observed.q[i] = motion.position;
    data.observed.dq[i] = motion.velocity;
    data.observed.tau[i] = motion.torque;
  }

  PositionRange<N, Scalar> range_;
  VelocityObserverConfig<Scalar> observer_;
  PerJoint<N, bool> turns_for_ever_{};  // as many as there are joints
};

}  // namespace offnominal::controller
