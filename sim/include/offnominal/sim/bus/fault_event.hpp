// What may go wrong in a run, when, where and how much.
#pragma once

#include <array>
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
  int joint = -1;     ///< from 0; where the kind acts on one joint
  double size = 0.0;  ///< in the kind's unit
  double rate_per_s = std::numeric_limits<double>::infinity();  ///< mass_loss, nonlinear, payload

  [[nodiscard]] bool is_active(double time_s) const { return time_s >= begin_s && time_s < end_s; }
};

struct FaultEventInfo {
  FaultEventKind kind;
  std::string_view name;
  bool on_bus;
  bool on_joint;
  bool develops;           ///< has a rate, and no end
  std::string_view unit;   ///< of the size; empty: it has none
  double least, most;      ///< size
  std::string_view words;  ///< what it does
};

inline constexpr std::array<FaultEventInfo, 20> kFaultEventInfos = {{
    {FaultEventKind::kMassLoss, "mass_loss", false, false, true, "1", 0, 0.99,
     "share of mass 1 that is lost (section 5.1 of the paper: 0.75)"},
    {FaultEventKind::kNonlinear, "nonlinear", false, false, true, "", 0, 0,
     "the acceleration of equation (30) of the paper"},
    {FaultEventKind::kPayload, "payload", false, false, true, "kg", 0, 100, "a mass at the tip"},
    {FaultEventKind::kFrictionJump, "friction_jump", false, true, false, "N m", 0, 1000,
     "Coulomb friction that was not there before"},
    {FaultEventKind::kTorqueLoss, "torque_loss", false, true, false, "1", 0, 1,
     "share of its torque that a drive no longer gives, and does not tell"},
    {FaultEventKind::kEncoderBias, "encoder_bias", false, true, false, "rad", -3, 3,
     "an offset of the position"},
    {FaultEventKind::kEncoderDrift, "encoder_drift", false, true, false, "rad/s", -3, 3,
     "an offset of the position that grows"},
    {FaultEventKind::kEncoderStuck, "encoder_stuck", false, true, false, "", 0, 0,
     "the reading stays as it was, its frames go on"},
    {FaultEventKind::kEncoderDropout, "encoder_dropout", false, true, false, "", 0, 0,
     "no readings; the drive's status says that its encoder has failed"},
    {FaultEventKind::kFrameLoss, "frame_loss", true, false, false, "1", 0, 1,
     "share of the plant's frames that are lost"},
    {FaultEventKind::kDuplicateFrames, "duplicate_frames", true, false, false, "1", 0, 1,
     "share of the plant's frames that come twice"},
    {FaultEventKind::kReorderedFrames, "reordered_frames", true, false, false, "1", 0, 1,
     "share of the plant's frames that change places with the next"},
    {FaultEventKind::kDelayedFrames, "delayed_frames", true, false, false, "s", 0, 1,
     "the plant's frames come so much later"},
    {FaultEventKind::kCorruptedFrames, "corrupted_frames", true, false, false, "1", 0, 1,
     "share of the plant's frames in which one to five bits are wrong"},
    {FaultEventKind::kForgedFrames, "forged_frames", true, false, false, "frames per tick", 1, 64,
     "readings and torque commands of somebody who knows identifiers and lengths, not the CRC"},
    {FaultEventKind::kReplayedBurst, "replayed_burst", true, false, false, "frames per tick", 1, 64,
     "frames of the plant that were on the bus before, once more"},
    {FaultEventKind::kBabblingNode, "babbling_node", true, false, false, "frames per tick", 1, 64,
     "a node that sends without a pause, with an identifier of nobody"},
    {FaultEventKind::kSilentNode, "silent_node", true, true, false, "", 0, 0,
     "nothing comes from one joint's drive, and nothing reaches it"},
    {FaultEventKind::kBlockedBus, "blocked_bus", true, false, false, "", 0, 0,
     "the controller's frames find no gap on the bus, and nothing reaches it"},
    {FaultEventKind::kBusOff, "bus_off", true, false, false, "", 0, 0,
     "the controller's node is bus-off"},
}};

[[nodiscard]] constexpr const FaultEventInfo& info_of(FaultEventKind kind) {
  return kFaultEventInfos[static_cast<std::size_t>(kind)];
}

}  // namespace offnominal::sim
