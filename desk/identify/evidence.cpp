#include "identify/evidence.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <boost/math/distributions/fisher_f.hpp>
#include <cmath>
#include <map>
#include <memory>
#include <random>

#include "common/parallel.hpp"

namespace offnominal::desk {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

const MatrixXd& Basis::columns() const {
  std::call_once(made_->once, [&] { made_->columns = made_->make(); });
  return made_->columns;
}

VectorXd Remainder::weighted(const VectorXd& values) const {
  VectorXd whole = VectorXd::Zero(residual.size());
  whole.head(layout->rows()) = layout->weighted(values, joint_weights);
  return whole;
}

MatrixXd Remainder::beside_basis(MatrixXd columns) const {
  const MatrixXd& beside = basis.columns();
  if (beside.cols() > 0) {
    const MatrixXd along = beside.transpose() * columns;
    columns.noalias() -= beside * along;
  }
  return columns;
}

namespace {

constexpr double kNothingNew = 1e-3;  // sine of the angle to what is fitted already

// The bounded Wald statistic of K blocks.
double bounded(double wald, double blocks) {
  return std::isfinite(wald) && wald >= 0 ? blocks * wald / (blocks + wald) : 0;
}

MatrixXd inverse_of_sum(const MatrixXd& moments, Index d) {
  const VectorXd sum = moments.colwise().sum().transpose();
  const Eigen::Map<const MatrixXd> whole(sum.data(), d, d);
  return whole.ldlt().solve(MatrixXd::Identity(d, d));
}

// The statistic of one group under any signs of its blocks. What a block of a recording contributes
// varies as it is seen to, what the priors contribute as they say. With signs e_k, scores s_k and
// moments M_k the solution is x = W sum e_k s_k, and the scatter of the blocks about it
//   sum (e_k s_k - M_k x) (e_k s_k - M_k x)^T
// needs nothing of the signs but the sums of e_k s_k and of e_k s_k,j M_k,il: `features` are those
// that are multiplied with the signs, the rest is computed once.
class StatisticOfSigns {
 public:
  explicit StatisticOfSigns(const Evidence& group) : d_(group.block_scores.cols()) {
    const MatrixXd& scores = group.block_scores;
    const MatrixXd& moments = group.block_moments;
    const Index blocks = scores.rows() - 1;
    count_ = static_cast<double>(blocks);
    inverse_ = inverse_of_sum(moments, d_);
    features_ = MatrixXd::Zero(blocks + 1, d_ + d_ * d_ * d_);
    features_.leftCols(d_) = scores;
    for (Index j = 0; j < d_; ++j) {
      features_.middleCols(d_ + j * d_ * d_, d_ * d_).topRows(blocks) =
          moments.topRows(blocks).array().colwise() * scores.col(j).head(blocks).array();
    }
    const auto of_scores = scores.topRows(blocks);
    constant_ = of_scores.transpose() * of_scores;
    const VectorXd priors = group.prior_variance * moments.row(blocks).transpose();
    constant_ += Eigen::Map<const MatrixXd>(priors.data(), d_, d_);
    moments_by_moments_ = moments.topRows(blocks).transpose() * moments.topRows(blocks);
  }

  [[nodiscard]] const MatrixXd& features() const { return features_; }

  // `sums`: the features, each summed with the signs of its blocks.
  template <typename Sums>
  [[nodiscard]] double operator()(const Sums& sums) const {
    if (d_ == 1) {
      const double x = inverse_(0, 0) * sums[0];
      const double scatter = constant_(0, 0) - 2 * x * sums[1] + x * x * moments_by_moments_(0, 0);
      const double variance = inverse_(0, 0) * inverse_(0, 0) * scatter;
      return bounded(x * x / variance, count_);
    }
    VectorXd x = VectorXd::Zero(d_);
    for (Index i = 0; i < d_; ++i) {
      for (Index j = 0; j < d_; ++j) x[i] += inverse_(i, j) * sums[j];
    }
    MatrixXd scatter = constant_;
    for (Index i = 0; i < d_; ++i) {
      for (Index j = 0; j < d_; ++j) {
        for (Index l = 0; l < d_; ++l) {
          scatter(i, j) -=
              x[l] * (sums[d_ + j * d_ * d_ + i * d_ + l] + sums[d_ + i * d_ * d_ + j * d_ + l]);
          for (Index m = 0; m < d_; ++m) {
            scatter(i, j) += x[l] * x[m] * moments_by_moments_(i * d_ + l, j * d_ + m);
          }
        }
      }
    }
    return bounded(x.dot((inverse_ * scatter * inverse_).ldlt().solve(x)), count_);
  }

 private:
  Index d_;
  double count_ = 0;
  MatrixXd inverse_;             // of the sum of all moments
  MatrixXd features_;            // rows: blocks, the priors' last
  MatrixXd constant_;            // sum s_k s_k^T, and what the priors say
  MatrixXd moments_by_moments_;  // of the flattened moments
};

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

// The joint and the rows of every part of the layout, in its order.
std::vector<ActingColumns::Span> parts_of(const RowLayout& layout) {
  std::vector<ActingColumns::Span> parts;
  for (std::size_t r = 0; r < layout.recording_count(); ++r) {
    for (Index joint = 0; joint < layout.joint_count(); ++joint) {
      parts.push_back({joint, layout.begin(r, joint), layout.samples(r)});
    }
  }
  return parts;
}

// Share of the energy that goes on the joint where most does.
double largest_share(const VectorXd& before, const VectorXd& after) {
  double most = 0;
  for (Index joint = 0; joint < before.size(); ++joint) {
    if (after[joint] > 0 && before[joint] > 0)
      most = std::max(most, 1 - after[joint] / before[joint]);
  }
  return most;
}

}  // namespace

double explained_share(double before, double left) { return 1 - std::pow(left / before, 2); }

ActingColumns::ActingColumns(const RowLayout& layout, const MatrixXd& columns) {
  Index rows = 0;
  for (const Span& part : parts_of(layout)) {
    if (columns.middleRows(part.begin, part.count).isZero(0)) continue;
    spans_.push_back(part);
    rows += part.count;
  }
  values_.resize(rows, columns.cols());
  Index at = 0;
  for (const Span& span : spans_) {
    values_.middleRows(at, span.count) = columns.middleRows(span.begin, span.count);
    at += span.count;
  }
}

Judge::Judge(const Remainder& remainder)
    : remainder_(remainder), basis_(remainder.basis.columns()) {
  const RowLayout& layout = *remainder.layout;
  const Index width = basis_.cols();
  row_weights_ = layout.weighted(VectorXd::Ones(layout.rows()), remainder.joint_weights);
  auto products = std::make_shared<std::vector<MatrixXd>>(
      static_cast<std::size_t>(layout.joint_count()), MatrixXd::Zero(width, width));
  for (const ActingColumns::Span& part : parts_of(layout)) {
    const auto basis = basis_.middleRows(part.begin, part.count);
    (*products)[static_cast<std::size_t>(part.joint)].noalias() += basis.transpose() * basis;
  }
  basis_by_basis_ = std::move(products);
  take_residual();
}

Judge::Judge(const Remainder& remainder, const Judge& like)
    : remainder_(remainder),
      basis_(remainder.basis.columns()),
      row_weights_(like.row_weights_),
      basis_by_basis_(like.basis_by_basis_) {
  take_residual();
}

void Judge::take_residual() {
  const RowLayout& layout = *remainder_.layout;
  const Index width = basis_.cols();
  basis_by_residual_.assign(static_cast<std::size_t>(layout.joint_count()), VectorXd::Zero(width));
  for (const ActingColumns::Span& part : parts_of(layout)) {
    basis_by_residual_[static_cast<std::size_t>(part.joint)] +=
        basis_.middleRows(part.begin, part.count).transpose() *
        remainder_.residual.segment(part.begin, part.count);
  }
  block_basis_by_residual_ = MatrixXd::Zero(remainder_.blocks.count, width);
  for (Index column = 0; column < width; ++column) {
    for (Index row = 0; row < layout.rows(); ++row) {
      block_basis_by_residual_(remainder_.blocks.of_row[static_cast<std::size_t>(row)], column) +=
          basis_(row, column) * remainder_.residual[row];
    }
  }
}

// The least squares of columns beside the basis, from their own rows.
struct Judge::Fitted {
  bool usable = false;
  MatrixXd weighted;  // own rows, columns of length 1 beside the basis
  MatrixXd along;     // of these, in the basis
  VectorXd length;    // that they had
  MatrixXd products;  // of the columns beside the basis
  VectorXd solution;
  VectorXd energy;  // per joint, of what is left
};

Judge::Fitted Judge::fit(const ActingColumns& columns) const {
  Fitted fitted;
  const Index d = columns.values().cols();
  if (columns.spans().empty() || d == 0) return fitted;
  MatrixXd& weighted = fitted.weighted;
  weighted.resizeLike(columns.values());
  MatrixXd& along = fitted.along;
  along = MatrixXd::Zero(basis_.cols(), d);
  VectorXd by_residual = VectorXd::Zero(d);
  Index at = 0;
  for (const ActingColumns::Span& span : columns.spans()) {
    auto part = weighted.middleRows(at, span.count);
    part = row_weights_.segment(span.begin, span.count).asDiagonal() *
           columns.values().middleRows(at, span.count);
    along.noalias() += basis_.middleRows(span.begin, span.count).transpose() * part;
    by_residual += part.transpose() * remainder_.residual.segment(span.begin, span.count);
    at += span.count;
  }
  const MatrixXd own = weighted.transpose() * weighted;
  MatrixXd products = own - along.transpose() * along;
  fitted.length.resize(d);
  for (Index c = 0; c < d; ++c) {
    const double length = std::sqrt(std::max(0.0, products(c, c)));
    if (!(length > kNothingNew * std::sqrt(own(c, c))) || !(length > 0)) return fitted;
    fitted.length[c] = length;
  }
  const VectorXd shorter = fitted.length.cwiseInverse();
  weighted = weighted * shorter.asDiagonal();
  along = along * shorter.asDiagonal();
  by_residual = by_residual.cwiseProduct(shorter);
  products = shorter.asDiagonal() * products * shorter.asDiagonal();
  const Eigen::LDLT<MatrixXd> solver(products);
  // Pivots are squared sines of the angle to the columns before.
  if (!(solver.vectorD().minCoeff() > kNothingNew * kNothingNew)) return fitted;
  fitted.solution = solver.solve(by_residual);
  fitted.products = products;
  // What is left of a joint: residual - columns * x + basis * z with z = along * x.
  const VectorXd z = along * fitted.solution;
  fitted.energy = remainder_.energy;
  for (Index joint = 0; joint < fitted.energy.size(); ++joint) {
    const auto which = static_cast<std::size_t>(joint);
    fitted.energy[joint] +=
        2 * basis_by_residual_[which].dot(z) + z.dot((*basis_by_basis_)[which] * z);
  }
  at = 0;
  for (const ActingColumns::Span& span : columns.spans()) {
    const VectorXd taken = weighted.middleRows(at, span.count) * fitted.solution;
    const auto residual = remainder_.residual.segment(span.begin, span.count);
    const VectorXd back = basis_.middleRows(span.begin, span.count) * z;
    fitted.energy[span.joint] +=
        taken.squaredNorm() - 2 * taken.dot(residual) - 2 * taken.dot(back);
    at += span.count;
  }
  fitted.energy = fitted.energy.cwiseMax(0.0);
  fitted.usable = true;
  return fitted;
}

double Judge::gain(const MatrixXd& columns) const {
  const Fitted fitted = fit(ActingColumns(*remainder_.layout, columns));
  return fitted.usable ? 1 - fitted.energy.sum() / remainder_.energy.sum() : -1;
}

double Judge::joint_gain(const ActingColumns& columns) const {
  const Fitted fitted = fit(columns);
  return fitted.usable ? largest_share(remainder_.energy, fitted.energy) : -1;
}

Evidence Judge::evidence(const MatrixXd& columns) const {
  return evidence(ActingColumns(*remainder_.layout, columns));
}

Evidence Judge::evidence(const ActingColumns& columns) const {
  Evidence evidence;
  const Fitted fitted = fit(columns);
  if (!fitted.usable) return evidence;
  const Index d = fitted.solution.size();
  const int blocks = remainder_.blocks.count;
  evidence.coefficients = fitted.solution.cwiseQuotient(fitted.length);
  evidence.gain = 1 - fitted.energy.sum() / remainder_.energy.sum();
  evidence.joint_gain = largest_share(remainder_.energy, fitted.energy);
  for (Index joint = 0; joint < fitted.energy.size(); ++joint) {
    const double before = remainder_.energy[joint];
    const double after = fitted.energy[joint];
    if (!(after > 0) || !(before > 0)) continue;
    evidence.log_likelihood +=
        0.5 * remainder_.independent_samples[joint] * std::log(before / after);
  }
  // The scores of all rows: those of the columns, less those of what the basis takes of them.
  evidence.block_scores = MatrixXd::Zero(blocks + 1, d);
  evidence.block_scores.topRows(blocks) = -block_basis_by_residual_ * fitted.along;
  MatrixXd moments = MatrixXd::Zero(blocks + 1, d * d);
  Index at = 0;
  for (const ActingColumns::Span& span : columns.spans()) {
    const MatrixXd own = fitted.weighted.middleRows(at, span.count) -
                         basis_.middleRows(span.begin, span.count) * fitted.along;
    for (Index i = 0; i < span.count; ++i) {
      const Index row = span.begin + i;
      const int block = remainder_.blocks.of_row[static_cast<std::size_t>(row)];
      for (Index a = 0; a < d; ++a) {
        evidence.block_scores(block, a) += remainder_.residual[row] * fitted.weighted(at + i, a);
        for (Index b = 0; b < d; ++b) moments(block, a * d + b) += own(i, a) * own(i, b);
      }
    }
    at += span.count;
  }
  const Index rows = remainder_.layout->rows();
  const MatrixXd of_priors = -basis_.bottomRows(remainder_.prior_rows()) * fitted.along;
  evidence.block_scores.row(blocks) =
      remainder_.residual.tail(remainder_.residual.size() - rows).transpose() * of_priors;
  const MatrixXd prior_products = of_priors.transpose() * of_priors;
  moments.row(blocks) = Eigen::Map<const Eigen::RowVectorXd>(prior_products.data(), d * d);
  // What the columns move on other joints, by way of what these have in common, is little: it is
  // spread evenly.
  const Eigen::RowVectorXd elsewhere =
      Eigen::Map<const Eigen::RowVectorXd>(fitted.products.data(), d * d) - moments.colwise().sum();
  moments.topRows(blocks).rowwise() += elsewhere / blocks;
  evidence.block_moments = std::move(moments);
  evidence.prior_variance = remainder_.prior_weight * remainder_.prior_weight;
  const StatisticOfSigns statistic(evidence);
  evidence.statistic = statistic(statistic.features().colwise().sum().eval());
  evidence.usable = std::isfinite(evidence.statistic);
  return evidence;
}

Evidence judge(const Remainder& remainder, const MatrixXd& columns) {
  return Judge(remainder).evidence(columns);
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
                                           int draws, std::uint64_t seed, int threads) {
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
  // Parts of the groups, each with its own maxima: the largest of them does not depend on order.
  constexpr std::size_t kGroupsAtOnce = 32;
  std::vector<std::vector<double>> parts((groups.size() + kGroupsAtOnce - 1) / kGroupsAtOnce);
  parallel_for(parts.size(), threads, [&](std::size_t part) {
    std::vector<double>& at = parts[part];
    at.assign(static_cast<std::size_t>(draws), 0.0);
    const std::size_t end = std::min(groups.size(), (part + 1) * kGroupsAtOnce);
    for (std::size_t g = part * kGroupsAtOnce; g < end; ++g) {
      if (!groups[g].usable) continue;
      const StatisticOfSigns statistic(groups[g]);
      const EvidenceScale& scale = scales.at(groups[g].block_scores.cols());
      const MatrixXd sums = signs * statistic.features();
      for (Index draw = 0; draw < draws; ++draw) {
        double& most = at[static_cast<std::size_t>(draw)];
        most = std::max(most, scale(statistic(sums.row(draw))));
      }
    }
  });
  std::vector<double> largest(static_cast<std::size_t>(draws), 0.0);
  for (const std::vector<double>& part : parts) {
    for (std::size_t i = 0; i < part.size(); ++i) largest[i] = std::max(largest[i], part[i]);
  }
  return largest;
}

double p_among(const std::vector<double>& null, double value) {
  const auto first = std::lower_bound(null.begin(), null.end(), value);
  const auto reached = static_cast<double>(null.end() - first);
  return (1 + reached) / (1 + static_cast<double>(null.size()));
}

}  // namespace offnominal::desk
