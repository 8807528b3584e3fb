#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <offnominal/diagnosis/encoder_watch.hpp>
#include <offnominal/diagnosis/fault_kind.hpp>
#include <offnominal/diagnosis/fault_law.hpp>
#include <offnominal/diagnosis/isolation_bank.hpp>
#include <offnominal/diagnosis/isolation_block.hpp>
#include <offnominal/diagnosis/isolation_contest.hpp>

namespace offnominal {

// Blocks that are kept: what may lie between the beginning of a fault and its detection without
// being taken for the model's own error.
inline constexpr std::size_t kIsolationBlocks = 25;

// What is off nominal.
template <typename Scalar>
struct FaultDiagnosis {
  FaultKind kind = FaultKind::kUnknown;
  std::uint8_t joint = 0;  // from 0; of a payload the last one, of a contact the link touched
  Scalar size{};           // as FaultKind says
  Scalar deviation{};      // standard deviation of the size, same unit
  Scalar confidence{};     // 0 to 1, that it is this kind on this joint and no other of the bank
  Scalar unexplained{};    // 0 to 1: share of what is seen that it leaves
  double time_s = 0;       // of this answer, since the monitor's reset()
  double onset_s = 0;      // when what it was made from begins
  bool decided = false;    // latched; before that the best answer so far
};

// The evidence on one joint since the fault began.
template <typename Scalar>
struct JointEvidence {
  Regression<kOwnRegressors, Scalar> own;
  AnyTorque<Scalar> any;
  Scalar largest{};  // of any.torque, by size, with its sign
  // While the joint stands still, and the largest that is seen then, N m or N.
  AnyTorque<Scalar> held;
  Scalar largest_held{};
  // Of a contact with this joint's link that ended when it fits best, against nothing; nats.
  Scalar contact{};
  bool contact_ended = false;  // before now
  Scalar squares{};            // of what is seen, each over its variance
  // By size, of each regressor, scaled.
  Vector<kOwnRegressors, Scalar> largest_own = Vector<kOwnRegressors, Scalar>::Zero();
  Scalar speed_sum{};       // of the blocks in which it moves, rad/s or m/s
  std::uint32_t moved = 0;  // number of those
  Scalar last_rest{};       // of the block before
  Scalar last_off{};        // by which a hypothesis may be off and still be right, in it
  Scalar last_deviation{};  // of the model's own error in it
  Vector<kOwnRegressors, Scalar> last_own = Vector<kOwnRegressors, Scalar>::Zero();
  Vector<kTipParameters, Scalar> last_tip = Vector<kTipParameters, Scalar>::Zero();
};

// Everything that changes from tick to tick; plain data.
template <int N, typename Scalar>
struct IsolationState {
  bool started = false;
  std::uint64_t tick = 0;  // of the monitor, at the last sample taken
  IsolationSum<N, Scalar> block;
  // Blocks that have ended, the newest at `newest`, older ones before it, round and round.
  std::array<IsolationBlock<N, Scalar>, kIsolationBlocks> ring{};
  std::uint8_t newest = 0;
  std::uint8_t filled = 0;
  std::uint8_t pending = 0;  // of them, the newest, that the evidence has not taken
  PerJoint<N, JointBaseline<Scalar>> baselines{};
  PerJoint<N, EncoderWatch<Scalar>> encoders{};

  bool triggered = false;    // by a detection
  bool looked_back = false;  // for where it began
  std::uint64_t detection_tick = 0;
  std::uint32_t blocks = 0;  // that the evidence has taken
  std::uint32_t moved = 0;   // of them, those in which some joint moved
  PerJoint<N, JointEvidence<Scalar>> joints{};
  Regression<kTipParameters, Scalar> tip;
  // A verdict in the making: which of its parts is next, none where it is made.
  std::uint8_t next_part = 0;
  bool judging = false;
  PerJoint<N, bool> alarmed{};  // joints that had been detected when it began
  Contest<Scalar> contest;
  FaultDiagnosis<Scalar> diagnosis;
  FaultLaw<N, Scalar> law;  // of the fault that is decided
};

// Of the blocks in which the joint moved, rad/s or m/s.
template <int N, typename Scalar>
[[nodiscard]] Scalar mean_speed(const IsolationState<N, Scalar>& state, std::size_t joint) {
  const JointEvidence<Scalar>& seen = state.joints[joint];
  return seen.speed_sum / static_cast<Scalar>(std::max(seen.moved, std::uint32_t{1}));
}

}  // namespace offnominal
