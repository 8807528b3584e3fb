#pragma once

#include <Eigen/Core>
#include <vector>

#include "identify/rows.hpp"

namespace offnominal::desk {

// Rows of a regression: target = columns * x + error.
struct RegressionRows {
  Eigen::MatrixXd columns;
  Eigen::VectorXd target;
};

// The same rows turned so that no more are left than there are columns, the target's among them: a
// QR decomposition in pieces that stay in the cache, each on top of what the ones before it left
// (J. Demmel, L. Grigori, M. Hoemmen, J. Langou, SIAM J. Sci. Comput. 34(1), 2012). As they are
// where they are few. Least squares of these are those of the others.
RegressionRows few_rows(const Eigen::MatrixXd& columns, const Eigen::VectorXd& target);

// The same joint by joint, so that any weight per joint can follow, of the columns that act on it.
class FewRowsOfJoints {
 public:
  // `rows`: 0 for a row that is left out, as those are where a joint stands still; empty for all.
  FewRowsOfJoints(const RowLayout& layout, const Eigen::MatrixXd& columns,
                  const Eigen::VectorXd& target, const std::vector<char>& rows);

  // Those of all joints, each times its joint's weight.
  [[nodiscard]] RegressionRows weighted(const Eigen::VectorXd& joint_weights) const;

 private:
  Eigen::Index count_;  // columns
  struct OfJoint {
    std::vector<Eigen::Index> acting;  // its columns
    RegressionRows rows;
  };
  std::vector<OfJoint> joints_;
};

}  // namespace offnominal::desk
