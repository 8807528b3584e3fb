#include "explain/excitation.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace offnominal::desk {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

// Below this a joint stands still: 1 degree, or 1 mm, and so many encoder counts.
constexpr double kStillRad = 0.0175;
constexpr double kStillM = 0.001;
constexpr double kFewestCounts = 100;
constexpr Index kColumns = 6;

void add_products(const Workspace& at, Index joint, MatrixXd& products) {
  MatrixXd columns;
  Index to = 0;
  for (const Regressor& one : standard_regressors(at, joint)) {
    const VectorXd kept = filtered(at.plan, one[0].values);
    if (columns.size() == 0) columns.resize(kept.size(), kColumns);
    columns.col(to++) = kept;
  }
  products += columns.transpose() * columns;
}

double smallest_singular_value(const MatrixXd& products) {
  const VectorXd length = products.diagonal().cwiseSqrt();
  if (!(length.minCoeff() > 0)) return 0;
  const MatrixXd scaled =
      length.cwiseInverse().asDiagonal() * products * length.cwiseInverse().asDiagonal();
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(scaled, Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(0.0, eigen.eigenvalues()[0]));
}

// Between the extreme positions, rad or m.
double range_of(const std::vector<Workspace>& recordings, Index joint) {
  double low = recordings[0].motion.q(0, joint);
  double high = low;
  for (const Workspace& at : recordings) {
    low = std::min(low, at.motion.q.col(joint).minCoeff());
    high = std::max(high, at.motion.q.col(joint).maxCoeff());
  }
  return high - low;
}

bool moves_by(const Workspace& at, Index joint, double range) {
  const RobotJoint& of = at.rigid.joints[static_cast<std::size_t>(joint)];
  const double counts = of.encoder.counts_per_unit;
  const double still = of.joint.type == JointType::kRevolute ? kStillRad : kStillM;
  return range > still && (!(counts > 0) || range * counts > kFewestCounts);
}

}  // namespace

std::vector<Regressor> standard_regressors(const Workspace& at, Index joint) {
  const Eigen::ArrayXd q = at.motion.q.col(joint).array();
  const Eigen::ArrayXd dq = at.motion.dq.col(joint).array();
  std::vector<Regressor> standard;
  const auto put = [&](const Eigen::ArrayXd& values) {
    standard.push_back({{joint, values.matrix()}});
  };
  put(Eigen::ArrayXd::Ones(q.size()));
  put(q - q.mean());
  put(dq);
  put(at.motion.ddq.col(joint).array());
  put(at.sign(joint));
  put(dq * dq.abs());
  return standard;
}

bool moves(const std::vector<Workspace>& recordings, Index joint) {
  return moves_by(recordings[0], joint, range_of(recordings, joint));
}

std::vector<Excitation> excitation_of(const std::vector<Workspace>& recordings) {
  std::vector<Excitation> all;
  for (Index joint = 0; joint < recordings[0].joint_count(); ++joint) {
    Excitation one;
    MatrixXd products = MatrixXd::Zero(kColumns, kColumns);
    for (const Workspace& at : recordings) {
      one.top_speed = std::max(one.top_speed, at.top_speed[joint]);
      if (!at.at_rest) add_products(at, joint, products);
    }
    one.range = range_of(recordings, joint);
    const bool at_rest = recordings[0].at_rest;
    one.separation = at_rest ? 0 : smallest_singular_value(products);
    one.moves = moves_by(recordings[0], joint, one.range);
    one.sufficient = one.moves;
    if (!one.moves) {
      one.lack = at_rest ? "the joint was held at one position only" : "the joint does not move";
    }
    all.push_back(one);
  }
  return all;
}

bool all_sufficient(const std::vector<Excitation>& joints) {
  return std::all_of(joints.begin(), joints.end(),
                     [](const Excitation& joint) { return joint.sufficient; });
}

}  // namespace offnominal::desk
