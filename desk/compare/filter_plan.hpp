#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "log/log.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk {

// What the user asked for; whatever is not set follows from encoders, motion and sampling rate.
struct FilterRequest {
  std::optional<double> cutoff_hz;
  std::optional<int> decimate;
};

// What a cut-off follows from.
struct CutoffReason {
  enum class Kind : std::uint8_t {
    kDefault,   // above it moves no arm
    kRate,      // the sampling rate
    kEncoder,   // what the encoder of `joint` leaves of the acceleration
    kCutoff,    // --cutoff
    kDecimate,  // --decimate: what so few samples can hold
    kAtRest,    // readings at rest: there is none
  };
  Kind kind = Kind::kDefault;
  Eigen::Index joint = 0;  // from 0
};

// How a recording is filtered before model and measurement are compared, by every verb alike. The
// position passes a low-pass at position_cutoff_hz before it is differentiated. Torque, model
// torque and every regressor column pass one and the same low-pass at torque_cutoff_hz; then
// edge_samples are cut at both ends and every decimation-th sample is kept. Both filters are
// 4th-order Butterworth, forward and backward (M. Gautier, ICRA 1997). An infinite cut-off is no
// low-pass: readings at rest.
struct FilterPlan {
  double sample_rate_hz = 0;
  double position_cutoff_hz = 0;
  double torque_cutoff_hz = 0;  // at most the cut-off, and kDecimationBand of what decimation keeps
  CutoffReason reason = {};     // of torque_cutoff_hz
  // What all recordings that are analysed together have alike; position_cutoff_hz and decimation
  // are what a recording's own rate makes of them.
  double common_position_cutoff_hz = 0;
  double kept_rate_hz = 0;  // at least so many samples per second are kept
  Eigen::Index decimation = 1;
  Eigen::Index edge_samples = 0;

  [[nodiscard]] double period_s() const { return static_cast<double>(decimation) / sample_rate_hz; }
};

// The filter of recordings that are analysed together, at the rate of the first; that of any other
// does not depend on which is the first, unless --decimate counts samples of it. Torque cut-off
// unless asked for: 8 to 12 Hz, by what the coarsest encoder leaves of the acceleration (what moves
// an arm is slower), at most a fifth of the sampling rate; the position's is 2.5 times that. A
// cut-off that is asked for is the position's, and the torque's as far as the decimation lets it
// be. Hold maps have none. Throws InputError when the request does not fit a sampling rate, or when
// a recording leaves fewer than kMinFilteredSamples.
FilterPlan plan_filter(const std::vector<Log>& logs, const RobotDescription& robot,
                       const FilterRequest& request = {});

// The same filter for a recording that has its own sampling rate. Throws InputError as
// plan_filter().
FilterPlan plan_for(const Log& log, const FilterPlan& plan);

// Samples per second of a recording as blocks of time count them. Readings at rest have no time: so
// many a "second" that a recording has about 300 of the shortest blocks, of 5 readings or more.
double sample_rate_of(const Log& log);

// Blocks of time that errors are taken as independent between are at least this long.
inline constexpr double kShortestBlockS = 0.3;

inline constexpr int kMinFilteredSamples = 20;

// Low-passed, without its edges, decimated.
Eigen::VectorXd filtered(const FilterPlan& plan, const Eigen::Ref<const Eigen::VectorXd>& signal);

// The same samples of the signal as it is.
Eigen::VectorXd kept_samples(const FilterPlan& plan,
                             const Eigen::Ref<const Eigen::VectorXd>& signal);

}  // namespace offnominal::desk
