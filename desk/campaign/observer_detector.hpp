#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <vector>

#include "campaign/detector.hpp"

namespace offnominal::desk::campaign {

/// Rows: samples, columns: joints, N m. Has to be callable from several threads at once.
using ResidualOf = std::function<Eigen::MatrixXd(const Log& log)>;

/// A constant threshold for each joint's residual, as residual-based monitors usually have: the
/// value that the largest |residual| of a block of time exceeds at the joint's even share of the
/// rate, by the extreme-value law that desk/calibrate fits (false_alarms.hpp), and never less than
/// the largest that was seen.
[[nodiscard]] std::unique_ptr<Detector> calibrated_observer(const ResidualOf& residual_of,
                                                            double alpha_per_s,
                                                            double alarms_per_hour,
                                                            const std::vector<Log>& logs);

}  // namespace offnominal::desk::campaign
