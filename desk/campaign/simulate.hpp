#pragma once

#include <cstdint>
#include <optional>

#include "campaign/accommodation.hpp"
#include "campaign/campaign.hpp"
#include "campaign/campaign_plant.hpp"
#include "log/log.hpp"

namespace offnominal::desk::campaign {

/// A run as it was recorded, and what the recording does not say.
struct RecordedRun {
  Log log;
  // Of all joints' distance to the motion they should make, rms, rad; none: there was no such time.
  std::optional<double> tracking_before_rad;
  std::optional<double> tracking_after_rad;
  // The same over the last quarter of the time behind the fault.
  std::optional<double> tracking_end_rad;
  // From the fault of one joint until that joint is to move, faster than a fiftieth of its fastest
  // before, s: what stands shows no friction, and not that it is stuck. None: it is not to, or the
  // fault is no joint's.
  std::optional<double> moves_after_s;
  sim::JointVector torque_noise_nm;  // standard deviation in the log
  // When the plant's motion ran away under the fault: the recording ends there, s.
  std::optional<double> ran_away_s;
};

/// The runs of a campaign. The controller is computed torque by the detectors' model, 30 rad/s
/// fast, with the measured positions and their observed velocities; each drive's torque limited as
/// the robot file says. Recorded are the torques that the drives are told, as they act at the
/// sample's time. Everything drawn follows from the campaign's seed and the number. May be used by
/// several threads at once.
class Simulator {
 public:
  /// As PlantMaker. The campaign has to outlive it.
  explicit Simulator(const Campaign& campaign);

  /// Throws InputError where the motion runs away without a fault.
  [[nodiscard]] RecordedRun run(const Run& run) const;
  /// The same run, sample for sample, until `loop` has its drives give something beside.
  [[nodiscard]] RecordedRun accommodated(const Run& run, const RecordedRun& without,
                                         Accommodation& loop) const;
  /// Fault-free; 0 <= number < calibration.runs.
  [[nodiscard]] Log calibration_run(int number) const;

 private:
  const Campaign& campaign_;
  PlantMaker plants_;
};

}  // namespace offnominal::desk::campaign
