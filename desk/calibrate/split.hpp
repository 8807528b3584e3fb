#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "calibrate/recorded_error.hpp"
#include "log/log.hpp"

namespace offnominal::desk {

/// Samples begin to end - 1 of one recording.
struct SampleRange {
  std::size_t recording = 0;
  Eigen::Index begin = 0;
  Eigen::Index end = 0;
};

struct Split {
  std::vector<SampleRange> folds;   // to calibrate on; each takes its turn at being unseen
  std::vector<SampleRange> always;  // calibrated on, never unseen: the only start of a run there is
  std::vector<SampleRange> held_out;  // to count alarms on
};

/// `given` recordings come first in `recordings`; those behind them are for hold-out. Where there
/// are none, the last of several given ones is held out, or the last fifth of the only one. Folds
/// are whole recordings, or fifths of the one that is left: there the first `settling_s`, in which
/// the filter forgets its start, cannot be told from the other fifths and are always calibrated on.
[[nodiscard]] Split split(const std::vector<RecordedError>& recordings, std::size_t given,
                          double settling_s);

/// Takes out of parts between faults (log/part_of.hpp), which are in the order of their recordings,
/// what is held out: all of the last of several recordings, or trailing parts of the only one until
/// they are a fifth of its samples, where both pieces are of `shortest_s` or more only a piece of
/// the last of them. Nothing of a recording in one part, of which split() holds out the last fifth.
[[nodiscard]] std::vector<Log> take_held_out(std::vector<Log>& parts, double shortest_s);

}  // namespace offnominal::desk
