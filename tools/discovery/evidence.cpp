#include "discovery/evidence.hpp"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <boost/math/distributions/fisher_f.hpp>
#include <cmath>
#include <map>
#include <random>
#include <utility>

namespace offnominal::tools::discovery {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

VectorXd Remainder::weighted(const VectorXd& values) const {
  VectorXd whole = VectorXd::Zero(residual.size());
  whole.head(layout->rows()) = layout->weighted(values, joint_weights);
  return whole;
}

MatrixXd Remainder::beside_basis(MatrixXd columns) const {
  if (basis.cols() > 0) {
    const MatrixXd along = basis.transpose() * columns;
    columns.noalias() -= basis * along;
  }
  return columns;
}

namespace {

// Block of a row; those of the priors come last, in one.
int block_of(const Remainder& remainder, Index row) {
  const auto at = static_cast<std::size_t>(row);
  return at < remainder.blocks.of_row.size() ? remainder.blocks.of_row[at] : remainder.blocks.count;
}

MatrixXd scores_of(const Remainder& remainder, const MatrixXd& columns) {
  MatrixXd scores = MatrixXd::Zero(remainder.blocks.count + 1, columns.cols());
  for (Index row = 0; row < columns.rows(); ++row) {
    scores.row(block_of(remainder, row)) += remainder.residual[row] * columns.row(row);
  }
  return scores;
}

// The d x d products of the columns, block by block, flattened.
MatrixXd moments_of(const Remainder& remainder, const MatrixXd& columns) {
  const Index d = columns.cols();
  MatrixXd moments = MatrixXd::Zero(remainder.blocks.count + 1, d * d);
  for (Index row = 0; row < columns.rows(); ++row) {
    const int block = block_of(remainder, row);
    for (Index i = 0; i < d; ++i) {
      for (Index j = 0; j < d; ++j) moments(block, i * d + j) += columns(row, i) * columns(row, j);
    }
  }
  return moments;
}

// The bounded Wald statistic, the blocks' scores times `signs`. What a block of a recording
// contributes varies as it is seen to, what the priors contribute as they say.
double statistic_of(const Evidence& group, const MatrixXd& whole_inverse, const VectorXd& signs) {
  const MatrixXd& scores = group.block_scores;
  const MatrixXd& moments = group.block_moments;
  const Index d = scores.cols();
  const Index blocks = scores.rows() - 1;
  const VectorXd solution = whole_inverse * (scores.transpose() * signs);
  MatrixXd after(blocks, d);
  for (Index k = 0; k < blocks; ++k) {
    for (Index i = 0; i < d; ++i) {
      double fitted = 0;
      for (Index j = 0; j < d; ++j) fitted += moments(k, i * d + j) * solution[j];
      after(k, i) = signs[k] * scores(k, i) - fitted;
    }
  }
  const VectorXd of_priors = group.prior_variance * moments.row(blocks).transpose();
  const MatrixXd variance =
      after.transpose() * after + Eigen::Map<const MatrixXd>(of_priors.data(), d, d);
  const double wald =
      solution.dot((whole_inverse * variance * whole_inverse).ldlt().solve(solution));
  const auto count = static_cast<double>(blocks);
  return std::isfinite(wald) && wald >= 0 ? count * wald / (count + wald) : 0;
}

MatrixXd inverse_of_sum(const MatrixXd& moments, Index d) {
  const VectorXd sum = moments.colwise().sum().transpose();
  const Eigen::Map<const MatrixXd> whole(sum.data(), d, d);
  return whole.ldlt().solve(MatrixXd::Identity(d, d));
}

// -log10 p over statistics from 0 to the number of blocks, for quick look-up.
class EvidenceScale {
 public:
  EvidenceScale(Index dimension, int blocks) : blocks_(blocks) {
    for (int i = 0; i <= kSteps; ++i) {
      const double statistic = blocks * static_cast<double>(i) / kSteps;
      values_[static_cast<std::size_t>(i)] =
          -std::log10(std::max(p_of_statistic(statistic, dimension, blocks), 1e-300));
    }
  }
  double operator()(double statistic) const {
    const double at = std::clamp(statistic / blocks_, 0.0, 1.0) * kSteps;
    const auto low = std::min(static_cast<std::size_t>(at), static_cast<std::size_t>(kSteps - 1));
    const double part = at - static_cast<double>(low);
    return values_[low] * (1 - part) + values_[low + 1] * part;
  }

 private:
  static constexpr int kSteps = 4000;
  int blocks_;
  std::array<double, kSteps + 1> values_{};
};

// `own`: weighted columns beside the basis; `before`: their lengths with what it takes.
Evidence judge_beside(const Remainder& remainder, const Eigen::Ref<const MatrixXd>& own,
                      const Eigen::Ref<const VectorXd>& before) {
  constexpr double kNothingNew = 1e-3;  // sine of the angle to what is fitted already
  Evidence evidence;
  const RowLayout& layout = *remainder.layout;
  MatrixXd scaled = own;
  for (Index c = 0; c < own.cols(); ++c) {
    const double length = own.col(c).norm();
    if (!(length > kNothingNew * before[c]) || !(length > 0)) return evidence;
    scaled.col(c) /= length;
  }
  const Eigen::ColPivHouseholderQR<MatrixXd> qr(scaled);
  if (qr.rank() < own.cols() ||
      std::abs(qr.matrixR()(own.cols() - 1, own.cols() - 1)) < kNothingNew) {
    return evidence;
  }
  const VectorXd solution = qr.solve(remainder.residual);
  evidence.coefficients = solution.array() / own.colwise().norm().transpose().array();
  const VectorXd left = remainder.residual - scaled * solution;
  const VectorXd energy = layout.energy(left);
  evidence.gain = 1 - energy.sum() / remainder.energy.sum();
  for (Index joint = 0; joint < energy.size(); ++joint) {
    if (!(energy[joint] > 0) || !(remainder.energy[joint] > 0)) continue;
    evidence.joint_gain =
        std::max(evidence.joint_gain, 1 - energy[joint] / remainder.energy[joint]);
    evidence.log_likelihood += 0.5 * remainder.independent_samples[joint] *
                               std::log(remainder.energy[joint] / energy[joint]);
  }
  evidence.block_scores = scores_of(remainder, scaled);
  evidence.block_moments = moments_of(remainder, scaled);
  evidence.prior_variance = remainder.prior_weight * remainder.prior_weight;
  evidence.statistic = statistic_of(evidence, inverse_of_sum(evidence.block_moments, own.cols()),
                                    VectorXd::Ones(remainder.blocks.count + 1));
  evidence.usable = std::isfinite(evidence.statistic);
  return evidence;
}

}  // namespace

double explained_share(double before, double left) { return 1 - std::pow(left / before, 2); }

Evidence judge(const Remainder& remainder, const MatrixXd& columns) {
  return std::move(judge_each(remainder, std::span(&columns, 1)).front());
}

std::vector<Evidence> judge_each(const Remainder& remainder, std::span<const MatrixXd> groups) {
  // Several groups at once go past the basis, which is large, as one matrix.
  constexpr Index kColumnsAtOnce = 16;
  std::vector<Evidence> judged;
  while (!groups.empty()) {
    std::size_t taken = 0;
    Index count = 0;
    while (taken < groups.size() &&
           (taken == 0 || count + groups[taken].cols() <= kColumnsAtOnce)) {
      count += groups[taken++].cols();
    }
    MatrixXd together(remainder.residual.size(), count);
    Index at = 0;
    for (const MatrixXd& group : groups.first(taken)) {
      for (const auto& column : group.colwise()) together.col(at++) = remainder.weighted(column);
    }
    const VectorXd before = together.colwise().norm().transpose();
    const MatrixXd own = remainder.beside_basis(std::move(together));
    at = 0;
    for (const MatrixXd& group : groups.first(taken)) {
      judged.push_back(judge_beside(remainder, own.middleCols(at, group.cols()),
                                    before.segment(at, group.cols())));
      at += group.cols();
    }
    groups = groups.subspan(taken);
  }
  return judged;
}

double p_of_statistic(double statistic, Index dimension, int blocks) {
  const auto d = static_cast<double>(dimension);
  const auto k = static_cast<double>(blocks);
  if (!(k > d) || !(statistic > 0)) return 1;
  if (!(statistic < k)) return 0;
  const double f = (k - d) / d * statistic / (k - statistic);
  return boost::math::cdf(boost::math::complement(boost::math::fisher_f(d, k - d), f));
}

std::vector<double> largest_without_effect(const std::vector<Evidence>& groups, int blocks,
                                           int draws, std::uint64_t seed) {
  std::map<Index, EvidenceScale> scales;
  for (const Evidence& group : groups) {
    const Index d = group.block_scores.cols();
    if (group.usable && !scales.contains(d)) scales.emplace(d, EvidenceScale(d, blocks));
  }
  std::mt19937_64 generator(seed);
  MatrixXd signs(draws, blocks + 1);
  std::uint64_t bits = 0;
  int left = 0;
  for (Index row = 0; row < draws; ++row) {
    for (Index block = 0; block <= blocks; ++block) {
      if (left == 0) {
        bits = generator();
        left = 64;
      }
      signs(row, block) = (bits & 1U) != 0 ? 1.0 : -1.0;
      bits >>= 1U;
      --left;
    }
  }
  std::vector<double> largest(static_cast<std::size_t>(draws), 0.0);
  for (const Evidence& group : groups) {
    if (!group.usable) continue;
    const Index d = group.block_scores.cols();
    const EvidenceScale& scale = scales.at(d);
    const MatrixXd inverse = inverse_of_sum(group.block_moments, d);
    for (Index draw = 0; draw < draws; ++draw) {
      const double statistic = statistic_of(group, inverse, signs.row(draw).transpose());
      double& at = largest[static_cast<std::size_t>(draw)];
      at = std::max(at, scale(statistic));
    }
  }
  std::sort(largest.begin(), largest.end());
  return largest;
}

double p_among(const std::vector<double>& null, double value) {
  const auto first = std::lower_bound(null.begin(), null.end(), value);
  const auto reached = static_cast<double>(null.end() - first);
  return (1 + reached) / (1 + static_cast<double>(null.size()));
}

}  // namespace offnominal::tools::discovery
