#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <offnominal/diagnosis/bound.hpp>
#include <offnominal/diagnosis/estimator_config.hpp>
#include <offnominal/model/chain.hpp>
#include <offnominal/model/effect_list.hpp>
#include <offnominal/sample.hpp>
#include <optional>
#include <string>
#include <vector>

#include "drives/drive_settings.hpp"

// One robot as the host tools hold it: 1 to kMaxJoints joints, everything in SI units. It is what a
// robot file says and nothing else; chain_of() turns it into the chain of the core.

namespace offnominal::desk {

// Of every monitor and controller on the desk: fewer are exactly a smaller network.
inline constexpr int kMaxHiddenUnits = 128;

struct Encoder {
  double counts_per_unit = 0;  // counts per rad or m; 0: no quantisation is known
};

struct RobotJoint {
  std::string name;
  Joint<double> joint;
  Encoder encoder;
  double kp = 0;            // 1/s^2, computed torque (paper eq. 29)
  double kd = 0;            // 1/s
  std::string source = {};  // where the numbers come from, free text; empty: not said
};

// A number of a joint that its file leaves blank (docs/your-own-arm.md): what stands in its place
// in the description means nothing.
struct Blank {
  std::size_t joint = 0;
  std::string key;  // of its link: "mass_kg" or "centre_of_mass_m"

  friend bool operator==(const Blank&, const Blank&) = default;
};

// In which quantity the monitor compares: AccelerationSpace or TorqueSpace of the core.
enum class EstimatorSpace : std::uint8_t { kAcceleration, kTorque };

// Settings of the on-board estimator (paper section 3).
struct EstimatorSettings : EstimatorConfig<double> {
  EstimatorSpace space = EstimatorSpace::kAcceleration;
  TorqueSignal torque_signal = TorqueSignal::kSampled;
  bool isolation = false;  // a controller asks which fault it is; in kTorque alone
  // Pole of a second filter beside alpha's, 1/s; 0: there is none. In kTorque alone.
  double fast_alpha = 0;
  std::string source = {};  // where the numbers come from, free text; empty: not said
};

// How a controller takes hold of the arm. One number per joint, or none: default_arming().
struct ArmingSettings {
  std::vector<double> position_window;  // rad or m
  std::vector<double> speed;            // rad/s or m/s
  std::vector<double> torque_rate;      // N m/s or N/s
  double ramp_s = 1;
  std::string source = {};  // where the numbers come from, free text; empty: not said
};

// Bound mu_bar on |M^-1 (unmodelled torque)| (paper assumption 3.1), rad/s^2 or m/s^2.
struct ConstantBoundSettings {
  double value = 1;
};
// scale * (|matrix dq| + offset); every row of `matrix` has one number per joint.
struct ScaledNormBoundSettings {
  double scale = 1;
  double offset = 1;
  std::vector<std::vector<double>> matrix;
};
// Linear between points over q, |dq| or |tau| of one joint, constant beyond both ends.
struct TableBoundSettings {
  BoundVariable variable = BoundVariable::kSpeed;
  int joint = 0;  // from 0
  std::vector<double> at;
  std::vector<double> value;
};
// Of one joint in EstimatorSpace::kTorque: linear between points over one variable of its own, N m
// or N; one value without a point is a constant.
struct JointBoundSettings {
  std::vector<double> at;  // rad/s or m/s, rad or m, N m or N; empty for a constant
  std::vector<double> value{1};
  double momentum_error = 0;  // of p by that of the measured velocities, N m s or N s
  double act_ratio = 1;       // the second level: so many times the threshold, >= 1
  BoundVariable variable = BoundVariable::kSpeed;
};
struct BoundSettings {
  enum class Kind : std::uint8_t {
    kConstant,
    kScaledNorm,
    kTable,
    kPerJoint
  } kind = Kind::kConstant;
  ConstantBoundSettings constant;
  ScaledNormBoundSettings scaled_norm;
  TableBoundSettings table;
  std::vector<JointBoundSettings> joints;  // kPerJoint, the only kind of EstimatorSpace::kTorque
  // Of the second filter (EstimatorSettings::fast_alpha), one per joint or none. Its momentum_error
  // is that of `joints`.
  std::vector<JointBoundSettings> fast = {};
  double velocity_error = 0;  // largest error of the measured velocity, rad/s or m/s; not kPerJoint
  // Calibrated on velocities as they were recorded, by a drive or a controller's observer: their
  // error is in it, and whoever judges such velocities adds none.
  bool covers_velocities = false;
  std::string source = {};  // where the numbers come from, free text; empty: not said

  // Whether a joint is noticed before it acts: an act_ratio is above 1.
  [[nodiscard]] bool has_two_levels() const {
    const auto is_above = [](const JointBoundSettings& joint) { return joint.act_ratio > 1; };
    return std::any_of(joints.begin(), joints.end(), is_above) ||
           std::any_of(fast.begin(), fast.end(), is_above);
  }
};

// Where one quantity of a log comes from: SI value = scale * unit * source + offset, `unit` as
// units.hpp knows it, 1 where it does not. `scale_source` names a scalar variable of the log (a
// drive gain in a .mat file, say) that multiplies scale. Where there is a `sum`, its terms take the
// source's place; they have no offset and no sum of their own.
struct Channel {
  std::string source;  // a name, or the number of a column from 1; empty where there is a sum
  double scale = 1;
  double offset = 0;
  std::string scale_source;  // empty: none
  std::string unit;          // of the source; empty: SI
  std::vector<Channel> sum = {};
};

// A known mass that the robot carries while it is recorded: a point in the last link's frame.
struct Payload {
  double mass_kg = 0;
  std::array<double, 3> place_m{0, 0, 0};
};

// Which recording it is of: its file as the user names it, or that without its folder.
struct RecordingPayload {
  std::string recording;
  Payload payload;
};

// What the channel of a joint is of (docs/robot-file.md#channels), and the key that says so.
enum class ChannelOf : std::uint8_t {
  kJoint,    // position, velocity, torque: of the joint; a torque as the drive gives it there
  kMotor,    // motor_position, motor_velocity, motor_torque: of the motor of that number
  kCurrent,  // motor_current: of that motor
  kSensor,   // sensor_torque: of a sensor behind the gear, which sees what the link gets
};

struct ChannelMap {
  Channel time;                                  // t, s; not read where there is a period_s
  std::vector<Channel> more_times = {};          // of the second file of a recording, and so on
  double period_s = 0;                           // between two samples; 0: as the time says
  std::vector<Channel> position;                 // per joint
  std::vector<std::optional<Channel>> velocity;  // none: derived from the position
  std::vector<Channel> torque;                   // per joint
  // Per joint, what these are of; empty: of the joints, all of them. Where there are other sides,
  // the robot's transmission leads to the joints.
  std::vector<ChannelOf> position_of = {};
  std::vector<ChannelOf> velocity_of = {};
  std::vector<ChannelOf> torque_of = {};
  // Per joint: of a sensor behind the gear, beside the torque of the drive; empty: of no joint.
  std::vector<std::optional<Channel>> sensor_torque = {};
  std::map<std::string, Channel> extra;  // name -> channel
  std::string dbc = {};  // DBC file that decodes a candump log; empty: offnominal's own frames
  bool at_rest = false;  // the recordings are hold maps (log/hold_map.hpp): time is not read
  std::vector<RecordingPayload> payloads = {};  // of recordings that have a known payload
};

// Between motors and joints, as many of one as of the other: transmission.hpp has the equations.
struct TransmissionSettings {
  // Motor per joint, rad per rad or m: one number each where no joint shares a motor, otherwise a
  // row for every motor. One of the two is empty.
  std::vector<double> ratio;
  std::vector<std::vector<double>> matrix;
  std::vector<double> offset_rad;       // of the motors where all joints are at 0; empty: none
  std::vector<double> torque_constant;  // N m/A, per motor; empty: not known
  std::string source = {};              // where the numbers come from, free text; empty: not said
};

// An effect that the robot's file knows. `fitted`: its numbers come from a recording, `add` may fit
// them again together with a new effect; otherwise they are given and stay.
struct RobotEffect : Effect<double> {
  bool fitted = false;
  std::string source = {};  // where the numbers come from, free text; empty: not said
};

struct RobotDescription {
  std::string name;
  std::string source;  // where the numbers come from, free text
  std::array<double, 3> gravity_m_s2{0, 0, -9.81};
  std::vector<RobotJoint> joints;
  std::vector<RobotEffect> effects;  // joint counts from 0
  EstimatorSettings estimator;
  ArmingSettings arming;
  std::optional<BoundSettings> bound;
  std::optional<TransmissionSettings> transmission;  // none: everything is said of the joints
  std::optional<DriveSettings> drives;               // none: drive_settings()
  std::optional<ChannelMap> channels;
  std::vector<Blank> blanks = {};  // none, but where they were allowed when it was read
  // The text it was read from, so that writing keeps comments and order; null: none. Copies, of
  // which a fit makes thousands, share it.
  std::shared_ptr<const std::string> file_text = nullptr;

  // Of the units of an effect's parameters: motors turn.
  [[nodiscard]] JointType type_of(const Effect<double>& effect) const {
    return effect.of_motor ? JointType::kRevolute : joints[effect.joint].joint.type;
  }
  [[nodiscard]] int joint_count() const { return static_cast<int>(joints.size()); }
  [[nodiscard]] DriveSettings drive_settings() const { return drives.value_or(DriveSettings{}); }
};

}  // namespace offnominal::desk
