#include "compare/filter_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/error.hpp"
#include "compare/motion.hpp"
#include "signal/decimate.hpp"
#include "signal/zero_phase.hpp"

namespace offnominal::desk {

using Eigen::Index;
using Eigen::VectorXd;

namespace {

constexpr double kPositionPerTorque = 2.5;  // of the cut-offs
constexpr double kSamplesPerCutoff = 2.5;   // that are left per second and hertz
constexpr double kMostOfRate = 0.45;        // that a cut-off may be

// Up to which frequency an encoder's step, uniformly distributed, twice differentiated and
// low-passed, makes an acceleration error of at most this share of the motion's own.
double highest_cutoff_hz(const Log& log, Index joint, double counts_per_unit, double lowest_hz) {
  constexpr double kShare = 0.02;
  FilterPlan coarse;
  coarse.sample_rate_hz = log.sample_rate_hz();
  coarse.position_cutoff_hz = std::min(lowest_hz, kMostOfRate * coarse.sample_rate_hz);
  const VectorXd ddq = motion_of_joint(log, coarse, joint).ddq;
  const double moves = std::sqrt(ddq.squaredNorm() / static_cast<double>(ddq.size()));
  const double noise = 1 / counts_per_unit / std::sqrt(12.0);
  // Power of white noise over f, differentiated twice: (2 pi)^4 f^5 / 5 per rate / 2.
  const double f5 = 5 * coarse.sample_rate_hz / 2 * std::pow(kShare * moves / noise, 2) /
                    std::pow(2 * std::numbers::pi, 4);
  return std::pow(f5, 0.2);
}

struct Cutoff {
  double hz;
  CutoffReason reason;

  void lower_to(double other_hz, const CutoffReason& other) {
    if (other_hz < hz) *this = {other_hz, other};
  }
};

Cutoff usual_cutoff(const std::vector<Log>& logs, const RobotDescription& robot) {
  constexpr double kHighestHz = 12;
  constexpr double kLowestHz = 8;
  constexpr double kOfRate = 0.2;
  Cutoff cutoff{kHighestHz, {CutoffReason::Kind::kDefault}};
  for (const Log& log : logs) {
    cutoff.lower_to(kOfRate * log.sample_rate_hz(), {CutoffReason::Kind::kRate});
    const Index joints = std::min<Index>(log.q.cols(), robot.joint_count());
    for (Index joint = 0; joint < joints; ++joint) {
      const double counts = robot.joints[static_cast<std::size_t>(joint)].encoder.counts_per_unit;
      if (!(counts > 0)) continue;
      const double highest = highest_cutoff_hz(log, joint, counts, kLowestHz);
      if (highest > 0)
        cutoff.lower_to(std::max(highest, kLowestHz), {CutoffReason::Kind::kEncoder, joint});
    }
  }
  return cutoff;
}

void set_edges(FilterPlan& plan) {
  plan.edge_samples =
      static_cast<Index>(std::ceil(2 * plan.sample_rate_hz / plan.torque_cutoff_hz));
}

// Any number of them, before it is an index.
void check_length(const Log& log, const FilterPlan& plan) {
  const double edge_samples = std::ceil(2 * plan.sample_rate_hz / plan.torque_cutoff_hz);
  constexpr auto kFewest = static_cast<double>(kMinFilteredSamples);
  const auto samples = static_cast<double>(log.sample_count());
  const auto decimation = static_cast<double>(plan.decimation);
  if (samples - 2 * edge_samples >= kFewest * decimation) return;
  const double asked = 2 * edge_samples + (kFewest + 1) * decimation;
  const bool by_cutoff = 2 * edge_samples >= kFewest * decimation;
  throw InputError(
      {log.file, "",
       fmt::format("{:.4g} s at {:g} Hz", log.period_s * samples, plan.sample_rate_hz),
       fmt::format("a recording of {:.4g} s or more, with this filter", asked * log.period_s),
       by_cutoff ? "record for longer, or choose a larger --cutoff"
                 : "record for longer; on the command line a smaller --decimate may do"});
}

// Every so many-th sample of a rate leaves at least those that are to be kept.
Index decimation_of(double sample_rate_hz, double kept_rate_hz) {
  constexpr double kOfAClock = 1e-3;  // 499.9 Hz are 500 Hz
  return std::max<Index>(
      1, static_cast<Index>(std::floor(sample_rate_hz / kept_rate_hz * (1 + kOfAClock))));
}

// Whether any of the recordings has more samples than those that are to be kept.
bool any_is_decimated(const std::vector<Log>& logs, double kept_rate_hz) {
  return std::any_of(logs.begin(), logs.end(), [&](const Log& log) {
    return decimation_of(sample_rate_of(log), kept_rate_hz) > 1;
  });
}

// As the user has it: a cut-off for the position, and every so many-th sample.
FilterPlan requested(const std::vector<Log>& logs, const FilterRequest& request,
                     const FilterPlan& usual) {
  constexpr double kUsualRateHz = 100;
  const Log& log = logs.front();
  FilterPlan plan;
  plan.sample_rate_hz = usual.sample_rate_hz;
  const double half_rate_hz = plan.sample_rate_hz / 2;
  plan.position_cutoff_hz = request.cutoff_hz.value_or(usual.position_cutoff_hz);
  plan.common_position_cutoff_hz = request.cutoff_hz.value_or(usual.common_position_cutoff_hz);
  if (!(plan.position_cutoff_hz > 0) || !(plan.position_cutoff_hz < half_rate_hz)) {
    throw InputError({"--cutoff", "", fmt::format("{:g} Hz", plan.position_cutoff_hz),
                      fmt::format("more than 0 and less than {:g} Hz, half the sampling rate of {}",
                                  half_rate_hz, log.file),
                      ""});
  }
  if (request.decimate && *request.decimate < 1) {
    throw InputError({"--decimate", "", std::to_string(*request.decimate), "a number from 1", ""});
  }
  plan.kept_rate_hz = request.decimate ? plan.sample_rate_hz / *request.decimate : kUsualRateHz;
  plan.decimation = decimation_of(plan.sample_rate_hz, plan.kept_rate_hz);
  Cutoff cutoff{usual.torque_cutoff_hz, usual.reason};
  if (request.cutoff_hz) cutoff = {plan.position_cutoff_hz, {CutoffReason::Kind::kCutoff}};
  if (any_is_decimated(logs, plan.kept_rate_hz)) {
    cutoff.lower_to(kDecimationBand * plan.kept_rate_hz / 2,
                    {request.decimate ? CutoffReason::Kind::kDecimate : CutoffReason::Kind::kRate});
  }
  plan.torque_cutoff_hz = cutoff.hz;
  plan.reason = cutoff.reason;
  return plan;
}

}  // namespace

double sample_rate_of(const Log& log) {
  constexpr double kBlocks = 300;
  constexpr double kFewestReadings = 5;
  if (!log.at_rest) return log.sample_rate_hz();
  const auto readings = static_cast<double>(log.sample_count());
  return std::max(kFewestReadings, readings / kBlocks) / kShortestBlockS;
}

FilterPlan plan_filter(const std::vector<Log>& logs, const RobotDescription& robot,
                       const FilterRequest& request) {
  const Log& first = logs.front();
  FilterPlan plan;
  plan.sample_rate_hz = sample_rate_of(first);
  if (first.at_rest) {
    plan.position_cutoff_hz = std::numeric_limits<double>::infinity();
    plan.torque_cutoff_hz = std::numeric_limits<double>::infinity();
    plan.reason = {CutoffReason::Kind::kAtRest};
    return plan;
  }
  const Cutoff cutoff = usual_cutoff(logs, robot);
  plan.torque_cutoff_hz = cutoff.hz;
  plan.reason = cutoff.reason;
  plan.common_position_cutoff_hz = kPositionPerTorque * plan.torque_cutoff_hz;
  plan.position_cutoff_hz =
      std::min(plan.common_position_cutoff_hz, kMostOfRate * plan.sample_rate_hz);
  plan.kept_rate_hz = kSamplesPerCutoff * plan.torque_cutoff_hz;
  plan.decimation = decimation_of(plan.sample_rate_hz, plan.kept_rate_hz);
  if (request.cutoff_hz || request.decimate) plan = requested(logs, request, plan);
  check_length(first, plan);
  set_edges(plan);
  return plan;
}

FilterPlan plan_for(const Log& log, const FilterPlan& plan) {
  FilterPlan own = plan;
  own.sample_rate_hz = sample_rate_of(log);
  if (log.at_rest || own.sample_rate_hz == plan.sample_rate_hz) {
    if (!log.at_rest) check_length(log, own);
    return own;
  }
  own.position_cutoff_hz =
      std::min(plan.common_position_cutoff_hz, kMostOfRate * own.sample_rate_hz);
  if (own.position_cutoff_hz < plan.torque_cutoff_hz) {
    own.torque_cutoff_hz = own.position_cutoff_hz;
    own.reason = {CutoffReason::Kind::kRate};
  }
  own.decimation = decimation_of(own.sample_rate_hz, plan.kept_rate_hz);
  check_length(log, own);
  set_edges(own);
  return own;
}

VectorXd kept_samples(const FilterPlan& plan, const Eigen::Ref<const VectorXd>& signal) {
  const Index inner = signal.size() - 2 * plan.edge_samples;
  return every_nth(signal.segment(plan.edge_samples, inner), plan.decimation);
}

VectorXd filtered(const FilterPlan& plan, const Eigen::Ref<const VectorXd>& signal) {
  if (std::isinf(plan.torque_cutoff_hz)) return kept_samples(plan, signal);
  return kept_samples(plan,
                      zero_phase_low_pass(signal, plan.torque_cutoff_hz, plan.sample_rate_hz));
}

}  // namespace offnominal::desk
