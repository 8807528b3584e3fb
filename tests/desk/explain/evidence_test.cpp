#include "identify/evidence.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include "identify/fit.hpp"
#include "support/seed.hpp"

namespace offnominal::desk {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

TEST(LeastSquaresWithPriors, WithoutPriorsItIsLeastSquares) {
  auto generator = test::seeded_generator();
  std::normal_distribution<double> normal;
  const MatrixXd columns = MatrixXd::NullaryExpr(50, 3, [&] { return normal(generator); });
  const VectorXd target = VectorXd::NullaryExpr(50, [&] { return normal(generator); });
  const PriorFit fit = least_squares_with_priors(columns, target, std::vector<Prior>(3), 1);
  EXPECT_LT((columns.transpose() * fit.residual).norm(), 1e-10);
  EXPECT_EQ(fit.basis.cols(), 3);
  EXPECT_LT((fit.basis.transpose() * fit.basis - MatrixXd::Identity(3, 3)).norm(), 1e-12);
}

TEST(LeastSquaresWithPriors, AnUnknownStaysBetweenItsEndsAndGivesUpItsColumn) {
  MatrixXd columns(3, 2);
  columns << 1, 0, 0, 1, 0, 0;
  const VectorXd target = Eigen::Vector3d(5, 2, 1);
  const PriorFit fit = least_squares_with_priors(columns, target, {{.low = -1, .high = 1}, {}}, 1);
  EXPECT_EQ(fit.x[0], 1);
  EXPECT_NEAR(fit.x[1], 2, 1e-12);
  EXPECT_EQ(fit.basis.cols(), 1);
  EXPECT_NEAR(fit.residual[0], 4, 1e-12);
}

TEST(LeastSquaresWithPriors, APriorCountsAsOneMoreObservation) {
  // One unknown seen by four rows with errors of size 1 as 3, believed to be 0 +- 0.5: the mean of
  // both, by the inverse of their variances, 1/4 and 1/4.
  const MatrixXd columns = MatrixXd::Ones(4, 1);
  const VectorXd target = VectorXd::Constant(4, 3);
  const PriorFit fit = least_squares_with_priors(columns, target, {Prior{.deviation = 0.5}}, 1);
  EXPECT_NEAR(fit.x[0], 1.5, 1e-12);
  ASSERT_EQ(fit.residual.size(), 5);
  EXPECT_NEAR(fit.residual[4], -1.5 / 0.5, 1e-12);
  EXPECT_LT((fit.basis.transpose() * fit.residual).norm(), 1e-12);
  // About another mean.
  const PriorFit about = least_squares_with_priors(columns, target, {Prior{1, 0.5}}, 1);
  EXPECT_NEAR(about.x[0], 2, 1e-12);
  // Where four rows are one independent observation, the belief weighs four times as much.
  const PriorFit firm = least_squares_with_priors(columns, target, {Prior{.deviation = 0.5}}, 2);
  EXPECT_NEAR(firm.x[0], 3.0 / 5, 1e-12);
}

TEST(LeastSquaresWithPriors, EqualColumnsDoNotSpoilTheSolution) {
  MatrixXd columns(4, 2);
  columns << 1, 1, 2, 2, 3, 3, 4, 4;
  const VectorXd target = 2 * columns.col(0);
  const PriorFit fit = least_squares_with_priors(columns, target, std::vector<Prior>(2), 1);
  EXPECT_LT(fit.residual.norm(), 1e-10);
  EXPECT_EQ(fit.basis.cols(), 1);
}

// Two joints of one recording, 40 samples each, and a basis that they share.
class TwoJoints : public ::testing::Test {
 protected:
  TwoJoints() {
    Workspace at;
    at.plan.sample_rate_hz = 10;
    at.motion.t_s = VectorXd::LinSpaced(40, 0, 3.9);
    at.motion.q = MatrixXd::Zero(40, 2);
    layout_ = std::make_unique<RowLayout>(std::vector<Workspace>{at});
    auto generator = test::seeded_generator();
    std::normal_distribution<double> normal;
    const auto noise = [&] { return normal(generator); };
    common_ = MatrixXd::NullaryExpr(80, 3, noise);
    const VectorXd target = VectorXd::NullaryExpr(80, noise);
    const PriorFit fit = least_squares_with_priors(common_, target, std::vector<Prior>(3), 1);
    remainder_.layout = layout_.get();
    remainder_.blocks = layout_->blocks(0.5);
    remainder_.joint_weights = VectorXd::Ones(2);
    remainder_.residual = fit.residual;
    remainder_.basis = Basis(fit.basis);
    remainder_.energy = layout_->energy(fit.residual);
    remainder_.independent_samples = VectorXd::Constant(2, 40);
    column_ = MatrixXd::Zero(80, 2);
    column_.bottomRows(40) = MatrixXd::NullaryExpr(40, 2, noise);
  }

  std::unique_ptr<RowLayout> layout_;
  MatrixXd common_, column_;
  Remainder remainder_;
};

// Only the rows where a column acts are looked at; what comes out is that of the whole regression.
TEST_F(TwoJoints, EvidenceOfAColumnOnOneJointIsThatOfTheWholeRegression) {
  MatrixXd both(80, 5);
  both << common_, column_;
  const VectorXd left =
      least_squares_with_priors(both, remainder_.residual, std::vector<Prior>(5), 1).residual;
  const ActingColumns acting(*layout_, column_);
  ASSERT_EQ(acting.spans().size(), 1U);
  EXPECT_EQ(acting.spans()[0].joint, 1);
  const Judge judge(remainder_);
  const Evidence evidence = judge.evidence(acting);
  ASSERT_TRUE(evidence.usable);
  const VectorXd energy = layout_->energy(left);
  EXPECT_NEAR(evidence.gain, 1 - left.squaredNorm() / remainder_.residual.squaredNorm(), 1e-10);
  EXPECT_NEAR(judge.gain(column_), evidence.gain, 1e-12);
  EXPECT_NEAR(evidence.joint_gain, (1 - energy.cwiseQuotient(remainder_.energy).array()).maxCoeff(),
              1e-10);
  EXPECT_NEAR(judge.joint_gain(acting), evidence.joint_gain, 1e-12);
}

TEST_F(TwoJoints, AColumnThatTheBasisHasSaysNothing) {
  const Judge judge(remainder_);
  EXPECT_FALSE(judge.evidence(common_.leftCols(1).eval()).usable);
  EXPECT_LT(judge.gain(common_.leftCols(1)), 0);
}

TEST_F(TwoJoints, TheNullOfASearchIsThatOfAnyNumberOfThreads) {
  const Judge judge(remainder_);
  const std::vector<Evidence> groups(70, judge.evidence(column_));
  const int blocks = remainder_.blocks.count;
  EXPECT_EQ(largest_without_effect(groups, blocks, 99, 3, 1),
            largest_without_effect(groups, blocks, 99, 3, 4));
}

TEST(Evidence, PFallsWithTheStatisticAndIsOneWithoutAny) {
  EXPECT_EQ(p_of_statistic(0, 1, 30), 1);
  EXPECT_EQ(p_of_statistic(30, 1, 30), 0);
  double last = 1;
  for (double t = 1; t < 30; t += 1) {
    const double p = p_of_statistic(t, 2, 30);
    EXPECT_LT(p, last);
    last = p;
  }
}

TEST(Evidence, PAmongCountsWhatIsReached) {
  const std::vector<double> null{1, 2, 3, 4};
  EXPECT_DOUBLE_EQ(p_among(null, 5), 1.0 / 5);
  EXPECT_DOUBLE_EQ(p_among(null, 4), 2.0 / 5);
  EXPECT_DOUBLE_EQ(p_among(null, 0), 1);
}

}  // namespace
}  // namespace offnominal::desk
