#pragma once

#include <array>
#include <cstdint>
#include <offnominal/diagnosis/fault_kind.hpp>
#include <optional>
#include <string>
#include <vector>

#include "campaign/result_file.hpp"

// What results say, per detector and fault. All figures follow from the rows alone.

namespace offnominal::desk::campaign {

/// An estimate with its 95 % interval.
struct Estimate {
  double value = 0;
  double low = 0;
  double high = 0;
};

/// `hits` of `of`, of > 0: Clopper-Pearson, exact and two-sided (C. J. Clopper, E. S. Pearson, The
/// use of confidence or fiducial limits, Biometrika 26, 1934).
[[nodiscard]] Estimate share_of(std::int64_t hits, std::int64_t of);
/// `count` events in `hours` > 0, per hour: exact and two-sided (F. Garwood, Fiducial limits for
/// the Poisson distribution, Biometrika 28, 1936).
[[nodiscard]] Estimate rate_of(std::int64_t count, double hours);

/// One fault of one size in one place under one detector.
struct FaultLine {
  std::string kind;
  std::optional<int> joint;  // from 1
  std::optional<double> size;
  std::int64_t runs = 0;
  std::int64_t seen = 0;
  Estimate detected;               // share of the runs
  std::optional<double> median_s;  // time to detect of those seen: without interpolation
  std::optional<double> p95_s;
  std::optional<double> max_s;
  std::int64_t named = 0;        // of those seen, in which the detector named a joint at all
  std::int64_t joint_right = 0;  // ... and it was the fault's
  std::int64_t early = 0;        // alarms before the fault
  // Of those seen, what a detector that isolates said that it is.
  std::array<std::int64_t, offnominal::kFaultKinds> named_as{};  // per kind
  std::int64_t kind_right = 0;
  std::int64_t kind_and_joint_right = 0;  // of faults of one joint
  // Of those whose kind is right, where its size is the same quantity: how far the size told is
  // off, as a share, and the time from the alarm to the answer; without interpolation.
  std::optional<double> size_off_median;
  std::optional<double> size_off_p90;
  std::optional<double> answer_median_s;

  [[nodiscard]] std::int64_t answers() const;
};

/// The smallest size of a kind, in one place, that is seen in at least 95 % of its runs, as larger
/// ones are in theirs. Of few runs that is no probability: they are told beside.
struct SmallestSeen {
  std::string kind;
  std::optional<int> joint;
  std::optional<double> size;  // none: not even the largest was
  double largest = 0;          // size that was tried
  std::int64_t runs = 0;       // with that size, or the largest
  std::int64_t seen = 0;       // of them
};

/// Detector whose thresholds are `scale` times what they were calibrated to.
struct RocPoint {
  double scale = 1;
  double false_alarms_per_hour = 0;  // fault-free runs with an alarm, and early ones, per hour
  double detected = 0;  // share of the runs with a fault that alarm under it, early or not
};

// How often a planted fault was called each kind: a row of the confusion matrix.
struct Confusion {
  std::string kind;  // as the campaign's file has it
  std::int64_t seen = 0;
  std::array<std::int64_t, offnominal::kFaultKinds> named_as{};
  std::int64_t right = 0;
};

// Tracking at the end of the runs with one kind of fault, with the detector in the loop over
// without. Runs of which both are known.
struct Tracking {
  std::string kind;
  std::int64_t runs = 0;
  std::int64_t halved = 0;  // with it at most half as far off
  std::int64_t worse = 0;   // more than 2 % farther off
  double without_rad = 0;   // rms over the runs
  double with_rad = 0;
  double ratio_median = 1;  // with / without of a run
  double ratio_p95 = 1;
};

struct DetectorSummary {
  std::string name;
  std::string notes;
  std::vector<FaultLine> faults;     // as the campaign's file has them
  std::vector<Confusion> confusion;  // in the order of the file; empty: it does not isolate
  std::vector<Tracking> tracking;    // in the order of the file; empty: it does not accommodate
  double fault_free_s = 0;
  std::int64_t false_alarms = 0;                  // in them
  std::optional<Estimate> false_alarms_per_hour;  // none: there are no fault-free runs
  std::vector<SmallestSeen> smallest;
  std::vector<RocPoint> roc;  // by ascending scale; empty: no fault-free runs, or no fault
  double roc_hours = 0;       // without a fault, on which its false alarms were counted
  // With the lowest thresholds that would have had no false alarm in them: detectors compared at
  // the same count, whatever each was calibrated to. None: as roc.
  std::optional<RocPoint> without_false_alarm;
};

struct Summary {
  std::string campaign;
  std::int64_t runs = 0;  // of the campaign
  std::vector<std::int64_t> missing;
  std::vector<DetectorSummary> detectors;
};

[[nodiscard]] Summary summary_of(const Results& results);

/// "friction, joint 4", "payload", "push, link 4".
[[nodiscard]] std::string place_words(const std::string& kind, const std::optional<int>& joint);
/// "0.5 kg"; empty where the kind has no size.
[[nodiscard]] std::string size_words(const std::string& kind, const std::optional<double>& size);

}  // namespace offnominal::desk::campaign
