#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

namespace offnominal::desk {

enum class DataFaultKind {
  kDegrees,
  kTorqueSign,
  kStaleSamples,
  kClockSkew,
  kSaturation,
  kGaps,
  kTimeUnit,
  kVelocity,
  kWrapped,
};

// "degrees", "torque_sign", "stale_samples", "clock_skew", "saturation", "gaps", "time_unit",
// "velocity" or "wrapped_position".
const char* name_of(DataFaultKind kind);

// What makes a recording useless for physics until it is mended.
struct DataFault {
  DataFaultKind kind = DataFaultKind::kGaps;
  Eigen::Index joint = -1;  // from 0; -1: all
  // kDegrees: factor on the positions. kTorqueSign: slope of measured against model torque, or of
  // torque against velocity. kStaleSamples, kSaturation: share of the samples. kClockSkew: s, the
  // torque late where positive. kGaps: longest step of time, s. kTimeUnit: factor on the time.
  // kVelocity: the velocity over the derivative of the position, 0 where they have nothing in
  // common. kWrapped: the jump, as recorded.
  double size = 0;
  std::string unit;                   // of size, empty: none
  std::string words;                  // what was found, with numbers
  std::string mend;                   // what to do
  bool certain = true;                // else it may be right, and nothing is refused for it
  std::string file = {};              // the recording
  std::optional<double> at_s = {};    // where in it first; none: throughout
  std::vector<std::string> channels;  // lines of [channels] that mend it; empty: none can
};

// Whether an answer that rests on positions and torques, or on velocities as well, is wrong with
// it: another unit, a wrong sign, positions that jump.
enum class RestsOn { kTorque, kVelocityToo };
bool spoils(const DataFault& fault, RestsOn what);

}  // namespace offnominal::desk
