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

TEST(BoxedLeastSquares, WithoutBoxesItIsLeastSquares) {
  auto generator = test::seeded_generator();
  std::normal_distribution<double> normal;
  const MatrixXd columns = MatrixXd::NullaryExpr(50, 3, [&] { return normal(generator); });
  const VectorXd target = VectorXd::NullaryExpr(50, [&] { return normal(generator); });
  const BoxedFit fit = boxed_least_squares(columns, target, std::vector<Box>(3));
  EXPECT_LT((columns.transpose() * fit.residual).norm(), 1e-10);
  EXPECT_EQ(fit.basis.cols(), 3);
  EXPECT_LT((fit.basis.transpose() * fit.basis - MatrixXd::Identity(3, 3)).norm(), 1e-12);
}

TEST(BoxedLeastSquares, AnUnknownStaysInItsBoxAndGivesUpItsColumn) {
  MatrixXd columns(3, 2);
  columns << 1, 0, 0, 1, 0, 0;
  const VectorXd target = Eigen::Vector3d(5, 2, 1);
  const BoxedFit fit = boxed_least_squares(columns, target, {{-1, 1}, {}});
  EXPECT_EQ(fit.x[0], 1);
  EXPECT_TRUE(fit.at_bound[0]);
  EXPECT_NEAR(fit.x[1], 2, 1e-12);
  EXPECT_EQ(fit.basis.cols(), 1);
  EXPECT_NEAR(fit.residual[0], 4, 1e-12);
}

TEST(BoxedLeastSquares, EqualColumnsDoNotSpoilTheSolution) {
  MatrixXd columns(4, 2);
  columns << 1, 1, 2, 2, 3, 3, 4, 4;
  const VectorXd target = 2 * columns.col(0);
  const BoxedFit fit = boxed_least_squares(columns, target, std::vector<Box>(2));
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
