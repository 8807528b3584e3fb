#pragma once

#include <cstdint>

namespace offnominal {

// Result of every call that can refuse its input. The numbers are stable: they may be logged, sent
// over a bus and looked up in docs/troubleshooting.md. A call that does not return kOk has changed
// nothing.
enum class Status : std::uint8_t {
  kOk = 0,

  // A sample that cannot be used (1..19).
  kNonFinitePosition = 1,
  kNonFiniteVelocity = 2,
  kNonFiniteTorque = 3,
  kNonFiniteTime = 4,
  kPositionOutOfRange = 5,
  kVelocityOutOfRange = 6,
  kTorqueOutOfRange = 7,
  kNotInitialised = 8,
  kNonFiniteReference = 9,
  kWrongJointCount = 10,  // or a configuration; where their number is known at run time only

  // A configuration that validate() refuses (20..49).
  kInvalidPeriod = 20,
  kInvalidFilterPole = 21,
  kInvalidLearningRate = 22,
  kInvalidWeightRadius = 23,
  kInvalidHiddenUnits = 24,
  kInvalidInitialWeights = 25,
  kInvalidBound = 26,
  kInvalidLimit = 27,
  kInvalidGain = 28,
  kUnstablePeriod = 29,

  // A robot model that validate() refuses (50..69).
  kInvalidMass = 50,
  kInvalidInertia = 51,
  kInvalidAxis = 52,
  kInvalidRotation = 53,
  kInvalidEffect = 54,
  kInvalidGravity = 55,
  kInvalidOrigin = 56,
  kTooManyEffects = 57,
  kNeedsMemory = 58,

  // Mathematics without an answer (70..89).
  kSingularMassMatrix = 70,
  kNoGuarantee = 71,
  kNumericOverflow = 72,
};

// The name of a status as it stands above, without the leading k; "Unknown" for any other number.
[[nodiscard]] constexpr const char* name_of(Status status) {
  switch (status) {
    case Status::kOk:
      return "Ok";
    case Status::kNonFinitePosition:
      return "NonFinitePosition";
    case Status::kNonFiniteVelocity:
      return "NonFiniteVelocity";
    case Status::kNonFiniteTorque:
      return "NonFiniteTorque";
    case Status::kNonFiniteTime:
      return "NonFiniteTime";
    case Status::kPositionOutOfRange:
      return "PositionOutOfRange";
    case Status::kVelocityOutOfRange:
      return "VelocityOutOfRange";
    case Status::kTorqueOutOfRange:
      return "TorqueOutOfRange";
    case Status::kNotInitialised:
      return "NotInitialised";
    case Status::kNonFiniteReference:
      return "NonFiniteReference";
    case Status::kWrongJointCount:
      return "WrongJointCount";
    case Status::kInvalidPeriod:
      return "InvalidPeriod";
    case Status::kInvalidFilterPole:
      return "InvalidFilterPole";
    case Status::kInvalidLearningRate:
      return "InvalidLearningRate";
    case Status::kInvalidWeightRadius:
      return "InvalidWeightRadius";
    case Status::kInvalidHiddenUnits:
      return "InvalidHiddenUnits";
    case Status::kInvalidInitialWeights:
      return "InvalidInitialWeights";
    case Status::kInvalidBound:
      return "InvalidBound";
    case Status::kInvalidLimit:
      return "InvalidLimit";
    case Status::kInvalidGain:
      return "InvalidGain";
    case Status::kUnstablePeriod:
      return "UnstablePeriod";
    case Status::kInvalidMass:
      return "InvalidMass";
    case Status::kInvalidInertia:
      return "InvalidInertia";
    case Status::kInvalidAxis:
      return "InvalidAxis";
    case Status::kInvalidRotation:
      return "InvalidRotation";
    case Status::kInvalidEffect:
      return "InvalidEffect";
    case Status::kInvalidGravity:
      return "InvalidGravity";
    case Status::kInvalidOrigin:
      return "InvalidOrigin";
    case Status::kTooManyEffects:
      return "TooManyEffects";
    case Status::kNeedsMemory:
      return "NeedsMemory";
    case Status::kSingularMassMatrix:
      return "SingularMassMatrix";
    case Status::kNoGuarantee:
      return "NoGuarantee";
    case Status::kNumericOverflow:
      return "NumericOverflow";
  }
  return "Unknown";
}

}  // namespace offnominal
