#pragma once

#include <array>
#include <cstdint>
#include <offnominal/model/quantity.hpp>

// An effect is a named physical contribution to the torque (N m; N on a prismatic joint) of one
// joint. Sign: an effect's torque is what the drive has to supply for it, so that
//   M(q) ddq + V(q, dq) dq + G(q) + sum of effects = tau.
// A positive friction coefficient therefore takes energy out of the joint.
//
// There are four ways to act, told apart by what an effect's struct has:
//   torque()                              a torque by the motion and the time (most of them)
//   reflected_inertia(), point_mass()     a change of the inertia, taken up when the model is made
//   friction_per_load(), told_per_given() a scale on what passes from drive to load
//   (torque_path.hpp)
//   torque_of_state(), delay_s()          by what was before (effect_memory.hpp)

namespace offnominal {

inline constexpr int kMaxEffectParameters = 8;

// Which physics an effect is. The numbers are stable, names are name_of(kind).
enum class EffectKind : std::uint8_t {
  kViscousFriction = 0,
  kCoulombFriction = 1,
  kFrictionAsymmetry = 2,
  kTorqueOffset = 3,
  kStribeckFriction = 4,
  kQuadraticFriction = 5,
  kRotorInertia = 6,
  kTipPayload = 7,
  kLinkMass = 8,
  kJointStiffness = 9,
  kCoggingTorque = 10,
  kPeriodicDisturbance = 11,
  kTemperatureDrift = 12,
  kJointCoupling = 13,
  kLoadDependentFriction = 14,
  kTorqueScale = 15,
  kHysteresis = 16,
  kTimeDelay = 17,
  kJointElasticity = 18,
  kBacklash = 19,
  kGearLoss = 20,
  kPositionTorque = 21,
};

// How a parameter enters the effect's torque.
enum class ParameterRole : std::uint8_t {
  kLinear,  // the torque is proportional to it: least squares can find it
  kShape,   // it sits inside a nonlinearity: it is searched for, or left as given
};

// At which end of the range that is searched a shape makes another effect of this one.
enum class OtherEffectAt : std::uint8_t { kNeitherEnd, kLowest, kHighest };

// Where a search looks for a shape parameter, as shares of what the motion shows of its quantity:
// of the top speed (kVelocity), the range moved (kDistance) or the duration (kTime).
struct SearchedShare {
  double from = 0;
  double to = 0;  // 0: not searched in this way
  OtherEffectAt other_effect = OtherEffectAt::kNeitherEnd;
};

struct ParameterInfo {
  const char* name;  // key in a robot file
  Quantity quantity;
  ParameterRole role;
  double min;  // allowed range, both ends included
  double max;
  bool required;
  double default_value;  // where it is not required
  const char* meaning;
  SearchedShare searched = {};
  // A shape that follows from the recordings: a position is the lowest that they show, a distance
  // how far it is from there to the highest.
  bool as_seen = false;
};

// How an effect acts: what its struct has.
enum class EffectAction : std::uint8_t {
  kTorque,            // torque(): by the motion and the time
  kReflectedInertia,  // reflected_inertia(): on the joint's own acceleration
  kPointMass,         // point_mass(): part of the rigid body
  kFrictionPerLoad,   // friction_per_load(): by what passes from drive to load
  kToldPerGiven,      // told_per_given(): a scale on all that the drive gives
  kTorqueOfState,     // torque_of_state(): by the way that the joint went
  kDelay,             // delay_s(): by when it acts
  kDisplacement,      // none of these: the link is not where the motor is
};

// The one variable of its joint that an effect's torque is a function of.
enum class EffectVariable : std::uint8_t { kNone, kPosition, kVelocity, kLoad };

// The sign that the linear parameters of an effect may have.
enum class CoefficientSign : std::uint8_t {
  kEither,
  // Friction beyond other friction: below zero only where enough of that stands beside it.
  kMostlyPositive,
  kPositive,  // the torque is against the motion at every instant
};

// What the first parameter of a friction is of all that its joint has.
enum class FrictionPart : std::uint8_t {
  kOther,        // none of these
  kDry,          // of one level, whose shape at a reversal nobody knows
  kAtRest,       // what a joint that stands still has above its dry friction
  kPerVelocity,  // proportional to speed
};

// What an effect is, beside its formula.
struct EffectTraits {
  // Takes energy out of its own joint, together with the joint's other friction. What tells two
  // directions apart is none, since no recording tells that from a constant torque; nor is what
  // another joint's motion causes.
  bool is_friction = false;
  FrictionPart part = FrictionPart::kOther;
  bool acts_at_rest = false;     // where nothing moves
  bool counts_time = false;      // by the time since the run began
  bool needs_no_motion = false;  // a joint that never moves shows it
  // In rotor or gear, before a torque sensor that sits behind the gear: such a sensor does not see
  // it. Friction is not, since bearings and seals behind the sensor rub too.
  bool is_before_sensor = false;
  CoefficientSign sign = CoefficientSign::kEither;
  EffectVariable follows = EffectVariable::kNone;
  // A curve of any shape over that variable: it can stand for every other effect of it, and is
  // named only where none of them is what the recordings show.
  bool has_any_shape = false;
  // Friction without which there is no drive: a model that lacks it is asked for it first.
  bool every_drive_has = false;
  // By itself it looks like that friction, and is named only where it is clearly more likely.
  bool passes_for_friction = false;
  // Tells the two directions apart: a joint that turns one way only does not show it.
  bool needs_both_directions = false;
  // A robot may have more or less of it from one moment to the next.
  bool may_change = false;
};

// One effect with its values. `joint` counts from 0; `parameters` in the order of the effect's
// kParameters, the rest 0. With `of_motor` it acts on the shaft of the motor of that number
// (Transmission, chain.hpp): by the motor's position and velocity, in rad, with a torque of the
// motor. Not every effect can (motor_may_have(), effect_list.hpp).
template <typename Scalar>
struct Effect {
  EffectKind kind = EffectKind::kViscousFriction;
  std::uint8_t joint = 0;
  std::array<Scalar, kMaxEffectParameters> parameters{};
  bool of_motor = false;
};

// What an effect may depend on at one joint at one instant.
template <typename Scalar>
struct JointInstant {
  Scalar q{};       // position, rad or m
  Scalar dq{};      // velocity, rad/s or m/s
  double time_s{};  // since the run's origin, s: a float would not tell the ticks of a day apart
  // Velocity of the joint that the effect's parameter of Quantity::kJointNumber names, rad/s or
  // m/s; 0 for an effect without one.
  Scalar source_dq{};
};

}  // namespace offnominal
