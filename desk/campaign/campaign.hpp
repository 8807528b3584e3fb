#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <offnominal/diagnosis/fault_kind.hpp>
#include <optional>
#include <string>
#include <vector>

#include "robot/robot.hpp"

// What is run in a fault campaign: one plant, the model that watches it, detectors that are
// calibrated on the same fault-free runs and judge the same runs with and without faults.

namespace offnominal::desk::campaign {

enum class PlantKind : std::uint8_t {
  kRobot,   // the robot file's own rigid body and effects (desk/sil/robot_plant.hpp)
  kMujoco,  // MuJoCo, made from the robot file
};

// What a recording's velocities are.
enum class VelocityKind : std::uint8_t {
  kDerived,   // of the recorded positions, low-passed without phase, as read_log() does
  kObserved,  // of the controller's observer, from positions up to now
  kSent,      // the joints' own, with noise, as a drive sends them
};

struct PlantSettings {
  PlantKind kind = PlantKind::kMujoco;
  double cad_error = 0;       // share by which masses, centres and inertias of the model are off
  double friction_error = 0;  // share by which effects of the model are off, rotor inertias apart
  double torque_noise = 0;    // standard deviation, share of each joint's largest healthy torque
  int encoder_bits = 0;       // per turn; 0: ideal
  double period_s = 0.001;
  VelocityKind velocity = VelocityKind::kDerived;
  double velocity_noise_rad_s = 0;  // standard deviation; kSent
};

enum class DetectorKind : std::uint8_t {
  kTorque,            // the monitor, a threshold per joint
  kAcceleration,      // the monitor, the paper's one threshold of the norm
  kMomentumObserver,  // momentum_observer.hpp
  kKdl,               // kdl_observer.hpp
};

struct DetectorSettings {
  DetectorKind kind = DetectorKind::kTorque;
  std::string name;             // of its own in a campaign
  double alpha_per_s = 10;      // pole of the monitor's filter, or the observers' gain
  double fast_alpha_per_s = 0;  // kTorque: of a second filter beside it; 0: none
  bool accommodates = false;    // kTorque: each run with a fault once more, with it in the loop
  double filter_share = 0;      // kKdl: the part of the last estimate that is kept, 0 to below 1
};

enum class FaultKind : std::uint8_t {
  kPayload,        // kg, a point mass on the last link
  kFriction,       // N m, Coulomb friction on top
  kFrictionShare,  // 1, of the Coulomb friction that the file gives the joint
  kTorqueLost,     // 1, of what the drive is told
  kOffset,         // N m, that the drive gives too much
  kPush,           // N, on a link, for a while
  kEncoderStuck,   // no size: the reading stays as it was
  kEncoderJump,    // rad, by which the reading is off
  kLocked,         // no size: the joint does not move any more
};

struct FaultKindInfo {
  FaultKind kind;
  const char* name;              // in files and tables
  const char* unit;              // of its size; empty: it has none
  bool of_joint;                 // one joint is at fault, and a detector can name it
  offnominal::FaultKind answer;  // what isolation should say that it is
  bool has_size_of_answer;       // whose size is the same quantity then
  const char* words;             // for help and pages
};
inline constexpr std::array<FaultKindInfo, 9> kFaultKinds{{
    {FaultKind::kPayload, "payload", "kg", false, offnominal::FaultKind::kPayload, true,
     "a point mass on the last link"},
    {FaultKind::kFriction, "friction", "N m", true, offnominal::FaultKind::kFriction, true,
     "Coulomb friction on top"},
    {FaultKind::kFrictionShare, "friction_share", "1", true, offnominal::FaultKind::kFriction,
     false, "Coulomb friction on top, a share of the joint's own"},
    {FaultKind::kTorqueLost, "torque_lost", "1", true, offnominal::FaultKind::kLostTorque, true,
     "share that the drive no longer gives"},
    {FaultKind::kOffset, "offset", "N m", true, offnominal::FaultKind::kOffset, true,
     "torque that the drive gives too much"},
    {FaultKind::kPush, "push", "N", false, offnominal::FaultKind::kContact, false,
     "a force on a link for a while"},
    {FaultKind::kEncoderStuck, "encoder_stuck", "", true, offnominal::FaultKind::kEncoderStuck,
     false, "the reading stays as it was"},
    {FaultKind::kEncoderJump, "encoder_jump", "rad", true, offnominal::FaultKind::kEncoderJump,
     true, "the reading is off from then on"},
    {FaultKind::kLocked, "locked", "", true, offnominal::FaultKind::kLockedJoint, false,
     "the joint does not move any more"},
}};
[[nodiscard]] constexpr const FaultKindInfo& info_of(FaultKind kind) {
  return kFaultKinds[static_cast<std::size_t>(kind)];
}

// One fault of one size in one place.
struct Fault {
  FaultKind kind = FaultKind::kPayload;
  int joint = -1;   // from 0; of a push the link behind it; -1: none (payload)
  double size = 0;  // in the kind's unit; 0 where it has none
  std::array<double, 3> place_m{0, 0, 0};    // payload, push: in the link's frame
  std::array<double, 3> direction{0, 1, 0};  // push: of the force in the world, of length 1
  double lasts_s = 0;                        // push
};

struct CalibrationSettings {
  int runs = 6;  // fault-free; of several the last is held out
  double duration_s = 60;
  double alarms_per_hour = 0.1;
};

struct RunSettings {
  int per_fault = 12;
  double duration_s = 10;
  double fault_s = 6;  // when the fault begins
  double fault_free_hours = 0;
  double fault_free_duration_s = 60;  // of one fault-free run
};

struct Campaign {
  std::string file;  // as the user named it
  std::string name;
  std::string identity;  // what makes it this one: its keys, its robots, the version
  std::uint64_t seed = 1;
  RobotDescription truth;  // what the plant is; limits of velocity lifted
  RobotDescription model;  // what the detectors know; no bound
  PlantSettings plant;
  std::vector<double> middles_rad;  // about which each joint moves
  CalibrationSettings calibration;
  std::vector<DetectorSettings> detectors;
  std::vector<Fault> faults;
  RunSettings runs;

  [[nodiscard]] int fault_free_runs() const;
  [[nodiscard]] std::int64_t run_count() const;
};

// A run of a campaign. All that it is follows from the campaign and its number.
struct Run {
  std::int64_t number = 0;       // from 0
  const Fault* fault = nullptr;  // null: fault-free
  double duration_s = 0;
};
/// 0 <= number < run_count(): all runs of the first fault, then of the second, ..., fault-free ones
/// last. The campaign has to outlive it.
[[nodiscard]] Run run_of(const Campaign& campaign, std::int64_t number);

/// One of n equal parts of all runs, run numbers i - 1, i - 1 + n, ...
struct Shard {
  std::int64_t index = 1;  // from 1
  std::int64_t count = 1;
};
[[nodiscard]] std::vector<std::int64_t> runs_of(const Campaign& campaign, const Shard& shard);

/// "i/n" with 1 <= i <= n <= 1e6. Throws InputError.
[[nodiscard]] Shard parse_shard(const std::string& text);

}  // namespace offnominal::desk::campaign
