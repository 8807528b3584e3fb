#include "offnominal/sim/hidden/data_fault.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace offnominal::sim::hidden {
namespace {

using Eigen::Index;

constexpr int kLongestBurst = 20;  // rows

// Torques of the times (t - skew) rate, linear between rows.
Eigen::MatrixXd skewed(const Recording& log, const LogFault& fault) {
  const Index n = log.t_s.size();
  const double period_s = n > 1 ? log.t_s[1] - log.t_s[0] : 1.0;
  Eigen::MatrixXd tau(n, 2);
  for (Index k = 0; k < n; ++k) {
    const double row = (log.t_s[k] - fault.skew_s) * fault.clock_rate / period_s;
    const double inside = std::clamp(row, 0.0, static_cast<double>(n - 1));
    const auto before = std::min(static_cast<Index>(inside), std::max<Index>(n - 2, 0));
    const Index after = std::min(before + 1, n - 1);
    const double part = inside - static_cast<double>(before);
    tau.row(k) = (1.0 - part) * log.tau.row(before) + part * log.tau.row(after);
  }
  return tau;
}

void freeze(Recording& log, const LogFault& fault, Draws& draws) {
  const Index n = log.t_s.size();
  const auto wanted = static_cast<Index>(fault.stale_share * static_cast<double>(n));
  for (Index frozen = 0; frozen < wanted;) {
    const Index length = std::min<Index>(3 + draws.below(kLongestBurst - 2), wanted - frozen);
    const auto start = static_cast<Index>(draws.uniform(0.0, static_cast<double>(n - length - 1)));
    for (Index k = start + 1; k <= start + length; ++k) {
      if (fault.stale_q) log.q.row(k) = log.q.row(start);
      if (fault.stale_tau) log.tau.row(k) = log.tau.row(start);
    }
    frozen += length;
  }
}

}  // namespace

LogFault draw_log_fault(DataFault kind, Draws draws) {
  LogFault fault;
  fault.kind = kind;
  const int one_two_or_all = draws.below(3);
  fault.swapped = {one_two_or_all != 1, one_two_or_all != 0};
  fault.stale_q = one_two_or_all != 1;
  fault.stale_tau = one_two_or_all != 0;
  fault.stale_share = draws.uniform(0.02, 0.05);
  if (draws.below(2) == 0) {
    fault.skew_s = draws.uniform(0.015, 0.04);
  } else {
    fault.clock_rate = 1.0 + draws.either_sign(1.5e-3, 3e-3);
  }
  return fault;
}

Recording with_fault(Recording recording, const LogFault& fault, Draws draws) {
  switch (fault.kind) {
    case DataFault::kNone:
      break;
    case DataFault::kDegrees:
      recording.q *= 180.0 / std::numbers::pi;
      break;
    case DataFault::kSwappedTorqueSign:
      for (Index j = 0; j < 2; ++j) {
        if (fault.swapped[static_cast<std::size_t>(j)]) recording.tau.col(j) *= -1.0;
      }
      break;
    case DataFault::kStaleSamples:
      freeze(recording, fault, draws);
      break;
    case DataFault::kClockSkew:
      recording.tau = skewed(recording, fault);
      break;
  }
  return recording;
}

std::vector<TrueParameter> parameters(const LogFault& fault) {
  switch (fault.kind) {
    case DataFault::kNone:
    case DataFault::kDegrees:
      break;
    case DataFault::kSwappedTorqueSign:
      return {{"joint1", fault.swapped[0] ? -1.0 : 1.0, ""},
              {"joint2", fault.swapped[1] ? -1.0 : 1.0, ""}};
    case DataFault::kStaleSamples:
      return {{"share", fault.stale_share, ""},
              {"position", fault.stale_q ? 1.0 : 0.0, ""},
              {"torque", fault.stale_tau ? 1.0 : 0.0, ""}};
    case DataFault::kClockSkew:
      return {{"skew", fault.skew_s, "s"}, {"clock_rate", fault.clock_rate, ""}};
  }
  return {};
}

}  // namespace offnominal::sim::hidden
