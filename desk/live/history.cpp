#include "live/history.hpp"

#include <algorithm>
#include <cmath>

namespace offnominal::desk::live {

using Eigen::Index;

History::History(std::size_t joints, std::size_t judged, std::size_t rows)
    : joints_(joints),
      judged_(judged),
      stride_(1 + 3 * joints + 3 * judged),
      most_(std::max<std::size_t>(rows, 1)),
      rows_(most_ * stride_) {}

void History::push(double t_s, std::span<const double> q, std::span<const double> dq,
                   std::span<const double> tau, const Levels& levels) {
  double* into = rows_.data() + stride_ * ((first_ + count_) % most_);
  if (count_ == most_) {
    first_ = (first_ + 1) % most_;
  } else {
    ++count_;
  }
  *into++ = t_s;
  for (const std::span<const double> part :
       {q, dq, tau, levels.residual, levels.threshold, levels.act}) {
    into = std::copy(part.begin(), part.end(), into);
  }
}

History::Rows History::between(double from_s, double to_s) const {
  std::size_t begin = 0;
  std::size_t end = count_;
  while (begin < end && time_s(begin) < from_s) ++begin;
  while (end > begin && time_s(end - 1) > to_s) --end;
  Rows rows{joints_, judged_, {}};
  rows.all.resize(static_cast<Index>(end - begin), static_cast<Index>(stride_));
  for (std::size_t row = begin; row < end; ++row) {
    std::copy_n(at(row), stride_, rows.all.row(static_cast<Index>(row - begin)).data());
  }
  return rows;
}

Eigen::VectorXd History::Rows::residual(std::size_t of) const {
  return all.col(static_cast<Index>(1 + 3 * joints + of));
}

Eigen::VectorXd History::Rows::threshold(std::size_t of) const {
  return all.col(static_cast<Index>(1 + 3 * joints + judged + of));
}

Eigen::VectorXd History::Rows::act(std::size_t of) const {
  return all.col(static_cast<Index>(1 + 3 * joints + 2 * judged + of));
}

History::Rows History::Rows::since(double from_s) const {
  const auto earlier = (all.col(0).array() < from_s).count();
  return {joints, judged, all.bottomRows(all.rows() - earlier)};
}

History::Rows History::Rows::before(double end_s) const {
  return {joints, judged, all.topRows((all.col(0).array() < end_s).count())};
}

Log History::Rows::log(const std::string& file, double period_s) const {
  Log log;
  log.file = file;
  log.period_s = period_s;
  log.t_s = all.col(0);
  const auto count = static_cast<Index>(joints);
  log.q = all.middleCols(1, count);
  log.dq = all.middleCols(1 + count, count);
  log.tau = all.middleCols(1 + 2 * count, count);
  log.dq_derived.assign(joints, false);
  return log;
}

void Strip::push(double t_s, const Levels& levels) {
  const double begin_s = kStepS * std::floor(t_s / kStepS);
  const bool is_new = count_ == 0 || step(count_ - 1)[0] != begin_s;
  if (is_new) ++count_;
  const std::span<double> now = step(count_ - 1);
  now[0] = begin_s;
  for (std::size_t i = 0; i < judged_; ++i) {
    double* of = now.data() + 1 + kOfEach * i;
    const double residual = levels.residual[i];
    of[0] = is_new ? residual : std::min(of[0], residual);
    of[1] = is_new ? residual : std::max(of[1], residual);
    of[2] = is_new ? levels.threshold[i] : std::min(of[2], levels.threshold[i]);
    of[3] = is_new ? levels.act[i] : std::min(of[3], levels.act[i]);
  }
}

Strip::Steps Strip::since(std::uint64_t from) const {
  Steps steps;
  steps.low.resize(judged_);
  steps.high.resize(judged_);
  steps.threshold.resize(judged_);
  steps.act.resize(judged_);
  // The last one is still under way.
  const std::uint64_t end = count_ == 0 ? 0 : count_ - 1;
  const std::uint64_t oldest = count_ > kSteps ? count_ - kSteps : 0;
  steps.first = std::min(std::max(from, oldest), end);
  steps.next = end;
  for (std::uint64_t number = steps.first; number < end; ++number) {
    const std::span<const double> one = step(number);
    steps.t_s.push_back(one[0]);
    for (std::size_t i = 0; i < judged_; ++i) {
      const auto of = one.subspan(1 + kOfEach * i, kOfEach);
      steps.low[i].push_back(of[0]);
      steps.high[i].push_back(of[1]);
      steps.threshold[i].push_back(of[2]);
      steps.act[i].push_back(of[3]);
    }
  }
  return steps;
}

}  // namespace offnominal::desk::live
