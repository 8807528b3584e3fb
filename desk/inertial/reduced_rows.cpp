#include "inertial/reduced_rows.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

namespace offnominal::desk {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

// The upper triangle of what stands in `rows`.
MatrixXd upper_of(MatrixXd rows) {
  const Index left = std::min(rows.rows(), rows.cols());
  const Eigen::HouseholderQR<Eigen::Ref<MatrixXd>> qr(rows);
  return qr.matrixQR().topRows(left).triangularView<Eigen::Upper>();
}

// The same in pieces that stay in the cache, each on top of what the ones before it left.
MatrixXd upper_of(const MatrixXd& columns, const VectorXd& target, const std::vector<Index>& rows) {
  constexpr std::size_t kPiece = 512;
  const Index wide = columns.cols() + 1;
  MatrixXd upper(0, wide);
  for (std::size_t first = 0; first < rows.size(); first += kPiece) {
    const std::size_t count = std::min(kPiece, rows.size() - first);
    MatrixXd piece(upper.rows() + static_cast<Index>(count), wide);
    piece.topRows(upper.rows()) = upper;
    for (std::size_t i = 0; i < count; ++i) {
      const Index row = upper.rows() + static_cast<Index>(i);
      piece.row(row).head(columns.cols()) = columns.row(rows[first + i]);
      piece(row, wide - 1) = target[rows[first + i]];
    }
    upper = upper_of(std::move(piece));
  }
  return upper;
}

}  // namespace

ReducedRows::ReducedRows(const MatrixXd& columns, const VectorXd& target, const RowLayout& layout,
                         const std::vector<int>& parts, int part_count)
    : joints_(layout.joint_count()), part_count_(part_count) {
  const VectorXd counts = layout.while_moving(VectorXd::Ones(layout.rows()));
  for (Index joint = 0; joint < joints_; ++joint) {
    std::vector<std::vector<Index>> rows(static_cast<std::size_t>(part_count));
    for (std::size_t r = 0; r < layout.recording_count(); ++r) {
      for (Index i = 0; i < layout.samples(r); ++i) {
        const Index row = layout.begin(r, joint) + i;
        if (!(counts[row] > 0)) continue;
        rows[static_cast<std::size_t>(parts[static_cast<std::size_t>(row)])].push_back(row);
      }
    }
    for (const std::vector<Index>& of_part : rows) {
      pieces_.push_back({upper_of(columns, target, of_part), static_cast<double>(of_part.size())});
    }
  }
}

ReducedRows::Equations ReducedRows::weighted(const VectorXd& joint_weights, int without) const {
  const Index wide = pieces_.front().upper.cols();
  Index rows = 0;
  for (const Piece& one : pieces_) rows += one.upper.rows();
  MatrixXd stacked = MatrixXd::Zero(std::max<Index>(rows, 1), wide);
  Index at = 0;
  for (Index joint = 0; joint < joints_; ++joint) {
    for (int part = 0; part < part_count_; ++part) {
      if (part == without) continue;
      const MatrixXd& upper = piece(joint, part).upper;
      stacked.middleRows(at, upper.rows()) = joint_weights[joint] * upper;
      at += upper.rows();
    }
  }
  stacked.conservativeResize(std::max<Index>(at, 1), Eigen::NoChange);
  const MatrixXd upper = upper_of(std::move(stacked));
  return {upper.leftCols(wide - 1), upper.col(wide - 1)};
}

VectorXd ReducedRows::energy(const VectorXd& x, int part) const {
  VectorXd residual(x.size() + 1);
  residual << -x, 1;
  VectorXd energy = VectorXd::Zero(joints_);
  for (Index joint = 0; joint < joints_; ++joint) {
    for (int one = 0; one < part_count_; ++one) {
      if (part != kNone && one != part) continue;
      energy[joint] += (piece(joint, one).upper * residual).squaredNorm();
    }
  }
  return energy;
}

VectorXd ReducedRows::rms(const VectorXd& x, int part) const {
  VectorXd mean = energy(x, part);
  for (Index joint = 0; joint < joints_; ++joint) {
    double rows = 0;
    for (int one = 0; one < part_count_; ++one) {
      if (part == kNone || one == part) rows += piece(joint, one).rows;
    }
    mean[joint] /= std::max(1.0, rows);
  }
  return mean.cwiseSqrt();
}

std::vector<int> ReducedRows::parts() const {
  std::vector<int> filled;
  for (int part = 0; part < part_count_; ++part) {
    double rows = 0;
    for (Index joint = 0; joint < joints_; ++joint) rows += piece(joint, part).rows;
    if (rows > 0) filled.push_back(part);
  }
  return filled;
}

}  // namespace offnominal::desk
