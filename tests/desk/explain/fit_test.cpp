#include "identify/fit.hpp"

#include <gtest/gtest.h>

#include <random>

#include "support/repetitions.hpp"
#include "support/seed.hpp"

namespace offnominal::desk {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

struct RandomProblem {
  MatrixXd columns;
  VectorXd target;
  std::vector<Prior> priors;
};

RandomProblem random_problem(std::mt19937_64& generator) {
  constexpr Index kRows = 200;
  constexpr Index kUnknowns = 9;
  std::normal_distribution<double> normal(0, 1);
  RandomProblem made{MatrixXd(kRows, kUnknowns), VectorXd(kRows), std::vector<Prior>(kUnknowns)};
  for (double& value : made.columns.reshaped()) value = normal(generator);
  made.columns.col(4) += made.columns.col(2);  // what one gives up, the other takes
  VectorXd truth(kUnknowns);
  for (double& value : truth) value = normal(generator);
  made.target = made.columns * truth;
  for (double& value : made.target) value += 0.1 * normal(generator);
  for (std::size_t i = 0; i < 6; ++i) made.priors[i] = {0, 0.3, -0.6, 0.6};
  return made;
}

TEST(LeastSquaresWithPriors, GIVEN_ends_THEN_unknowns_lie_within_and_the_free_ones_fit_best) {
  std::mt19937_64 generator(test::test_seed());
  int held = 0;
  for (int run = 0; run < 2 * test::repetitions(20); ++run) {
    const RandomProblem given = random_problem(generator);
    const PriorFit fit = least_squares_with_priors(given.columns, given.target, given.priors, 1);
    std::vector<Index> free;
    for (Index i = 0; i < fit.x.size(); ++i) {
      const Prior& prior = given.priors[static_cast<std::size_t>(i)];
      EXPECT_GE(fit.x[i], prior.low);
      EXPECT_LE(fit.x[i], prior.high);
      const bool at_end = fit.x[i] == prior.low || fit.x[i] == prior.high;
      held += at_end ? 1 : 0;
      if (!at_end) free.push_back(i);
    }
    EXPECT_EQ(fit.basis.cols(), static_cast<Index>(free.size()));
    const Index rows = given.target.size();
    EXPECT_LT((fit.residual.head(rows) - (given.target - given.columns * fit.x)).norm(), 1e-9);
    EXPECT_LT((fit.basis.transpose() * fit.residual).norm(), 1e-9) << "the free ones fit best";
    EXPECT_LT(
        (fit.basis.transpose() * fit.basis - MatrixXd::Identity(fit.basis.cols(), fit.basis.cols()))
            .norm(),
        1e-9);
  }
  EXPECT_GT(held, 0) << "some must have ended there";
}

TEST(LeastSquaresWithPriors, GIVEN_all_unknowns_beyond_their_ends_THEN_nothing_is_free) {
  const MatrixXd columns = MatrixXd::Identity(3, 2);
  const VectorXd target = VectorXd::Constant(3, 10);
  const std::vector<Prior> priors{{0, 0.5, -1, 1}, {0, 0.5, -1, 1}};
  const PriorFit fit = least_squares_with_priors(columns, target, priors, 0.01);
  EXPECT_EQ(fit.x, VectorXd::Ones(2));
  EXPECT_EQ(fit.basis.cols(), 0);
  EXPECT_NEAR(fit.residual[0], 9, 1e-12);
}

TEST(ProfileFit, LeavesWhatTheWholeRegressionLeaves) {
  std::mt19937_64 generator(test::test_seed());
  std::normal_distribution<double> normal(0, 1);
  for (int run = 0; run < 2 * test::repetitions(20); ++run) {
    const RandomProblem given = random_problem(generator);
    const ProfileFit profile(given.columns, given.target, given.priors, 1);
    // Two more columns, the first of them much like one that is there.
    MatrixXd more(given.columns.rows(), 2);
    for (double& value : more.reshaped()) value = normal(generator);
    more.col(0) = given.columns.col(1) + 0.1 * more.col(0);
    MatrixXd all(given.columns.rows(), given.columns.cols() + 2);
    all << given.columns, more;
    std::vector<Prior> priors = given.priors;
    priors.resize(priors.size() + 2);
    const PriorFit fit = least_squares_with_priors(all, given.target, priors, 1);
    const double whole = fit.residual.squaredNorm();
    EXPECT_NEAR(profile.energy_with(more), whole, 1e-9 * whole);
    EXPECT_LT((profile.unknowns_of(more) - fit.x.tail(2)).norm(), 1e-9);
  }
}

}  // namespace
}  // namespace offnominal::desk
