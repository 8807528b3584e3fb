#include "signal/decimate.hpp"

#include <stdexcept>

#include "signal/zero_phase.hpp"

namespace offnominal::desk {

Eigen::VectorXd every_nth(const Eigen::Ref<const Eigen::VectorXd>& signal, Eigen::Index factor) {
  if (factor < 1) throw std::invalid_argument("the decimation factor is a number from 1");
  if (signal.size() == 0) return signal;
  return signal(Eigen::seq(0, signal.size() - 1, factor));
}

Eigen::MatrixXd every_nth_row(const Eigen::Ref<const Eigen::MatrixXd>& signals,
                              Eigen::Index factor) {
  if (factor < 1) throw std::invalid_argument("the decimation factor is a number from 1");
  if (signals.rows() == 0) return signals;
  return signals(Eigen::seq(0, signals.rows() - 1, factor), Eigen::all);
}

Eigen::VectorXd decimate(const Eigen::Ref<const Eigen::VectorXd>& signal, Eigen::Index factor) {
  if (factor < 1) throw std::invalid_argument("the decimation factor is a number from 1");
  if (factor == 1) return signal;
  const double band_per_sample = kDecimationBand / (2 * static_cast<double>(factor));
  return every_nth(zero_phase_low_pass(signal, band_per_sample, 1.0), factor);
}

}  // namespace offnominal::desk
