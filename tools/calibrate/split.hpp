#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "calibrate/recorded_error.hpp"

namespace offnominal::tools {

/// Samples begin to end - 1 of one recording.
struct Stretch {
  std::size_t recording = 0;
  Eigen::Index begin = 0;
  Eigen::Index end = 0;
};

struct Split {
  std::vector<Stretch> folds;     // to calibrate on; each takes its turn at being unseen
  std::vector<Stretch> held_out;  // to count alarms on
};

/// `given` recordings come first in `recordings`; those behind them are for hold-out. Where there
/// are none, the last of several given ones is held out, or the last fifth of the only one. Folds
/// are whole recordings, or fifths where one is left.
[[nodiscard]] Split split(const std::vector<RecordedError>& recordings, std::size_t given);

}  // namespace offnominal::tools
