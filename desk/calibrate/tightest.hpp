#pragma once

#include <Eigen/Core>
#include <vector>

namespace offnominal::desk {

/// Rows of one part of the data: the threshold rows * c has to reach `error` in every row.
struct ThresholdRows {
  Eigen::Ref<const Eigen::MatrixXd> rows;
  Eigen::Ref<const Eigen::VectorXd> error;
  bool counts = true;  // whether its mean is part of what is made small
};

/// The c >= lowest with rows * c >= error in every row of every part and the least mean of rows * c
/// over the parts that count, each column's share in it times its `price`: a linear programme, of
/// which only the rows that matter are ever handed to the solver. Every row of the result holds but
/// for rounding. All entries are >= 0, and some row counts. Throws InputError when the solver finds
/// none (a row without a basis function that could reach its error).
[[nodiscard]] Eigen::VectorXd tightest(const std::vector<ThresholdRows>& parts,
                                       const Eigen::VectorXd& lowest, const Eigen::VectorXd& price);

}  // namespace offnominal::desk
