#include "discovery/evidence.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "discovery/fit.hpp"
#include "support/seed.hpp"

namespace offnominal::tools::discovery {
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
}  // namespace offnominal::tools::discovery
