#include "explain/change_questions.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "explain/remainder.hpp"

namespace offnominal::desk {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

Remainder beside_columns(Remainder at, const MatrixXd& columns) {
  constexpr double kNothingNew = 1e-3;
  MatrixXd fresh(at.residual.size(), columns.cols());
  for (Index c = 0; c < columns.cols(); ++c) {
    fresh.col(c) = at.weighted(columns.col(c));
    const double length = fresh.col(c).norm();
    if (length > 0) fresh.col(c) /= length;
  }
  fresh = at.beside_basis(std::move(fresh));
  const Eigen::ColPivHouseholderQR<MatrixXd> qr(fresh);
  const Index most = std::min(fresh.rows(), fresh.cols());
  Index rank = 0;
  while (rank < most && std::abs(qr.matrixR()(rank, rank)) > kNothingNew) ++rank;
  if (rank == 0) return at;
  MatrixXd more = MatrixXd::Identity(fresh.rows(), rank);
  more.applyOnTheLeft(qr.householderQ());
  at.residual -= more * (more.transpose() * at.residual).eval();
  at.energy = at.layout->energy(at.residual);
  MatrixXd whole(fresh.rows(), at.basis.columns().cols() + rank);
  whole << at.basis.columns(), more;
  at.basis = Basis(std::move(whole));
  return at;
}

double likelihood_of(const Judge& judge, const MatrixXd& columns) {
  const Evidence evidence = judge.evidence(columns);
  return evidence.usable ? evidence.log_likelihood : 0;
}

bool is_sudden(const Moments& moments, std::size_t recorded, const MatrixXd& columns, double likely,
               const Judge& judge) {
  constexpr double kSudden = 5;
  constexpr int kDegree = 3;
  constexpr std::array kFadeParts{0.01, 0.02, 0.04, 0.07, 0.12, 0.2, 0.33};  // of the recording
  const auto is_as_likely = [&](const MatrixXd& slow) {
    return likelihood_of(judge, slow) + kSudden >= likely;
  };
  MatrixXd cubic(columns.rows(), kDegree * columns.cols());
  for (int power = 1; power <= kDegree; ++power) {
    cubic.middleCols((power - 1) * columns.cols(), columns.cols()) =
        moments.shaped(columns, recorded, [&](double part) { return std::pow(part, power); });
  }
  if (is_as_likely(cubic)) return false;
  return std::none_of(kFadeParts.begin(), kFadeParts.end(), [&](double fades) {
    return is_as_likely(
        moments.shaped(columns, recorded, [&](double part) { return std::exp(-part / fades); }));
  });
}

std::vector<Index> acting_joints(const Data& data, const MatrixXd& columns,
                                 const VectorXd& joint_weights) {
  constexpr double kActsOn = 0.2;
  const VectorXd energy =
      data.layout.energy(data.layout.weighted(columns.rowwise().sum(), joint_weights));
  std::vector<Index> joints;
  for (Index joint = 0; joint < energy.size(); ++joint) {
    if (energy[joint] >= kActsOn * energy.maxCoeff()) joints.push_back(joint);
  }
  return joints;
}

bool is_no_other_motion(const Data& data, const Remainder& remainder, const MatrixXd& columns) {
  constexpr double kStays = 0.33;
  constexpr double kMore = 1.2;
  const auto taken = [&](const Remainder& at) { return Judge(at).gain(columns) * at.energy.sum(); };
  const std::vector<Index> joints = acting_joints(data, columns, remainder.joint_weights);
  Remainder free = remainder;
  for (const Index joint : joints) {
    for (const char* variable : {"position", "velocity", "load"}) {
      free = beside_columns(std::move(free), bins_over(data, joint, variable));
    }
  }
  if (taken(free) >= kStays * taken(remainder)) return true;
  // What takes clearly more by itself than all of them together is about time: they would mimic a
  // moment where the motion behind it goes elsewhere.
  const Remainder beside = beside_columns(remainder, columns);
  double by_itself = 0;
  double by_functions = 0;
  for (const Index joint : joints) {
    by_itself += remainder.energy[joint] - beside.energy[joint];
    by_functions += remainder.energy[joint] - free.energy[joint];
  }
  return by_itself >= kMore * by_functions;
}

}  // namespace offnominal::desk
