#pragma once

#include <Eigen/Core>
#include <vector>

#include "identify/rows.hpp"

namespace offnominal::desk {

// A regression of any number of rows as upper triangles, one per joint and held-out part: whatever
// weights the joints get and whatever part is left out, a fit needs no row again.
class ReducedRows {
 public:
  // `columns`, `target`: stacked, not weighted; `parts`: of each row, from 0 to part_count - 1.
  ReducedRows(const Eigen::MatrixXd& columns, const Eigen::VectorXd& target,
              const RowLayout& layout, const std::vector<int>& parts, int part_count);

  // |columns x - target|^2 of the weighted rows is that of this, plus what no x can take away.
  struct Equations {
    Eigen::MatrixXd columns;
    Eigen::VectorXd target;
  };
  static constexpr int kNone = -1;
  // `without`: a part that is left out.
  [[nodiscard]] Equations weighted(const Eigen::VectorXd& joint_weights, int without = kNone) const;
  // Root mean square of the residual, per joint, of one part or of all; 0 of a joint without rows.
  [[nodiscard]] Eigen::VectorXd rms(const Eigen::VectorXd& x, int part = kNone) const;
  // Sum of squares of the residual, per joint.
  [[nodiscard]] Eigen::VectorXd energy(const Eigen::VectorXd& x, int part = kNone) const;
  // Parts that have rows of their own.
  [[nodiscard]] std::vector<int> parts() const;

 private:
  struct Piece {
    Eigen::MatrixXd upper;  // the target is the last column
    double rows = 0;
  };
  [[nodiscard]] const Piece& piece(Eigen::Index joint, int part) const {
    return pieces_[static_cast<std::size_t>(joint) * static_cast<std::size_t>(part_count_) +
                   static_cast<std::size_t>(part)];
  }

  Eigen::Index joints_;
  int part_count_;
  std::vector<Piece> pieces_;
};

}  // namespace offnominal::desk
