#include "analysis/normal_equations.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace offnominal::tools {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

NormalEquations::NormalEquations(const std::vector<JointRows>& rows,
                                 const std::vector<int>& group_of, int group_count)
    : samples_(static_cast<std::size_t>(group_count), 0) {
  const auto groups = static_cast<std::size_t>(group_count);
  products_.resize(groups);
  const auto samples = static_cast<Index>(group_of.size());
  for (const JointRows& joint : rows) {
    if (joint.columns.rows() != samples || joint.target.size() != samples) {
      throw std::invalid_argument("every sample of a regression belongs to a group");
    }
    const Index size = joint.columns.cols() + 1;
    std::vector<MatrixXd> of_joint(groups, MatrixXd::Zero(size, size));
    for (Index first = 0; first < samples;) {
      const int group = group_of[static_cast<std::size_t>(first)];
      Index end = first;
      while (end < samples && group_of[static_cast<std::size_t>(end)] == group) ++end;
      if (group >= 0) {
        MatrixXd part(end - first, size);
        part.leftCols(size - 1) = joint.columns.middleRows(first, end - first);
        part.col(size - 1) = joint.target.segment(first, end - first);
        of_joint[static_cast<std::size_t>(group)].noalias() += part.transpose() * part;
        if (&joint == rows.data()) samples_[static_cast<std::size_t>(group)] += end - first;
      }
      first = end;
    }
    for (std::size_t group = 0; group < groups; ++group) {
      products_[group].push_back(std::move(of_joint[group]));
    }
  }
}

MatrixXd NormalEquations::sum(const std::vector<double>& joint_weights, int left_out) const {
  MatrixXd total = MatrixXd::Zero(products_[0][0].rows(), products_[0][0].cols());
  for (int group = 0; group < group_count(); ++group) {
    if (group == left_out) continue;
    for (std::size_t joint = 0; joint < joint_count(); ++joint) {
      total += joint_weights[joint] * products(group, joint);
    }
  }
  return total;
}

double squared_error(const MatrixXd& products, const VectorXd& x) {
  const Index n = x.size();
  const double error =
      products(n, n) - 2 * x.dot(products.col(n).head(n)) + x.dot(products.topLeftCorner(n, n) * x);
  return std::max(error, 0.0);
}

namespace {

class Solver {
 public:
  Solver(const MatrixXd& products, const std::vector<UnknownPrior>& priors)
      : products_(products), priors_(priors) {
    const auto n = static_cast<Index>(priors.size());
    if (products.rows() != n + 1 || products.cols() != n + 1) {
      throw std::invalid_argument("one prior per unknown is needed");
    }
    normal_ = products.topLeftCorner(n, n);
    start_.resize(n);
    for (Index i = 0; i < n; ++i) {
      start_[i] = prior(i).start;
      normal_(i, i) += prior(i).precision;
    }
    right_ = products.col(n).head(n) - products.topLeftCorner(n, n) * start_;
    solution_.is_fixed.assign(priors.size(), false);
  }

  LinearSolution run() {
    while (fix_one()) {
    }
    solve_for_free();
    return std::move(solution_);
  }

 private:
  const UnknownPrior& prior(Index i) const { return priors_[static_cast<std::size_t>(i)]; }

  void find_free() {
    free_.clear();
    for (std::size_t i = 0; i < priors_.size(); ++i) {
      if (!solution_.is_fixed[i]) free_.push_back(static_cast<Index>(i));
    }
  }

  bool fix_one() {
    find_free();
    if (free_.empty()) return false;
    for (const Index i : free_) {
      if (normal_(i, i) > 0) continue;
      fix(i, {});
      return true;
    }
    const VectorXd scale = normal_.diagonal()(free_).cwiseSqrt().cwiseInverse();
    const MatrixXd correlation = scale.asDiagonal() * normal_(free_, free_) * scale.asDiagonal();
    const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(correlation);
    if (eigen.eigenvalues()[0] >= kSmallestSingularValue * kSmallestSingularValue) return false;
    fix_member(eigen.eigenvectors().col(0).cwiseAbs());
    return true;
  }

  void fix_member(const VectorXd& direction) {
    constexpr double kMemberShare = 0.3;
    std::vector<Index> members;
    for (Index i = 0; i < direction.size(); ++i) {
      if (direction[i] >= kMemberShare * direction.maxCoeff()) {
        members.push_back(free_[static_cast<std::size_t>(i)]);
      }
    }
    Index chosen = members.back();
    for (const Index member : members) {
      if (prior(member).gives_way || !prior(chosen).gives_way) chosen = member;
    }
    std::erase(members, chosen);
    fix(chosen, members);
  }

  void fix(Index which, const std::vector<Index>& others) {
    Ambiguity ambiguity;
    ambiguity.fixed = static_cast<std::size_t>(which);
    for (const Index other : others) ambiguity.others.push_back(static_cast<std::size_t>(other));
    solution_.ambiguities.push_back(ambiguity);
    solution_.is_fixed[static_cast<std::size_t>(which)] = true;
  }

  void solve_for_free() {
    find_free();
    const Index n = start_.size();
    solution_.x = start_;
    solution_.inverse = MatrixXd::Zero(n, n);
    if (!free_.empty()) {
      const auto free_count = static_cast<Index>(free_.size());
      const VectorXd scale = normal_.diagonal()(free_).cwiseSqrt().cwiseInverse();
      const MatrixXd scaled = scale.asDiagonal() * normal_(free_, free_) * scale.asDiagonal();
      const Eigen::LDLT<MatrixXd> factors(scaled);
      const VectorXd step = factors.solve(scale.asDiagonal() * right_(free_));
      const MatrixXd inverse = factors.solve(MatrixXd::Identity(free_count, free_count));
      solution_.x(free_) += scale.asDiagonal() * step;
      solution_.inverse(free_, free_) = scale.asDiagonal() * inverse * scale.asDiagonal();
    }
    solution_.cost = squared_error(products_, solution_.x);
    for (Index i = 0; i < n; ++i) {
      const double deviation = solution_.x[i] - start_[i];
      solution_.cost += prior(i).precision * deviation * deviation;
    }
  }

  const MatrixXd& products_;
  const std::vector<UnknownPrior>& priors_;
  MatrixXd normal_;
  VectorXd start_;
  VectorXd right_;
  std::vector<Index> free_;
  LinearSolution solution_;
};

}  // namespace

LinearSolution solve(const MatrixXd& products, const std::vector<UnknownPrior>& priors) {
  return Solver(products, priors).run();
}

}  // namespace offnominal::tools
