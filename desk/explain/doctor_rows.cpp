#include <algorithm>
#include <vector>

#include "explain/doctor_checks.hpp"

// A recording that was resampled, row by row as it was recorded: there a value that an encoder held
// is the same, and its steps are what they are.

namespace offnominal::desk {
namespace {

using Eigen::Index;

// Of the recorded rows: the last one before the sample of the grid at `t_s`, or at it.
Index row_before(const RecordedRows& rows, double t_s) {
  const auto after = std::upper_bound(rows.t_s.begin(), rows.t_s.end(), t_s);
  return std::max<Index>(0, after - rows.t_s.begin() - 1);
}

// A spline swings about what was left out for a few samples more.
Index rings_of(const DataFault& fault) {
  constexpr Index kRings = 3;
  const bool breaks = fault.kind == DataFaultKind::kJump || fault.kind == DataFaultKind::kStart;
  return fault.signal == FaultySignal::kPosition && breaks ? kRings : 0;
}

}  // namespace

Log rows_as_recorded(const Log& log) {
  const RecordedRows& recorded = *log.recorded;
  Log rows;
  rows.file = log.file;
  rows.period_s = log.period_s;
  rows.t_s = recorded.t_s;
  rows.q = recorded.q;
  rows.dq = recorded.dq;
  rows.tau = recorded.tau;
  rows.dq_derived = log.dq_derived;
  rows.channels = log.channels;
  for (const RowSpan& gap : log.gaps) {
    const double slack = log.period_s / 2;
    const Index before = row_before(recorded, log.t_s[gap.first] - slack);
    rows.gaps.push_back({before, std::min(before + 1, rows.sample_count() - 1)});
  }
  return rows;
}

void to_samples(const Log& log, std::vector<DataFault>& faults) {
  const RecordedRows& rows = *log.recorded;
  const Index samples = log.sample_count();
  for (DataFault& fault : faults) {
    const Index rings = rings_of(fault);
    for (FaultSpan& span : fault.spans) {
      const RowSpan of_rows = span.samples;
      // All that the rows had a part in: what lies between the rows around them.
      const bool from_start = of_rows.first == 0;
      const bool to_end = of_rows.last + 1 >= rows.t_s.size();
      const auto begin = log.t_s.begin();
      const Index first =
          from_start ? 0
                     : std::upper_bound(begin, log.t_s.end(), rows.t_s[of_rows.first - 1]) - begin;
      const Index last =
          to_end ? samples - 1
                 : std::lower_bound(begin, log.t_s.end(), rows.t_s[of_rows.last + 1]) - begin - 1;
      span.samples.first = std::clamp<Index>(first - rings, 0, samples - 1);
      span.samples.last = std::clamp<Index>(last + rings, span.samples.first, samples - 1);
      span.first_row = log.row_number(rows.first + of_rows.first) + 1;
      span.last_row = log.row_number(rows.first + of_rows.last) + 1;
    }
  }
}

}  // namespace offnominal::desk
