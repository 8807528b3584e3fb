// What may go wrong in a run, when, where and how much.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string_view>

namespace offnominal::sim {

enum class FaultEventKind : std::uint8_t {
  // The arm, its drives and encoders.
  kMassLoss,
  kNonlinear,
  kPayload,
  kFrictionJump,
  kTorqueLoss,
  kDisturbanceTorque,
  kEncoderBias,
  kEncoderDrift,
  kEncoderStuck,
  kEncoderDropout,
  // The bus.
  kFrameLoss,
  kDuplicateFrames,
  kReorderedFrames,
  kDelayedFrames,
  kCorruptedFrames,
  kForgedFrames,
  kReplayedBurst,
  kBabblingNode,
  kSilentNode,
  kBlockedBus,
  kBusOff,
};

/// One fault of a run.
struct FaultEvent {
  FaultEventKind kind = FaultEventKind::kMassLoss;
  double begin_s = 10.0;  ///< since the arm started to move
  double end_s = std::numeric_limits<double>::infinity();
  int joint = -1;     ///< from 0; where the kind acts on one joint, -1: not said
  double size = 0.0;  ///< in the kind's unit
  double rate_per_s = std::numeric_limits<double>::infinity();  ///< mass_loss, nonlinear, payload

  [[nodiscard]] bool is_active(double time_s) const { return time_s >= begin_s && time_s < end_s; }
  /// How much of a fault that develops is there: 1 - exp(-rate (t - begin)), 0 before.
  [[nodiscard]] double developed(double time_s) const {
    if (time_s < begin_s) return 0.0;
    return std::isinf(rate_per_s) ? 1.0 : -std::expm1(-rate_per_s * (time_s - begin_s));
  }
};

/// Whether a kind of fault is one of a joint.
enum class OfJoint : std::uint8_t { kNever, kMayBe, kAlways };

struct FaultEventInfo {
  FaultEventKind kind;
  std::string_view name;
  bool on_bus;
  OfJoint of_joint;
  bool develops;           ///< has a rate, and no end
  std::string_view unit;   ///< of the size; empty: it has none
  double least, most;      ///< size
  std::string_view words;  ///< what it does
};

inline constexpr std::array<FaultEventInfo, 21> kFaultEventInfos = {{
    {FaultEventKind::kMassLoss, "mass_loss", false, OfJoint::kMayBe, true, "1", 0, 0.99,
     "share of a link's mass that is lost, without a joint of the first (the paper: 0.75)"},
    {FaultEventKind::kNonlinear, "nonlinear", false, OfJoint::kNever, true, "", 0, 0,
     "the acceleration of equation (30) of the paper, on its arm"},
    {FaultEventKind::kPayload, "payload", false, OfJoint::kNever, true, "kg", 0, 100,
     "a mass at the tip; of a robot file at the last link's centre of mass"},
    {FaultEventKind::kFrictionJump, "friction_jump", false, OfJoint::kAlways, false, "N m", 0, 1000,
     "Coulomb friction that was not there before"},
    {FaultEventKind::kTorqueLoss, "torque_loss", false, OfJoint::kAlways, false, "1", 0, 1,
     "share of its torque that a drive no longer gives, and does not tell"},
    {FaultEventKind::kDisturbanceTorque, "disturbance_torque", false, OfJoint::kAlways, false,
     "N m", -1000, 1000,
     "somebody pushes the joint in its positive direction, N on one that slides"},
    {FaultEventKind::kEncoderBias, "encoder_bias", false, OfJoint::kAlways, false, "rad", -3, 3,
     "an offset of the position"},
    {FaultEventKind::kEncoderDrift, "encoder_drift", false, OfJoint::kAlways, false, "rad/s", -3, 3,
     "an offset of the position that grows"},
    {FaultEventKind::kEncoderStuck, "encoder_stuck", false, OfJoint::kAlways, false, "", 0, 0,
     "the reading stays as it was, its frames go on"},
    {FaultEventKind::kEncoderDropout, "encoder_dropout", false, OfJoint::kAlways, false, "", 0, 0,
     "no readings; the drive's status says that its encoder has failed"},
    {FaultEventKind::kFrameLoss, "frame_loss", true, OfJoint::kNever, false, "1", 0, 1,
     "share of the plant's frames that are lost"},
    {FaultEventKind::kDuplicateFrames, "duplicate_frames", true, OfJoint::kNever, false, "1", 0, 1,
     "share of the plant's frames that come twice"},
    {FaultEventKind::kReorderedFrames, "reordered_frames", true, OfJoint::kNever, false, "1", 0, 1,
     "share of the plant's frames that change places with the next"},
    {FaultEventKind::kDelayedFrames, "delayed_frames", true, OfJoint::kNever, false, "s", 0, 1,
     "the plant's frames come so much later"},
    {FaultEventKind::kCorruptedFrames, "corrupted_frames", true, OfJoint::kNever, false, "1", 0, 1,
     "share of the plant's frames in which one to five bits are wrong"},
    {FaultEventKind::kForgedFrames, "forged_frames", true, OfJoint::kNever, false,
     "frames per tick", 1, 64,
     "readings and torque commands of somebody who knows identifiers and lengths, not the CRC"},
    {FaultEventKind::kReplayedBurst, "replayed_burst", true, OfJoint::kNever, false,
     "frames per tick", 1, 64, "frames of the plant that were on the bus before, once more"},
    {FaultEventKind::kBabblingNode, "babbling_node", true, OfJoint::kNever, false,
     "frames per tick", 1, 64, "a node that sends without a pause, with an identifier of nobody"},
    {FaultEventKind::kSilentNode, "silent_node", true, OfJoint::kAlways, false, "", 0, 0,
     "nothing comes from one joint's drive, and nothing reaches it"},
    {FaultEventKind::kBlockedBus, "blocked_bus", true, OfJoint::kNever, false, "", 0, 0,
     "the controller's frames find no gap on the bus, and nothing reaches it"},
    {FaultEventKind::kBusOff, "bus_off", true, OfJoint::kNever, false, "", 0, 0,
     "the controller's node is bus-off"},
}};

[[nodiscard]] constexpr const FaultEventInfo& info_of(FaultEventKind kind) {
  return kFaultEventInfos[static_cast<std::size_t>(kind)];
}

}  // namespace offnominal::sim
