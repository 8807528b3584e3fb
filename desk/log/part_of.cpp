#include "log/part_of.hpp"

#include <algorithm>

namespace offnominal::desk {

using Eigen::Index;

Log part_of(const Log& log, const RowSpan& samples) {
  const Index first = samples.first;
  const Index count = samples.count();
  Log part;
  part.file = log.file;
  part.period_s = log.period_s;
  part.t_s = log.t_s.segment(first, count);
  part.q = log.q.middleRows(first, count);
  part.dq = log.dq.middleRows(first, count);
  part.tau = log.tau.middleRows(first, count);
  if (log.readings.rows() > 0) part.readings = log.readings.middleRows(first, count);
  if (log.sensor_tau.rows() > 0) part.sensor_tau = log.sensor_tau.middleRows(first, count);
  part.dq_derived = log.dq_derived;
  for (const auto& [name, values] : log.extra) part.extra[name] = values.segment(first, count);
  part.remarks = log.remarks;
  part.payload = log.payload;
  part.channels = log.channels;
  part.common_header = log.common_header;
  part.stamps_s = log.stamps_s;
  part.row_numbers = log.row_numbers;
  for (const LeftOut& out : log.left_out) {
    part.left_out.push_back(
        {out.joint, {out.rows.first - first, out.rows.last - first}, out.spread_periods});
  }
  return part;
}

std::vector<Log> untouched_parts(const Log& log, double shortest_s) {
  if (log.left_out.empty()) return {log};
  std::vector<RowSpan> out;
  for (const LeftOut& one : log.left_out) out.push_back(one.rows);
  std::sort(out.begin(), out.end(),
            [](const RowSpan& a, const RowSpan& b) { return a.first < b.first; });
  out.push_back({log.sample_count(), log.sample_count()});
  std::vector<Log> parts;
  Index next = 0;
  for (const RowSpan& one : out) {
    const RowSpan part{next, std::min(one.first, log.sample_count()) - 1};
    if (static_cast<double>(part.count()) * log.period_s >= shortest_s) {
      parts.push_back(part_of(log, part));
      parts.back().left_out.clear();
    }
    next = std::max(next, one.last + 1);
  }
  return parts;
}

}  // namespace offnominal::desk
