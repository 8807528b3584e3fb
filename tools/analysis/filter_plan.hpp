#pragma once

#include <Eigen/Core>
#include <optional>

#include "log/log.hpp"

namespace offnominal::tools {

// What the user asked for; whatever is not set follows from the sampling rate.
struct FilterRequest {
  std::optional<double> cutoff_hz;
  std::optional<int> decimate;
};

// How a recording is filtered before model and measurement are compared. The position passes a
// low-pass at position_cutoff_hz before it is differentiated. Torque, model torque and every
// regressor column pass one and the same low-pass at torque_cutoff_hz; then edge_samples are cut at
// both ends and every decimation-th sample is kept. Both filters are 4th-order Butterworth, forward
// and backward (M. Gautier, ICRA 1997). An infinite cut-off is no low-pass: readings at rest.
struct FilterPlan {
  double sample_rate_hz = 0;
  double position_cutoff_hz = 0;
  double torque_cutoff_hz = 0;  // at most the cut-off, and kDecimationBand of what decimation keeps
  Eigen::Index decimation = 1;
  Eigen::Index edge_samples = 0;

  [[nodiscard]] double period_s() const { return static_cast<double>(decimation) / sample_rate_hz; }
};

// Cut-off unless asked for: 100 Hz, or a quarter of a sampling rate below 400 Hz. Decimation unless
// asked for: to about 100 samples a second. Throws InputError when the request does not fit the
// recording's sampling rate, or when fewer than kMinFilteredSamples would be left.
FilterPlan plan_filter(const Log& log, const FilterRequest& request);

inline constexpr int kMinFilteredSamples = 20;

// Low-passed, without its edges, decimated.
Eigen::VectorXd filtered(const FilterPlan& plan, const Eigen::Ref<const Eigen::VectorXd>& signal);

// The same samples of the signal as it is.
Eigen::VectorXd kept_samples(const FilterPlan& plan,
                             const Eigen::Ref<const Eigen::VectorXd>& signal);

}  // namespace offnominal::tools
