#include "analysis/normal_equations.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/QR>
#include <random>

#include "support/seed.hpp"

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using namespace offnominal::tools;
using ::testing::ElementsAre;

MatrixXd random_matrix(Index rows, Index columns, std::mt19937_64& generator) {
  std::normal_distribution<double> normal;
  return MatrixXd::NullaryExpr(rows, columns, [&] { return normal(generator); });
}
NormalEquations of(const MatrixXd& columns, const VectorXd& target) {
  return {{{0, columns, target}}, std::vector<int>(static_cast<std::size_t>(target.size()), 0), 1};
}
std::vector<UnknownPrior> no_priors(std::size_t count) { return std::vector<UnknownPrior>(count); }

TEST(NormalEquations, SolutionIsThatOfOrthogonalDecomposition) {
  auto generator = offnominal::test::seeded_generator();
  MatrixXd a = random_matrix(300, 5, generator);
  a.col(2) *= 1e6;
  a.col(3) *= 1e-6;
  const VectorXd b = random_matrix(300, 1, generator);
  const LinearSolution solution = solve(of(a, b).sum({1}), no_priors(5));
  const VectorXd expected = a.householderQr().solve(b);
  EXPECT_LT(((solution.x - expected).array() / expected.array()).abs().maxCoeff(), 1e-9);
  EXPECT_NEAR(solution.cost, (b - a * expected).squaredNorm(), 1e-9 * b.squaredNorm());
  const VectorXd norm = a.colwise().norm();
  const MatrixXd unit = a * norm.cwiseInverse().asDiagonal();
  const MatrixXd inverse = norm.asDiagonal() * solution.inverse * norm.asDiagonal();
  EXPECT_LT((inverse * (unit.transpose() * unit) - MatrixXd::Identity(5, 5)).norm(), 1e-10);
  EXPECT_TRUE(solution.ambiguities.empty());
}

TEST(NormalEquations, GroupsAndJointsAddUp) {
  auto generator = offnominal::test::seeded_generator();
  const MatrixXd a = random_matrix(60, 3, generator);
  const VectorXd b = random_matrix(60, 1, generator);
  std::vector<int> group_of(60);
  for (std::size_t i = 0; i < 60; ++i) group_of[i] = i < 20 ? 0 : i < 25 ? -1 : i < 40 ? 1 : 2;
  const NormalEquations equations({{0, a, b}, {1, 2 * a, b}}, group_of, 3);
  EXPECT_EQ(equations.samples(0), 20);
  EXPECT_EQ(equations.samples(1), 15);
  MatrixXd ab(60, 4);
  ab << a, b;
  const MatrixXd first = ab.topRows(20);
  EXPECT_LT((equations.products(0, 0) - first.transpose() * first).norm(), 1e-12);
  MatrixXd a2b(60, 4);
  a2b << 2 * a, b;
  const MatrixXd last = ab.bottomRows(20);
  const MatrixXd last2 = a2b.bottomRows(20);
  const MatrixXd middle = ab.middleRows(25, 15);
  const MatrixXd middle2 = a2b.middleRows(25, 15);
  const MatrixXd expected = 3 * (last.transpose() * last + middle.transpose() * middle) +
                            5 * (last2.transpose() * last2 + middle2.transpose() * middle2);
  EXPECT_LT((equations.sum({3, 5}, 0) - expected).norm(), 1e-10);
  const VectorXd x = VectorXd::Constant(3, 0.4);
  EXPECT_NEAR(squared_error(equations.products(2, 0), x),
              (b.tail(20) - a.bottomRows(20) * x).squaredNorm(), 1e-11);
}

TEST(NormalEquations, PriorPullsTowardsTheStart) {
  const MatrixXd a = VectorXd::Ones(4);
  const VectorXd b = VectorXd::Constant(4, 3);
  const LinearSolution solution = solve(of(a, b).sum({1}), {{1, 12, false}});
  EXPECT_NEAR(solution.x[0], (4 * 3 + 12 * 1) / 16.0, 1e-12);
  EXPECT_NEAR(solution.cost, 4 * 1.5 * 1.5 + 12 * 0.5 * 0.5, 1e-12);
}

TEST(NormalEquations, GivenTwoLikeColumnsThenTheNewOneStaysAtItsStart) {
  auto generator = offnominal::test::seeded_generator();
  MatrixXd a = random_matrix(200, 3, generator);
  a.col(1) = 2 * a.col(0) + 0.01 * random_matrix(200, 1, generator);
  const VectorXd b = 4 * a.col(0) + 7 * a.col(2);
  auto priors = no_priors(3);
  priors[0].gives_way = true;
  const LinearSolution solution = solve(of(a, b).sum({1}), priors);
  EXPECT_EQ(solution.x[0], 0);
  EXPECT_NEAR(solution.x[1], 2, 0.01);
  EXPECT_NEAR(solution.x[2], 7, 0.01);
  ASSERT_EQ(solution.ambiguities.size(), 1U);
  EXPECT_EQ(solution.ambiguities[0].fixed, 0U);
  EXPECT_THAT(solution.ambiguities[0].others, ElementsAre(1));
  EXPECT_THAT(solution.is_fixed, ElementsAre(true, false, false));
  EXPECT_EQ(solution.inverse.row(0).norm(), 0);

  priors[0].gives_way = false;
  priors[1].start = 5;
  const LinearSolution other = solve(of(a, b).sum({1}), priors);
  EXPECT_EQ(other.x[1], 5) << "the last one gives way where none is new";
  EXPECT_NEAR(other.x[0], 4 - 2 * 5, 0.05);
}

TEST(NormalEquations, GivenAPriorThenLikeColumnsAreToldApart) {
  auto generator = offnominal::test::seeded_generator();
  MatrixXd a = random_matrix(200, 2, generator);
  a.col(1) = a.col(0);
  const VectorXd b = 3 * a.col(0);
  auto priors = no_priors(2);
  priors[1] = {1, 1e4, false};
  const LinearSolution solution = solve(of(a, b).sum({1}), priors);
  EXPECT_TRUE(solution.ambiguities.empty());
  EXPECT_NEAR(solution.x[0], 2, 1e-9);
  EXPECT_NEAR(solution.x[1], 1, 1e-9);
}

TEST(NormalEquations, ColumnsAtTenDegreesAreToldApartAtTwoTheyAreNot) {
  const auto ambiguous = [](double degrees) {
    MatrixXd a = MatrixXd::Zero(2, 2);
    a.col(0) << 1, 0;
    a.col(1) << std::cos(degrees * 0.017453292519943295), std::sin(degrees * 0.017453292519943295);
    return !solve(of(a, VectorXd::Ones(2)).sum({1}), no_priors(2)).ambiguities.empty();
  };
  EXPECT_FALSE(ambiguous(10));
  EXPECT_FALSE(ambiguous(170));
  EXPECT_TRUE(ambiguous(2));
  EXPECT_TRUE(ambiguous(178));
}

TEST(NormalEquations, ColumnOfZerosStaysAtItsStart) {
  auto generator = offnominal::test::seeded_generator();
  MatrixXd a = random_matrix(50, 2, generator);
  a.col(1).setZero();
  auto priors = no_priors(2);
  priors[1].start = 9;
  const LinearSolution solution = solve(of(a, VectorXd::Ones(50)).sum({1}), priors);
  EXPECT_EQ(solution.x[1], 9);
  ASSERT_EQ(solution.ambiguities.size(), 1U);
  EXPECT_TRUE(solution.ambiguities[0].others.empty());
}

}  // namespace
