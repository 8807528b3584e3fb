#include "campaign/observer_detector.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "calibrate/false_alarms.hpp"
#include "common/amount.hpp"
#include "common/error.hpp"
#include "common/number.hpp"

namespace offnominal::desk::campaign {
namespace {

using Eigen::Index;

class ObserverDetector final : public Detector {
 public:
  ObserverDetector(ResidualOf residual_of, Eigen::RowVectorXd thresholds_nm,
                   std::vector<std::string> notes)
      : residual_of_(std::move(residual_of)), thresholds_nm_(std::move(thresholds_nm)) {
    notes_ = std::move(notes);
  }

  [[nodiscard]] Judged judge(const Log& log) const override {
    Eigen::MatrixXd ratio = residual_of_(log).cwiseAbs();
    ratio.array().rowwise() /= thresholds_nm_.array();
    return {log.t_s, std::move(ratio)};
  }

  [[nodiscard]] std::string thresholds() const override {
    std::string text = "constant thresholds, N m:";
    for (const double one : thresholds_nm_) text += " " + shortest(one);
    return text;
  }

 private:
  ResidualOf residual_of_;
  Eigen::RowVectorXd thresholds_nm_;
};

double threshold_of(const std::vector<Eigen::MatrixXd>& residuals, Index joint, Index block,
                    double probability, const std::string& file) {
  std::vector<double> maxima;
  double largest = 0;
  for (const Eigen::MatrixXd& residual : residuals) {
    const Eigen::VectorXd size = residual.col(joint).cwiseAbs();
    largest = std::max(largest, size.maxCoeff());
    const std::vector<double> of_one = block_maxima(size, block);
    maxima.insert(maxima.end(), of_one.begin(), of_one.end());
  }
  if (maxima.size() < static_cast<std::size_t>(kFewestBlocks)) {
    throw InputError({.file = file,
                      .place = "length of the recordings",
                      .found = counted(maxima.size(), "whole block"),
                      .allowed = fmt::format("at least {}", kFewestBlocks),
                      .mend = "raise [calibration] runs or duration_s"});
  }
  return std::max(largest, exceeded_with(extreme_law_of(std::move(maxima)), probability));
}

// Samples at which some joint crosses its threshold.
std::int64_t alarms_in(const Eigen::MatrixXd& ratio) {
  std::int64_t alarms = 0;
  bool above = false;
  for (Index row = 0; row < ratio.rows(); ++row) {
    const bool now = ratio.row(row).maxCoeff() > 1;
    alarms += now && !above ? 1 : 0;
    above = now;
  }
  return alarms;
}

}  // namespace

std::unique_ptr<Detector> calibrated_observer(const ResidualOf& residual_of, double alpha_per_s,
                                              double alarms_per_hour,
                                              const std::vector<Log>& logs) {
  const std::size_t used = std::max<std::size_t>(logs.size() - 1, 1);
  std::vector<Eigen::MatrixXd> residuals;
  for (std::size_t i = 0; i < used; ++i) residuals.push_back(residual_of(logs[i]));
  const Index joints = logs.front().joint_count();
  // As desk/calibrate takes them: the filter has forgotten the block before.
  const double block_s = std::max(1.0, 10 / alpha_per_s);
  const auto block = static_cast<Index>(std::llround(block_s / logs.front().period_s));
  const double probability = alarms_per_hour / static_cast<double>(joints) / 3600 * block_s;
  Eigen::RowVectorXd thresholds_nm(joints);
  for (Index j = 0; j < joints; ++j) {
    thresholds_nm[j] = threshold_of(residuals, j, block, probability, logs.front().file);
  }
  std::vector<std::string> notes;
  auto detector = std::make_unique<ObserverDetector>(residual_of, thresholds_nm, notes);
  if (used == logs.size()) return detector;
  const std::int64_t alarms = alarms_in(detector->judge(logs.back()).ratio);
  if (alarms == 0) return detector;
  notes.push_back(fmt::format("{} in the calibration run that was held out",
                              counted(static_cast<std::size_t>(alarms), "alarm")));
  return std::make_unique<ObserverDetector>(residual_of, thresholds_nm, std::move(notes));
}

}  // namespace offnominal::desk::campaign
