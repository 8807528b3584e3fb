#pragma once

#include <Eigen/Core>
#include <string>

namespace offnominal::tools::discovery {

enum class DataFaultKind {
  kDegrees,
  kTorqueSign,
  kStaleSamples,
  kClockSkew,
  kSaturation,
  kGaps,
};

// "degrees", "torque_sign", "stale_samples", "clock_skew", "saturation" or "gaps".
const char* name_of(DataFaultKind kind);

// What makes a recording useless for physics until it is mended.
struct DataFault {
  DataFaultKind kind = DataFaultKind::kGaps;
  Eigen::Index joint = -1;  // from 0; -1: all
  // kDegrees: factor on the positions. kTorqueSign: slope of measured against model torque, or of
  // torque against velocity. kStaleSamples, kSaturation: share of the samples. kClockSkew: s, the
  // torque late where positive. kGaps: longest step of time, s.
  double size = 0;
  std::string unit;   // of size, empty: none
  std::string words;  // what was found, with numbers
  std::string mend;   // what to do
};

}  // namespace offnominal::tools::discovery
