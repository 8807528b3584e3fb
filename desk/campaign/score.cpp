#include "campaign/score.hpp"

#include <algorithm>
#include <limits>

namespace offnominal::desk::campaign {
namespace {

using Eigen::Index;

constexpr double kLookAheadS = 0.02;

}  // namespace

Result row_of(const Campaign& campaign, const Run& run, const std::string& detector) {
  Result result;
  result.run = run.number;
  result.detector = detector;
  result.seed = campaign.seed;
  if (run.fault == nullptr) return result;
  const FaultKindInfo& info = info_of(run.fault->kind);
  result.kind = info.name;
  result.fault_s = campaign.runs.fault_s;
  if (run.fault->kind != FaultKind::kPayload) result.joint = run.fault->joint + 1;
  if (*info.unit != '\0') result.size = run.fault->size;
  return result;
}

Result score_of(const Campaign& campaign, const Run& run, const RecordedRun& recorded,
                const std::string& detector, const Judged& judged) {
  Result result = row_of(campaign, run, detector);
  result.tracking_before_rad = recorded.tracking_before_rad;
  result.tracking_after_rad = recorded.tracking_after_rad;
  result.tracking_end_rad = recorded.tracking_end_rad;
  result.ran_away_s = recorded.ran_away_s;
  result.moves_after_s = recorded.moves_after_s;
  result.judged_s = static_cast<double>(judged.t_s.size()) * campaign.plant.period_s;
  double before_until_s = std::numeric_limits<double>::infinity();
  if (run.fault != nullptr) {
    const bool ahead = campaign.plant.velocity == VelocityKind::kDerived;
    before_until_s = campaign.runs.fault_s - (ahead ? kLookAheadS : 1e-9);
  }
  bool above = false;
  std::optional<double> first_s;
  for (Index row = 0; row < judged.t_s.size(); ++row) {
    Index joint = 0;
    const double ratio = judged.ratio.row(row).maxCoeff(&joint);
    double& peak = judged.t_s[row] < before_until_s ? result.peak_before : result.peak_after;
    peak = std::max(peak, ratio);
    const bool now = ratio > 1;
    if (now && !above) ++result.alarms;
    above = now;
    if (!now || first_s) continue;
    first_s = judged.t_s[row];
    if (judged.ratio.cols() == campaign.truth.joint_count() && judged.ratio.cols() > 1) {
      result.first_joint = static_cast<int>(joint) + 1;
    }
  }
  if (run.fault == nullptr) return result;
  result.early = result.peak_before > 1;
  result.detected = first_s.has_value() && !result.early;
  if (!result.detected) return result;
  result.named = judged.named;
  result.delay_s = std::max(*first_s - campaign.runs.fault_s, 0.0);
  if (info_of(run.fault->kind).of_joint && result.first_joint) {
    result.joint_right = *result.first_joint == run.fault->joint + 1;
  }
  return result;
}

}  // namespace offnominal::desk::campaign
