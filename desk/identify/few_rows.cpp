#include "identify/few_rows.hpp"

#include <Eigen/QR>
#include <algorithm>

namespace offnominal::desk {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

RegressionRows few_rows(const MatrixXd& columns, const VectorXd& target) {
  constexpr Index kPiece = 512;
  const Index count = columns.cols();
  if (columns.rows() < kPiece || columns.rows() < 4 * count) return {columns, target};
  const Index wide = count + 1;  // the target is the last column
  MatrixXd upper(0, wide);
  for (Index row = 0; row < columns.rows(); row += kPiece) {
    const Index rows = std::min(kPiece, columns.rows() - row);
    MatrixXd piece(upper.rows() + rows, wide);
    piece.topRows(upper.rows()) = upper;
    piece.bottomLeftCorner(rows, count) = columns.middleRows(row, rows);
    piece.bottomRightCorner(rows, 1) = target.segment(row, rows);
    const Eigen::HouseholderQR<Eigen::Ref<MatrixXd>> qr(piece);
    upper = qr.matrixQR().topRows(std::min(wide, piece.rows())).triangularView<Eigen::Upper>();
  }
  return {upper.leftCols(count), upper.col(count)};
}

namespace {

// Rows of the layout that say something of a joint.
std::vector<Index> rows_of(const RowLayout& layout, Index joint, const std::vector<char>& rows) {
  std::vector<Index> result;
  for (std::size_t r = 0; r < layout.recording_count(); ++r) {
    const Index first = layout.begin(r, joint);
    for (Index row = first; row < first + layout.samples(r); ++row) {
      const bool given = rows.empty() || rows[static_cast<std::size_t>(row)] != 0;
      if (given && layout.says_something(row)) result.push_back(row);
    }
  }
  return result;
}

}  // namespace

FewRowsOfJoints::FewRowsOfJoints(const RowLayout& layout, const MatrixXd& columns,
                                 const VectorXd& target, const std::vector<char>& rows)
    : count_(columns.cols()) {
  for (Index joint = 0; joint < layout.joint_count(); ++joint) {
    const std::vector<Index> which = rows_of(layout, joint, rows);
    OfJoint one;
    for (Index c = 0; c < columns.cols(); ++c) {
      const bool acts = std::any_of(which.begin(), which.end(),
                                    [&](const Index row) { return columns(row, c) != 0; });
      if (acts) one.acting.push_back(c);
    }
    one.rows = few_rows(columns(which, one.acting), target(which));
    joints_.push_back(std::move(one));
  }
}

RegressionRows FewRowsOfJoints::weighted(const VectorXd& joint_weights) const {
  Index count = 0;
  for (const OfJoint& one : joints_) count += one.rows.target.size();
  RegressionRows all{MatrixXd::Zero(count, count_), VectorXd(count)};
  Index row = 0;
  for (std::size_t joint = 0; joint < joints_.size(); ++joint) {
    const OfJoint& one = joints_[joint];
    const double weight = joint_weights[static_cast<Index>(joint)];
    const Index rows = one.rows.target.size();
    for (std::size_t i = 0; i < one.acting.size(); ++i) {
      all.columns.col(one.acting[i]).segment(row, rows) =
          weight * one.rows.columns.col(static_cast<Index>(i));
    }
    all.target.segment(row, rows) = weight * one.rows.target;
    row += rows;
  }
  return all;
}

}  // namespace offnominal::desk
