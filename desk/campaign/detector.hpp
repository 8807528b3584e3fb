#pragma once

#include <Eigen/Core>
#include <memory>
#include <offnominal/diagnosis/fault_kind.hpp>
#include <optional>
#include <string>
#include <vector>

#include "campaign/accommodation.hpp"
#include "campaign/campaign.hpp"
#include "log/log.hpp"

namespace offnominal::desk::campaign {

/// What a detector says of the fault behind its first alarm: fields as of the core's
/// FaultDiagnosis.
struct Named {
  offnominal::FaultKind kind = offnominal::FaultKind::kUnknown;
  int joint = -1;      // from 0; of kUnknown -1
  double size = 0;     // 0 where the kind has none
  double after_s = 0;  // from the alarm to the answer

  friend bool operator==(const Named&, const Named&) = default;
};

/// What a detector says of one recording.
struct Judged {
  Eigen::VectorXd t_s;    // of the samples that it judged
  Eigen::MatrixXd ratio;  // |residual| / threshold; columns: joints, or one where there is one
                          // threshold of all
  std::optional<Named> named = {};  // of one that isolates
};

/// A detector with its thresholds. const calls may come from several threads at once.
class Detector {
 public:
  virtual ~Detector() = default;
  [[nodiscard]] virtual Judged judge(const Log& log) const = 0;
  /// Itself in the loop of a run; null: it does not accommodate.
  [[nodiscard]] virtual std::unique_ptr<Accommodation> accommodation() const { return nullptr; }
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
