// What a blind benchmark asks the simulator for: which physical effect is hidden in the robot, what
// is wrong with its log, how it moves. Everything else is drawn from the seed.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

namespace offnominal::sim::hidden {

/// Effects that the analysis has a candidate for; see effect_sizes.hpp for how large each is drawn.
enum class HiddenEffect {
  kCoulombFriction,
  kViscousFriction,
  kQuadraticFriction,
  kStribeckFriction,
  kFrictionAsymmetry,
  kLoadDependentFriction,
  kHysteresis,
  kTorqueOffset,
  kTorqueScale,
  kRotorInertia,
  kLinkMass,
  kTipPayload,
  kCoggingTorque,
  kJointStiffness,
  kJointElasticity,
  kBacklash,
  kTimeDelay,
  kPeriodicDisturbance,
  kJointCoupling,
  kTemperatureDrift,
};

inline constexpr std::array<HiddenEffect, 20> kAllHiddenEffects = {
    HiddenEffect::kCoulombFriction,   HiddenEffect::kViscousFriction,
    HiddenEffect::kQuadraticFriction, HiddenEffect::kStribeckFriction,
    HiddenEffect::kFrictionAsymmetry, HiddenEffect::kLoadDependentFriction,
    HiddenEffect::kHysteresis,        HiddenEffect::kTorqueOffset,
    HiddenEffect::kTorqueScale,       HiddenEffect::kRotorInertia,
    HiddenEffect::kLinkMass,          HiddenEffect::kTipPayload,
    HiddenEffect::kCoggingTorque,     HiddenEffect::kJointStiffness,
    HiddenEffect::kJointElasticity,   HiddenEffect::kBacklash,
    HiddenEffect::kTimeDelay,         HiddenEffect::kPeriodicDisturbance,
    HiddenEffect::kJointCoupling,     HiddenEffect::kTemperatureDrift,
};

/// Effects that the analysis has no candidate for.
enum class OutsideEffect {
  kNone,
  kEndStop,   ///< one-sided spring beyond an angle that the motion reaches
  kWornSpot,  ///< more friction in a narrow range of positions
  kDragBand,  ///< more friction in a narrow band of speeds, a rubbing fan or a howling belt
  kMagneticSaturation,  ///< the drive gives less than it logs beyond a torque
  kTransientContact,    ///< someone pushes, for a moment
};

inline constexpr std::array<OutsideEffect, 5> kAllOutsideEffects = {
    OutsideEffect::kEndStop, OutsideEffect::kWornSpot, OutsideEffect::kDragBand,
    OutsideEffect::kMagneticSaturation, OutsideEffect::kTransientContact};

/// What is wrong with the log. The robot moves the same; every log of this robot has the fault.
enum class DataFault {
  kNone,
  kDegrees,            ///< positions in degrees
  kSwappedTorqueSign,  ///< torque of one joint or of both with the wrong sign
  kStaleSamples,  ///< 2 to 5 % of the rows repeat the last good value of positions, torques or all
  kClockSkew,     ///< torques 15 to 40 ms late against the positions, or a clock 0.15 to 0.3 % off
};

enum class Excitation {
  kRich,  ///< both joints, 0.1 to 1.5 Hz, about +-1 rad, fast and slow phases
  kPoor,  ///< one slow small sinusoid, or one speed to and fro, or a tiny range
};

struct Request {
  std::uint64_t seed = 0;
  std::vector<HiddenEffect> effects;  ///< each at most once; may be empty
  OutsideEffect outside = OutsideEffect::kNone;
  DataFault fault = DataFault::kNone;
  Excitation excitation = Excitation::kRich;
  double effect_size = 1.0;  ///< factor on the drawn size of effects and outside effect, > 0
  double torque_noise_share = 0.002;  ///< standard deviation as a share of the torque limit, >= 0
  int encoder_bits = 19;              ///< counts per turn of the joint 2^bits, 1 to 32
  double duration_s = 30.0;           ///< of the recording, > 0
  double sample_rate_hz = 1000.0;     ///< of drive and log, 100 to 10000
};

/// Throws std::invalid_argument naming the field, what was found and what is allowed.
void validate(const Request& request);

/// Names as in robot files: "coulomb_friction", ...
std::string_view name(HiddenEffect effect);
std::string_view name(OutsideEffect effect);
std::string_view name(DataFault fault);

/// What the torque of an outside effect is a function of: "position", "velocity", "load" or "time";
/// "" for kNone.
std::string_view variable(OutsideEffect effect);

}  // namespace offnominal::sim::hidden
