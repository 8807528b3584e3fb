#include "analysis/filter_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/error.hpp"
#include "signal/decimate.hpp"
#include "signal/zero_phase.hpp"

namespace offnominal::tools {

using Eigen::Index;
using Eigen::VectorXd;

FilterPlan plan_filter(const Log& log, const FilterRequest& request) {
  constexpr double kUsualCutoffHz = 100;
  constexpr double kUsualRateHz = 100;
  FilterPlan plan;
  plan.sample_rate_hz = log.sample_rate_hz();
  const double half_rate_hz = plan.sample_rate_hz / 2;
  plan.position_cutoff_hz = request.cutoff_hz.value_or(std::min(kUsualCutoffHz, half_rate_hz / 2));
  if (!(plan.position_cutoff_hz > 0) || !(plan.position_cutoff_hz < half_rate_hz)) {
    throw InputError({"--cutoff", "", fmt::format("{:g} Hz", plan.position_cutoff_hz),
                      fmt::format("more than 0 and less than {:g} Hz, half the sampling rate of {}",
                                  half_rate_hz, log.file),
                      ""});
  }
  const int usual = std::max(1, static_cast<int>(std::lround(plan.sample_rate_hz / kUsualRateHz)));
  plan.decimation = request.decimate.value_or(usual);
  if (plan.decimation < 1) {
    throw InputError({"--decimate", "", std::to_string(plan.decimation), "a number from 1", ""});
  }
  plan.torque_cutoff_hz = plan.position_cutoff_hz;
  if (plan.decimation > 1) {
    const double band_hz = kDecimationBand * half_rate_hz / static_cast<double>(plan.decimation);
    plan.torque_cutoff_hz = std::min(plan.position_cutoff_hz, band_hz);
  }
  // Any number of them, before it is an index.
  const double edge_samples = std::ceil(2 * plan.sample_rate_hz / plan.torque_cutoff_hz);
  constexpr auto kFewest = static_cast<double>(kMinFilteredSamples);
  const auto samples = static_cast<double>(log.sample_count());
  const auto decimation = static_cast<double>(plan.decimation);
  const double asked = 2 * edge_samples + (kFewest + 1) * decimation;
  if (samples - 2 * edge_samples < kFewest * decimation) {
    const bool by_cutoff = plan.torque_cutoff_hz >= plan.position_cutoff_hz;
    throw InputError(
        {log.file, "",
         fmt::format("{:.4g} s at {:g} Hz", log.period_s * samples, plan.sample_rate_hz),
         fmt::format("a recording of {:.4g} s or more, with this filter", asked * log.period_s),
         by_cutoff ? "record for longer, or choose a larger --cutoff"
                   : "record for longer, or choose a smaller --decimate"});
  }
  plan.edge_samples = static_cast<Index>(edge_samples);
  return plan;
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

}  // namespace offnominal::tools
