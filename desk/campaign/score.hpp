#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "campaign/campaign.hpp"
#include "campaign/detector.hpp"
#include "campaign/simulate.hpp"

namespace offnominal::desk::campaign {

/// What became of one run under one detector: a row of the results.
struct Result {
  std::int64_t run = 0;
  std::string detector;
  std::uint64_t seed = 0;     // of the campaign: with the run's number it says all of the run
  std::string kind = "none";  // of the fault; "none": fault-free
  std::optional<int> joint;   // from 1; of a push the link
  std::optional<double> size;
  double judged_s = 0;              // of the recording, that the detector judged
  std::optional<double> fault_s;    // when the fault began
  bool detected = false;            // an alarm after the fault began, and none before
  std::optional<double> delay_s;    // from the fault to that alarm
  std::optional<int> first_joint;   // from 1, of the first alarm; none: it names none
  std::optional<bool> joint_right;  // it is the fault's; none: not detected, or there is none
  std::optional<Named> named;       // of a detection, by a detector that isolates
  bool early = false;               // an alarm before the fault
  std::int64_t alarms = 0;          // stretches above the threshold, of any joint
  // Largest |residual| / threshold before the fault (of a fault-free run: at all), and after. With
  // them a detector of thresholds c times as high is judged afterwards: early where peak_before
  // > c, else detected where peak_after > c.
  double peak_before = 0;
  double peak_after = 0;
  std::optional<double> tracking_before_rad;  // RecordedRun
  std::optional<double> tracking_after_rad;
  std::optional<double> tracking_end_rad;
  // The same with the detector in the loop, infinite where the motion runs away then; none: it does
  // not accommodate.
  std::optional<double> tracking_end_accommodated_rad;
  std::optional<double> ran_away_s;
  std::optional<double> moves_after_s;  // RecordedRun

  friend bool operator==(const Result&, const Result&) = default;
};

/// What follows of a row from the campaign alone.
[[nodiscard]] Result row_of(const Campaign& campaign, const Run& run, const std::string& detector);

/// Judges one run. Velocities derived without phase see the fault ahead, by a few periods of their
/// 100 Hz filter: there an alarm up to 20 ms before it is one of the fault, with a delay of 0.
[[nodiscard]] Result score_of(const Campaign& campaign, const Run& run, const RecordedRun& recorded,
                              const std::string& detector, const Judged& judged);

}  // namespace offnominal::desk::campaign
