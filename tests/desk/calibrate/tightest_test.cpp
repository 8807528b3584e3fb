#include "calibrate/tightest.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "common/error.hpp"
#include "support/repetitions.hpp"
#include "support/seed.hpp"

// The linear programme of the tightest threshold against every vertex there is.

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using namespace offnominal::desk;

ThresholdRows part_of(const MatrixXd& rows, const VectorXd& error) {
  ThresholdRows part;
  part.filtered = rows;
  part.demands = {{{}, error}};
  return part;
}

VectorXd cheapest(const ThresholdRows& part, const VectorXd& lowest) {
  return tightest({part}, lowest, VectorXd::Ones(lowest.size()));
}

TEST(Tightest, OfOneNumberIsTheLargestRatio) {
  const MatrixXd rows = VectorXd::LinSpaced(1000, 1, 3);
  const VectorXd error = (VectorXd::LinSpaced(1000, 0, 20).array().sin() + 1.5).matrix();
  const VectorXd c = cheapest(part_of(rows, error), VectorXd::Zero(rows.cols()));
  const double largest = (error.array() / rows.col(0).array()).maxCoeff();
  EXPECT_NEAR(c[0], largest, 1e-5 * largest);
  EXPECT_GE(c[0], largest * (1 - 1e-12));
}

TEST(Tightest, StaysAtTheLowestWhereThatIsEnough) {
  const MatrixXd rows = MatrixXd::Ones(10, 2);
  const VectorXd lowest = VectorXd::Constant(2, 3);
  EXPECT_EQ(cheapest(part_of(rows, VectorXd::Ones(10)), lowest), lowest);
  EXPECT_EQ(cheapest(part_of(rows, VectorXd::Zero(10)), lowest), lowest);
}

// Least cost over all points where two of the constraints, rows or axes, meet.
double best_vertex(const MatrixXd& rows, const VectorXd& error, const VectorXd& cost) {
  MatrixXd all(rows.rows() + 2, 2);
  all << rows, MatrixXd::Identity(2, 2);
  VectorXd at_least = VectorXd::Zero(error.size() + 2);
  at_least.head(error.size()) = error;
  double best = std::numeric_limits<double>::infinity();
  for (Index i = 0; i < all.rows(); ++i) {
    for (Index j = 0; j < i; ++j) {
      Eigen::Matrix2d pair;
      pair << all.row(i), all.row(j);
      if (std::abs(pair.determinant()) < 1e-12) continue;
      const Eigen::Vector2d c = pair.inverse() * Eigen::Vector2d(at_least[i], at_least[j]);
      if ((all * c - at_least).minCoeff() < -1e-9) continue;
      best = std::min(best, cost.dot(c));
    }
  }
  return best;
}

TEST(Tightest, OfTwoNumbersIsTheBestVertex) {
  auto generator = offnominal::test::seeded_generator();
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int run = 0; run < offnominal::test::repetitions(50); ++run) {
    const double unit = std::pow(10.0, 8 * uniform(generator) - 4);
    const MatrixXd rows = MatrixXd::NullaryExpr(60, 2, [&] { return uniform(generator); });
    const VectorXd error = unit * VectorXd::NullaryExpr(60, [&] { return uniform(generator); });
    const VectorXd c = cheapest(part_of(rows, error), VectorXd::Zero(rows.cols()));
    EXPECT_GE((rows * c - error).minCoeff(), -1e-12 * unit) << run;
    const VectorXd cost = rows.colwise().mean();
    const double best = best_vertex(rows, error, cost);
    EXPECT_NEAR(cost.dot(c), best, 3e-6 * best) << run;
  }
}

// Whether a cheaper point than c is allowed: none is where the cost is a sum of active constraints'
// normals, each times a number that is not negative.
bool is_optimal(const MatrixXd& rows, const VectorXd& error, const VectorXd& lowest,
                const VectorXd& highest, const VectorXd& cost, const VectorXd& c) {
  constexpr double kActive = 1e-5;
  constexpr double kOff = 1e-3;  // of cost: the solver is done before the last digit
  const Index n = c.size();
  std::vector<VectorXd> normals;
  for (Index i = 0; i < rows.rows(); ++i) {
    if (rows.row(i).dot(c) < error[i] * (1 + kActive)) normals.emplace_back(rows.row(i));
  }
  for (Index k = 0; k < n; ++k) {
    if (c[k] < lowest[k] * (1 + kActive)) normals.emplace_back(VectorXd::Unit(n, k));
    if (c[k] > highest[k] * (1 - kActive)) normals.emplace_back(-VectorXd::Unit(n, k));
  }
  const std::size_t count = normals.size();
  if (count < static_cast<std::size_t>(n)) return false;
  std::vector<bool> taken(count, false);
  std::fill(taken.begin(), taken.begin() + n, true);
  do {
    MatrixXd some(n, n);
    Index column = 0;
    for (std::size_t i = 0; i < count; ++i) {
      if (taken[i]) some.col(column++) = normals[i];
    }
    const Eigen::FullPivLU<MatrixXd> lu(some);
    if (lu.isInvertible() && lu.solve(cost).minCoeff() > -kOff) return true;
  } while (std::prev_permutation(taken.begin(), taken.end()));
  return false;
}

// A joint that stands and moves in turns: its speed, and the torque beside the model, large where
// it stands.
struct StopAndGo {
  VectorXd speed;
  VectorXd unknown;
};
StopAndGo stop_and_go(Index rows, std::mt19937_64& generator) {
  std::uniform_real_distribution<double> uniform(0, 1);
  StopAndGo joint{VectorXd::Zero(rows), VectorXd::Zero(rows)};
  for (Index at = 0; at < rows;) {
    const Index moves = std::min(at + static_cast<Index>(50 + 300 * uniform(generator)), rows);
    const Index stands = std::min(moves + static_cast<Index>(100 + 400 * uniform(generator)), rows);
    joint.unknown.segment(at, moves - at).setConstant(0.1 + 2 * std::pow(uniform(generator), 3));
    const double peak = 0.2 + 2 * std::pow(uniform(generator), 2);
    const double off = 0.3 * uniform(generator);
    const double share = 0.1 * uniform(generator);
    for (Index i = moves; i < stands; ++i) {
      const double part = static_cast<double>(i - moves) / static_cast<double>(stands - moves);
      joint.speed[i] = peak * std::pow(std::sin(3.14159 * part), 2);
      joint.unknown[i] = off + share * joint.speed[i] * joint.speed[i];
    }
    at = stands;
  }
  return joint;
}

// What a table over the speed, its points at `at`, asks for: a filter's answer to where the joint
// was, and to the torque.
ThresholdRows table_rows(const StopAndGo& joint, const VectorXd& at) {
  constexpr double kShare = 0.01;
  MatrixXd rows(joint.speed.size(), at.size());
  VectorXd error(joint.speed.size());
  VectorXd filtered = VectorXd::Unit(at.size(), 0);
  double filtered_error = 0;
  for (Index i = 0; i < rows.rows(); ++i) {
    const double speed = joint.speed[i];
    Index below = 0;
    while (below + 2 < at.size() && speed > at[below + 1]) ++below;
    const double part = std::min(1.0, (speed - at[below]) / (at[below + 1] - at[below]));
    filtered *= 1 - kShare;
    filtered[below] += kShare * (1 - part);
    filtered[below + 1] += kShare * part;
    rows.row(i) = filtered;
    filtered_error += kShare * (joint.unknown[i] - filtered_error);
    error[i] = filtered_error;
  }
  return part_of(rows, error);
}

// GIVEN many recordings, so that rows come to the programme in rounds of hundreds, WHEN each number
// is held between a lowest and a highest THEN what comes is the optimum.
TEST(Tightest, OfATableWithLimitsIsTheOptimum) {
  auto generator = offnominal::test::seeded_generator();
  const VectorXd at = (VectorXd(6) << 0, 0.1, 0.25, 0.5, 0.9, 2.2).finished();
  for (int run = 0; run < offnominal::test::repetitions(60); ++run) {
    std::vector<ThresholdRows> parts;
    for (int i = 0; i < 11; ++i) parts.push_back(table_rows(stop_and_go(4000, generator), at));
    MatrixXd rows(0, at.size());
    VectorXd error(0);
    for (const ThresholdRows& part : parts) {
      rows.conservativeResize(rows.rows() + part.size(), Eigen::NoChange);
      rows.bottomRows(part.size()) = part.filtered;
      error.conservativeResize(rows.rows());
      error.tail(part.size()) = part.demands.front().error;
    }
    const double constant = error.maxCoeff();
    const VectorXd lowest = VectorXd::Constant(at.size(), 0.1 * constant);
    const VectorXd highest = VectorXd::Constant(at.size(), 3 * constant);
    const VectorXd c =
        tightest({parts.begin(), parts.end()}, lowest, VectorXd::Ones(at.size()), highest);
    EXPECT_GE((rows * c - error).minCoeff(), -1e-5 * constant) << run;
    EXPECT_TRUE(is_optimal(rows, error, lowest, highest, rows.colwise().mean(), c))
        << run << ": " << c.transpose();
  }
}

// A run that starts late has of the first column only what came since.
TEST(Tightest, ARunThatStartsLaterIsCoveredToo) {
  const StartBefore start{2, 0.25};
  ThresholdRows part;
  part.filtered = MatrixXd::Constant(6, 1, 2);
  part.history = 1;
  part.constant = 0.5;
  const VectorXd along = part.along(Eigen::Vector2d(3, 4));
  EXPECT_EQ(part.threshold({}, along, Eigen::Vector2d(3, 4)), VectorXd::Constant(5, 8));
  VectorXd late = VectorXd::Constant(5, 6 - 0.25 * 6 + 0.5 * 4);
  late[0] = 0;
  EXPECT_EQ(part.threshold(start, along, Eigen::Vector2d(3, 4)), late) << "from row 1 on";
  EXPECT_EQ(part.row(start, 1), Eigen::Vector2d(1.5, 0.5));
  part.demands = {{{}, VectorXd::Ones(5)}, {start, VectorXd::Constant(5, 3)}};
  part.demands[1].error[0] = 0;
  const VectorXd c = tightest({part}, VectorXd::Zero(2), Eigen::Vector2d(1, 10));
  EXPECT_NEAR(c[0], 2, 1e-5) << "what the late start asks for";
  EXPECT_NEAR(c[1], 0, 1e-5);
}

TEST(Tightest, AThresholdThatStartsAtItsLargestFadesFromThere) {
  ThresholdRows part;
  part.filtered = MatrixXd::Ones(3, 2);
  part.starts_at_largest = true;
  const Eigen::Vector2d c(1, 3);
  EXPECT_EQ(part.threshold({}, part.along(c), c), VectorXd::Constant(3, 4));
  const VectorXd late = part.threshold({1, 0.5}, part.along(c), c);
  EXPECT_EQ(late, Eigen::Vector3d(0, 4 - 0.5 * 4 + 0.5 * 3, 4 - 0.5 * 4 + 0.5 * 3));
}

TEST(Tightest, GoesNoHigherThanIsAllowed) {
  MatrixXd rows(2, 2);
  rows << 1, 0.001, 0, 1;
  const ThresholdRows part = part_of(rows, Eigen::Vector2d(1, 1));
  const VectorXd free = tightest({part}, VectorXd::Zero(2), Eigen::Vector2d(100, 0.01));
  EXPECT_GT(free[1], 100) << "the first is dear";
  const VectorXd held =
      tightest({part}, VectorXd::Zero(2), Eigen::Vector2d(100, 0.01), Eigen::Vector2d(2, 5));
  EXPECT_LE(held[1], 5 + 1e-4);
  EXPECT_GE((rows * held - Eigen::Vector2d(1, 1)).minCoeff(), -1e-12);
}

TEST(Tightest, OfTwoEqualColumnsTheCheaperIsUsed) {
  const Eigen::MatrixX2d rows = Eigen::MatrixX2d::Ones(5, 2);
  const ThresholdRows part = part_of(rows, VectorXd::Ones(5));
  const VectorXd c = tightest({part}, VectorXd::Zero(2), Eigen::Vector2d(1.5, 1));
  EXPECT_NEAR(c[0], 0, 1e-5);
  EXPECT_NEAR(c[1], 1, 1e-5);
}

TEST(Tightest, RefusesAnErrorThatNothingReaches) {
  MatrixXd rows = MatrixXd::Ones(3, 1);
  rows(1, 0) = 0;
  EXPECT_THROW(
      static_cast<void>(cheapest(part_of(rows, VectorXd::Ones(3)), VectorXd::Zero(rows.cols()))),
      InputError);
}

}  // namespace
