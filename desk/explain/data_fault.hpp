#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "log/log.hpp"

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
  kStuck,
  kJump,
  kStart,
  kGravity,
  kTorqueUnit,
  kJointOrder,
  kJointZero,
  kNothingLeft,  // the last: the only one that nobody can overrule
};

// "degrees", "torque_sign", "stale_samples", "clock_skew", "saturation", "gaps", "time_unit",
// "velocity", "wrapped_position", "stuck", "jump", "start", "nothing_left", "gravity",
// "torque_unit", "joint_order" or "joint_zero".
const char* name_of(DataFaultKind kind);

// Which of a joint's signals a fault is of.
enum class FaultySignal { kWhole, kPosition, kTorque };

// A stretch of a recording: samples, the rows of the file that they come from, counted from 1
// behind its header, and their times.
struct FaultSpan {
  RowSpan samples;
  Eigen::Index first_row = 0;
  Eigen::Index last_row = 0;
  double from_s = 0;
  double to_s = 0;
};

// What makes a recording useless for physics until it is mended.
struct DataFault {
  DataFaultKind kind = DataFaultKind::kGaps;
  Eigen::Index joint = -1;  // from 0; -1: all
  // kDegrees: factor on the positions. kTorqueSign: slope of measured against model torque, or of
  // torque against velocity. kStaleSamples, kSaturation: share of the samples. kClockSkew: s, the
  // torque late where positive. kGaps: longest step of time, s. kTimeUnit: factor on the time.
  // kVelocity: the velocity over the derivative of the position, 0 where they have nothing in
  // common. kWrapped, kJump: the jump, as recorded. kStuck, kStart: share of the samples.
  // kGravity: between where it points and where the file has it, deg. kTorqueUnit: measured over
  // model torque, of all joints that of the first one that tells. kJointOrder: share of a torque
  // that its model leaves. kJointZero: what is to be added to the positions, of the last joint,
  // rad.
  double size = 0;
  std::string unit;                   // of size, empty: none
  std::string words;                  // what was found, with numbers
  std::string mend;                   // what to do
  bool certain = true;                // else it may be right, and nothing is refused for it
  std::string file = {};              // the recording
  std::optional<double> at_s = {};    // where in it first; none: throughout
  std::vector<std::string> channels;  // lines of [channels] that mend it; empty: none can
  FaultySignal signal = FaultySignal::kWhole;
  std::vector<FaultSpan> spans = {};           // where it is; empty: throughout
  std::vector<Eigen::Index> left_out_of = {};  // joints that do without the spans; empty: none
  bool overruled = false;                      // by a KeepFault
  // The masses of the links, or of what is carried, say the same: said, and the search goes on.
  bool or_masses = false;
};

// What the user says is no fault: of a joint, or of all for -1.
struct KeepFault {
  Eigen::Index joint = -1;
  DataFaultKind kind = DataFaultKind::kGaps;
};

// What --keep is given to overrule it: "2:saturation".
std::string keep_text_of(const DataFault& fault);

// "2:saturation" or "all:gaps". Throws InputError in the name of --keep.
KeepFault keep_fault_of(const std::string& text);
// The names of all that can be kept.
std::vector<std::string> keep_reasons();

// Whether an answer that rests on positions and torques, or on velocities as well, is wrong with
// it: another unit, a wrong sign, positions that jump.
enum class RestsOn { kTorque, kVelocityToo };
bool spoils(const DataFault& fault, RestsOn what);

}  // namespace offnominal::desk
