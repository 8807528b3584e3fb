#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "identify/rows.hpp"

namespace offnominal::desk {

// Orthonormal columns, made when they are first asked for: beside most fits nothing is judged.
// Copies share them.
class Basis {
 public:
  Basis() : Basis(Eigen::MatrixXd()) {}
  explicit Basis(Eigen::MatrixXd columns) : made_(std::make_shared<Made>()) {
    std::call_once(made_->once, [&] { made_->columns = std::move(columns); });
  }
  explicit Basis(std::function<Eigen::MatrixXd()> make) : made_(std::make_shared<Made>()) {
    made_->make = std::move(make);
  }
  [[nodiscard]] const Eigen::MatrixXd& columns() const;

 private:
  struct Made {
    std::once_flag once;
    std::function<Eigen::MatrixXd()> make;
    Eigen::MatrixXd columns;
  };
  std::shared_ptr<Made> made_;
};

// What is left of the torque once a model has been fitted, ready for judging columns beside it.
// Behind the rows of the layout come those of the priors (fit.hpp), where candidates are 0.
struct Remainder {
  const RowLayout* layout = nullptr;
  RowLayout::Blocks blocks;
  Eigen::VectorXd joint_weights;
  Eigen::VectorXd residual;             // weighted, orthogonal to the basis
  Basis basis;                          // weighted, with the rows of the priors
  Eigen::VectorXd energy;               // per joint, of the weighted residual
  Eigen::VectorXd independent_samples;  // per joint
  double prior_weight = 1;              // standard deviation of the rows of the priors

  [[nodiscard]] Eigen::Index prior_rows() const { return residual.size() - layout->rows(); }
  // Stacked values, weighted, with zeros in the rows of the priors.
  [[nodiscard]] Eigen::VectorXd weighted(const Eigen::VectorXd& values) const;
  // Weighted columns less what the basis takes of them.
  [[nodiscard]] Eigen::MatrixXd beside_basis(Eigen::MatrixXd columns) const;
};

// What columns would add to the model, everything that the model fits adapting to them.
struct Evidence {
  Eigen::VectorXd coefficients;  // of the unweighted columns
  double gain = 0;               // share of the weighted residual's energy that goes
  double joint_gain = 0;         // the same for the joint where most goes
  double log_likelihood = 0;     // gain in it, with as many samples as are independent
  // Wald statistic W with a covariance that holds for errors correlated inside a block and of any
  // variance, as K W / (K + W) with K blocks: at most their number.
  double statistic = 0;
  bool usable = false;  // false: the columns add nothing to the basis
  // Rows: blocks, then one for all priors; columns: coefficients, and the d x d products.
  Eigen::MatrixXd block_scores;
  Eigen::MatrixXd block_moments;
  double prior_variance = 1;  // of one row of the priors: no single robot shows it
};

// Share of an error's energy that goes with what is left of it, both rms; negative where it grows.
double explained_share(double before, double left);

// Stacked, unweighted columns of a candidate, only those rows where it acts: an effect of one joint
// of seven has a seventh of them.
class ActingColumns {
 public:
  ActingColumns() = default;
  ActingColumns(const RowLayout& layout, const Eigen::MatrixXd& columns);

  // Consecutive rows of one joint of one recording.
  struct Span {
    Eigen::Index joint = 0;
    Eigen::Index begin = 0;  // in the layout
    Eigen::Index count = 0;
  };
  [[nodiscard]] const std::vector<Span>& spans() const { return spans_; }
  // The spans' rows, one span after the other.
  [[nodiscard]] const Eigen::MatrixXd& values() const { return values_; }

 private:
  std::vector<Span> spans_;
  Eigen::MatrixXd values_;
};

// Judges columns beside one remainder, which has to outlive it: what does not depend on the columns
// is computed once.
class Judge {
 public:
  explicit Judge(const Remainder& remainder);
  // The same basis with another residual.
  Judge(const Remainder& remainder, const Judge& like);

  [[nodiscard]] Evidence evidence(const ActingColumns& columns) const;
  [[nodiscard]] Evidence evidence(const Eigen::MatrixXd& columns) const;
  // Evidence::gain and joint_gain alone; negative where the columns add nothing.
  [[nodiscard]] double gain(const Eigen::MatrixXd& columns) const;
  [[nodiscard]] double joint_gain(const ActingColumns& columns) const;

 private:
  struct Fitted;
  [[nodiscard]] Fitted fit(const ActingColumns& columns) const;
  void take_residual();

  const Remainder& remainder_;
  const Eigen::MatrixXd& basis_;
  Eigen::VectorXd row_weights_;
  std::vector<Eigen::VectorXd> basis_by_residual_;  // per joint: basis^T residual
  std::shared_ptr<const std::vector<Eigen::MatrixXd>> basis_by_basis_;  // per joint
  Eigen::MatrixXd block_basis_by_residual_;  // blocks x basis: of all joints
};

// `columns`: stacked, unweighted.
Evidence judge(const Remainder& remainder, const Eigen::MatrixXd& columns);

// Probability of a statistic at least this large without the effect, for one group of columns:
// blocks - dimension over dimension times t / (blocks - t) is about F(dimension, blocks -
// dimension).
double p_of_statistic(double statistic, Eigen::Index dimension, int blocks);

// Largest evidence, as -log10 of p_of_statistic(), that each of `draws` recordings without any
// effect gives over all the groups: the remainder of every block keeps its size and gets a random
// sign (wild block bootstrap with Rademacher weights; the statistic is computed anew each time, as
// in A. C. Cameron, J. B. Gelbach, D. L. Miller, Review of Economics and Statistics 90(3), 2008).
// One per draw, in their order, on `threads` threads: the same draws of other groups of the same
// recordings may be put beside them.
std::vector<double> largest_without_effect(const std::vector<Evidence>& groups, int blocks,
                                           int draws, std::uint64_t seed, int threads = 1);

// Share of `null` that reaches `value`, at least 1 / (1 + its size).
double p_among(const std::vector<double>& null, double value);

}  // namespace offnominal::desk
