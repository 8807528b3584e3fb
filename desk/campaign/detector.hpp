#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "campaign/campaign.hpp"
#include "log/log.hpp"

namespace offnominal::desk::campaign {

/// What a detector says of one recording.
struct Judged {
  Eigen::VectorXd t_s;    // of the samples that it judged
  Eigen::MatrixXd ratio;  // |residual| / threshold; columns: joints, or one where there is one
                          // threshold of all
};

/// A detector with its thresholds. const calls may come from several threads at once.
class Detector {
 public:
  virtual ~Detector() = default;
  [[nodiscard]] virtual Judged judge(const Log& log) const = 0;
  /// All numbers of its thresholds, as text with every digit.
  [[nodiscard]] virtual std::string thresholds() const = 0;
  /// What a reader of its results has to know of its calibration, one sentence each.
  [[nodiscard]] const std::vector<std::string>& notes() const { return notes_; }

 protected:
  std::vector<std::string> notes_;
};

/// Calibrated on fault-free recordings, of several all but the last, on which its alarms are
/// counted, to campaign.calibration.alarms_per_hour of all joints together. Throws InputError where
/// they are too short (desk/calibrate/calibrate.hpp).
[[nodiscard]] std::unique_ptr<Detector> calibrated(const DetectorSettings& settings,
                                                   const Campaign& campaign,
                                                   const std::vector<Log>& logs);

}  // namespace offnominal::desk::campaign
