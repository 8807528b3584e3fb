#include <fmt/format.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "explain/doctor_checks.hpp"
#include "explain/doctor_signal.hpp"
#include "explain/expected_torque.hpp"
#include "signal/quantile.hpp"
#include "signal/zero_phase.hpp"

// A torque that leaves for a while and comes back, both at once and as it never does otherwise: to
// another value, or to one that does not change, as 0. What it does to the joint tells whether it
// was there: a joint that is not accelerated by it was not driven by it.

namespace offnominal::desk {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr Index kShortest = 4;  // rows; shorter ones: find_jumps()

struct Excursion {
  RowSpan rows;
  bool constant = false;
};

// What the model says of the torque, against which a pulse is held.
class Response {
 public:
  Response(const Log& even, const RobotDescription& robot)
      : log_(even),
        cutoff_hz_(ExpectedTorque::cutoff_hz(even)),
        expected_(even, robot, even.sample_count()),
        unexplained_(even.tau.rows(), even.tau.cols()) {
    for (Index joint = 0; joint < even.tau.cols(); ++joint) {
      unexplained_.col(joint) =
          zero_phase_low_pass(even.tau.col(joint), cutoff_hz_, even.sample_rate_hz()) -
          expected_.torque().col(joint);
    }
  }

  // The share of a pulse between two times that the joint's motion shows: what is not in the
  // difference between the measured torque and the model's.
  [[nodiscard]] double share_of(const VectorXd& pulse, double from_s, double to_s,
                                Index joint) const {
    constexpr double kAroundS = 0.15;
    const double around_s = std::max(kAroundS, (to_s - from_s) / 2);
    const Index first = sample_at(from_s - around_s);
    const Index count = sample_at(to_s + around_s) + 1 - first;
    constexpr Index kUnknowns = 4;
    if (count < 2 * kUnknowns) return 1;
    const VectorXd smooth =
        zero_phase_low_pass(pulse.segment(first, count), cutoff_hz_, log_.sample_rate_hz());
    Eigen::MatrixXd columns(count, kUnknowns);
    const VectorXd x = VectorXd::LinSpaced(count, -1, 1);
    columns << smooth, VectorXd::Ones(count), x, x.cwiseAbs2();
    const VectorXd fit =
        columns.colPivHouseholderQr().solve(unexplained_.col(joint).segment(first, count));
    return 1 - fit[0];
  }

  [[nodiscard]] Index sample_at(double t_s) const { return expected_.sample_at(t_s); }

 private:
  const Log& log_;
  double cutoff_hz_;
  ExpectedTorque expected_;      // of every sample
  Eigen::MatrixXd unexplained_;  // low-passed measured torque less that; columns: joints
};

// Rows behind which the torque changes as it hardly ever does.
std::vector<Index> edges_of(const VectorXd& tau) {
  constexpr double kNearlyAll = 0.99;
  constexpr double kUnlikeAny = 3;
  constexpr double kOfLargest = 0.15;
  constexpr double kSteps = 4;
  const Index steps = tau.size() - 1;
  const VectorXd change = (tau.tail(steps) - tau.head(steps)).cwiseAbs();
  const double limit =
      std::max({kUnlikeAny * quantile(change, kNearlyAll),
                kOfLargest * quantile(tau.cwiseAbs(), kNearlyAll), kSteps * smallest_step(tau)});
  std::vector<Index> edges;
  if (!std::isfinite(limit)) return edges;
  for (Index i = 0; i < steps; ++i) {
    if (change[i] > limit) edges.push_back(i);
  }
  return edges;
}

// What lies between two edges, if it is one.
std::optional<Excursion> excursion_between(const VectorXd& tau, Index from, Index to,
                                           double period_s) {
  constexpr double kLongestS = 1;  // of a value that stays
  constexpr double kLongestPulseS = 0.25;
  constexpr double kAlike = 0.5;
  constexpr double kAtOnce = 0.6;
  constexpr double kOfLargest = 1.2;
  constexpr double kUsualShare = 0.99;
  const RowSpan rows{from + 1, to};
  if (rows.count() < kShortest) return std::nullopt;
  const auto inside = tau.segment(rows.first, rows.count());
  const double lasts_s = static_cast<double>(rows.count()) * period_s;
  if (inside.minCoeff() == inside.maxCoeff()) {
    // Only towards zero: a drive that jumps to a value and holds it was told so.
    const bool lost = inside[0] == 0;
    if (!lost || lasts_s > kLongestS) return std::nullopt;
    return Excursion{rows, true};
  }
  const double there = tau[from + 1] - tau[from];
  const double back = tau[to + 1] - tau[to];
  if (lasts_s > kLongestPulseS || there * back > 0 ||
      std::abs(there + back) > kAlike * std::max(std::abs(there), std::abs(back))) {
    return std::nullopt;
  }
  // What rises over some rows was there.
  const double height = (inside.array() - tau[from]).abs().maxCoeff();
  if (std::min(std::abs(there), std::abs(back)) < kAtOnce * height) return std::nullopt;
  VectorXd others(tau.size() - rows.count());
  others << tau.head(rows.first), tau.tail(tau.size() - rows.last - 1);
  const double large = kOfLargest * quantile(others.cwiseAbs(), kUsualShare);
  if (!(std::min(std::abs(there), std::abs(back)) > large)) return std::nullopt;
  return Excursion{rows, false};
}

// By how much each row differs from a straight line over the excursion.
VectorXd pulse_of(const VectorXd& tau, const RowSpan& rows) {
  VectorXd pulse = VectorXd::Zero(tau.size());
  const double from = tau[rows.first - 1];
  const double to = tau[rows.last + 1];
  for (Index i = rows.first; i <= rows.last; ++i) {
    const double share =
        static_cast<double>(i + 1 - rows.first) / static_cast<double>(rows.count() + 1);
    pulse[i] = tau[i] - from - share * (to - from);
  }
  return pulse;
}

// The same on the even grid.
VectorXd pulse_on(const Log& even, const Response& response, const Log& rows, const VectorXd& pulse,
                  const RowSpan& of) {
  VectorXd result = VectorXd::Zero(even.sample_count());
  Index row = of.first;
  for (Index i = response.sample_at(rows.t_s[of.first]); i <= response.sample_at(rows.t_s[of.last]);
       ++i) {
    while (row < of.last && rows.t_s[row + 1] <= even.t_s[i]) ++row;
    result[i] = pulse[row];
  }
  return result;
}

void add_fault(const Log& log, Index joint, const std::vector<Excursion>& found, bool constant,
               std::vector<DataFault>& faults) {
  std::vector<RowSpan> spans;
  Index rows = 0;
  double largest = 0;
  for (const Excursion& one : found) {
    if (one.constant != constant) continue;
    spans.push_back(one.rows);
    rows += one.rows.count();
    largest = std::max(
        largest,
        log.tau.col(joint).segment(one.rows.first, one.rows.count()).cwiseAbs().maxCoeff());
  }
  if (spans.empty()) return;
  DataFault fault;
  fault.kind = constant ? DataFaultKind::kStuck : DataFaultKind::kJump;
  fault.joint = joint;
  fault.signal = FaultySignal::kTorque;
  fault.size =
      constant ? static_cast<double>(rows) / static_cast<double>(log.sample_count()) : largest;
  set_spans(log, spans, fault);
  fault.words = fmt::format(
      "the torque of joint {} {}, and the joint is not accelerated by it: {}", joint + 1,
      constant ? "drops to 0 and is back at once" : "jumps and comes back", words_of_spans(fault));
  fault.mend = "look at the sensor, its cable and the channel that it is logged from";
  faults.push_back(std::move(fault));
}

bool overlaps_known(const std::vector<DataFault>& faults, Index joint, const RowSpan& rows) {
  return std::any_of(faults.begin(), faults.end(), [&](const DataFault& fault) {
    const bool same =
        fault.joint < 0 || (fault.joint == joint && fault.signal == FaultySignal::kTorque);
    return same && std::any_of(fault.spans.begin(), fault.spans.end(), [&](const FaultSpan& span) {
             return span.samples.first <= rows.last + 1 && span.samples.last + 1 >= rows.first;
           });
  });
}

}  // namespace

void find_torque_excursions(const Log& log, const Log& even, const RobotDescription& robot,
                            std::vector<DataFault>& faults) {
  constexpr double kTravel = 0.002;  // of the joint's range
  constexpr double kFelt = 0.4;
  std::optional<Response> response;
  const std::vector<std::vector<Index>> edges_of_all =
      of_every_joint(log, [&](Index joint) { return edges_of(log.tau.col(joint)); });
  for (Index joint = 0; joint < log.tau.cols(); ++joint) {
    const VectorXd tau = log.tau.col(joint);
    const auto q = log.q.col(joint);
    const double range = q.maxCoeff() - q.minCoeff();
    const std::vector<Index>& edges = edges_of_all[static_cast<std::size_t>(joint)];
    std::vector<Excursion> found;
    for (std::size_t k = 0; k + 1 < edges.size(); ++k) {
      const auto one = excursion_between(tau, edges[k], edges[k + 1], log.period_s);
      if (!one || overlaps_known(faults, joint, one->rows)) continue;
      const RowSpan& rows = one->rows;
      const auto during = q.segment(rows.first, rows.count());
      const double travel = during.maxCoeff() - during.minCoeff();
      if (one->constant && !(travel > kTravel * range)) continue;
      if (!response) response.emplace(even, robot);
      const VectorXd pulse = pulse_on(even, *response, log, pulse_of(tau, rows), rows);
      const double felt = response->share_of(pulse, log.t_s[rows.first], log.t_s[rows.last], joint);
      if (!(std::abs(felt) < kFelt)) continue;
      found.push_back(*one);
      ++k;
    }
    for (const bool constant : {true, false}) add_fault(log, joint, found, constant, faults);
  }
}

}  // namespace offnominal::desk
