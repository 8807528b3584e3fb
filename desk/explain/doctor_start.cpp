#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "explain/doctor_checks.hpp"
#include "explain/doctor_signal.hpp"
#include "explain/expected_torque.hpp"
#include "signal/quantile.hpp"

// A torque that comes up from nothing while the model asks for it from the first row on: the drive
// was just switched on, or its filter has just begun. Where the torque jumps later as much as that,
// by noise or by friction, only the model tells.

namespace offnominal::desk {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr Index kPart = 5;  // of the recording, that may be start

// Whether anything is known of the first rows that spoils what the model says of them, or that says
// already what the torque of the joint does there.
bool is_known_at_start(const std::vector<DataFault>& faults, Index joint) {
  return std::any_of(faults.begin(), faults.end(), [joint](const DataFault& fault) {
    const bool position = fault.signal == FaultySignal::kPosition;
    return (fault.joint < 0 || fault.joint == joint || position) &&
           std::any_of(fault.spans.begin(), fault.spans.end(),
                       [](const FaultSpan& span) { return span.samples.first <= 1; });
  });
}

// Rows until the torque is what the model says as nearly as it is later; 0: there is no start.
Index unsettled_rows(const Log& log, Index joint, const ExpectedTorque& model) {
  constexpr double kLongestS = 0.5;
  constexpr double kUsual = 0.995;
  constexpr double kUnlikeLater = 2;
  constexpr double kNothing = 0.1;        // of the torque that it settles at
  constexpr double kModelsOwn = 1.0 / 3;  // of the torque's rise
  const VectorXd tau = log.tau.col(joint);
  const Index rows = tau.size();
  VectorXd off = model.torque_beyond(log, joint);
  const VectorXd later = off.tail(rows - rows / kPart);
  const double usual = quantile(later, 0.5);
  off = (off.array() - usual).abs();
  const double most = quantile((later.array() - usual).abs(), kUsual);
  if (!(off[0] > kUnlikeLater * most)) return 0;
  Index settled = 0;
  while (settled < rows / kPart && off[settled] > most) ++settled;
  if (settled == rows / kPart || log.t_s[settled] - log.t_s[0] > kLongestS) return 0;
  const double rise = std::abs(tau[settled] - tau[0]);
  const double until_s = log.t_s[std::min(2 * settled, rows - 1)];
  const bool from_nothing = std::abs(tau[0]) <= kNothing * std::abs(tau[settled]);
  // At the ends of a recording the model's acceleration is least certain.
  const bool its_own = model.change_during(log.t_s[0], until_s, joint) <= kModelsOwn * rise;
  return from_nothing && its_own ? std::min(settled + settled / 2 + 1, rows / kPart) : 0;
}

}  // namespace

void find_unsettled_torques(const Log& log, const ExpectedTorque& model,
                            std::vector<DataFault>& faults) {
  constexpr Index kFewestRows = 100;
  if (log.sample_count() < kFewestRows) return;
  for (Index joint = 0; joint < log.tau.cols(); ++joint) {
    const double most = log.tau.col(joint).cwiseAbs().maxCoeff();
    constexpr double kSmall = 0.1;
    if (!(std::abs(log.tau(0, joint)) < kSmall * most) || is_known_at_start(faults, joint))
      continue;
    const Index unsettled = unsettled_rows(log, joint, model);
    if (unsettled == 0) continue;
    DataFault fault;
    fault.kind = DataFaultKind::kStart;
    fault.joint = joint;
    fault.signal = FaultySignal::kTorque;
    fault.size = static_cast<double>(unsettled) / static_cast<double>(log.sample_count());
    set_spans(log, {{0, unsettled - 1}}, fault);
    fault.words = fmt::format(
        "the torque of joint {} comes up from {:.3g} at the start, where the model asks for "
        "{:.3g}: {}",
        joint + 1, log.tau(0, joint) + 0.0, model.at(log.t_s[0], joint), words_of_spans(fault));
    fault.mend = mend_of_start();
    faults.push_back(std::move(fault));
  }
}

}  // namespace offnominal::desk
