#pragma once

#include <Eigen/Core>

namespace offnominal::desk {

// Share of the new half sampling rate that a decimated signal keeps.
inline constexpr double kDecimationBand = 0.8;

// Every factor-th sample, the first included, of a signal that is already free of what would alias.
// Throws std::invalid_argument when factor < 1.
Eigen::VectorXd every_nth(const Eigen::Ref<const Eigen::VectorXd>& signal, Eigen::Index factor);

// The same for the rows of several signals, one per column.
Eigen::MatrixXd every_nth_row(const Eigen::Ref<const Eigen::MatrixXd>& signals,
                              Eigen::Index factor);

// Low-pass at kDecimationBand of the new half sampling rate, without phase, then every_nth().
// A factor of 1 returns the signal.
Eigen::VectorXd decimate(const Eigen::Ref<const Eigen::VectorXd>& signal, Eigen::Index factor);

}  // namespace offnominal::desk
