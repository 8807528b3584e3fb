#include "identify/few_rows.hpp"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "identify/fit.hpp"
#include "support/seed.hpp"

namespace offnominal::desk {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index kSamples = 6000;
constexpr Index kJoints = 3;

// Two recordings of three joints, the second a third as long. Column 0 acts on all joints, 1 to 3
// on one each, 4 on the last two, 5 on none.
struct Given {
  RowLayout layout;
  MatrixXd columns;
  VectorXd target;
  std::vector<char> rows;
};

RowLayout layout_of_two() {
  std::vector<Workspace> recordings(2);
  for (const Index r : {0, 1}) {
    const Index samples = r == 0 ? kSamples : kSamples / 3;
    Workspace& at = recordings[static_cast<std::size_t>(r)];
    at.plan.sample_rate_hz = 10;
    at.motion.t_s = VectorXd::LinSpaced(samples, 0, static_cast<double>(samples - 1) / 10);
    at.motion.q = MatrixXd::Zero(samples, kJoints);
  }
  return RowLayout(recordings);
}

Given given() {
  Given made{layout_of_two(), {}, {}, {}};
  auto generator = test::seeded_generator();
  std::normal_distribution<double> normal;
  const auto noise = [&] { return normal(generator); };
  made.columns = MatrixXd::NullaryExpr(made.layout.rows(), 6, noise);
  made.target = VectorXd::NullaryExpr(made.layout.rows(), noise);
  made.rows.assign(static_cast<std::size_t>(made.layout.rows()), 1);
  for (std::size_t r = 0; r < 2; ++r) {
    for (Index joint = 0; joint < kJoints; ++joint) {
      auto part = made.columns.middleRows(made.layout.begin(r, joint), made.layout.samples(r));
      for (const Index other : {0, 1, 2}) {
        if (other != joint) part.col(1 + other).setZero();
      }
      if (joint == 0) part.col(4).setZero();
      part.col(5).setZero();
    }
  }
  for (std::size_t i = 0; i < made.rows.size(); i += 7) made.rows[i] = 0;
  return made;
}

TEST(FewRowsOfJoints, FitAsAllRowsDoWithAnyWeightPerJointAndAnyRowsLeftOut) {
  Given at = given();
  const std::vector<Prior> priors{{0, 0.1}, {}, {0, 1, -0.01, 0.01}, {}, {}, {0, 1}};
  for (const bool all : {true, false}) {
    const std::vector<char> rows = all ? std::vector<char>{} : at.rows;
    if (!all) at.layout.leave_out(std::vector<char>(at.rows.size() / 2, 0));
    const FewRowsOfJoints few(at.layout, at.columns, at.target, rows);
    for (const VectorXd& weights :
         {VectorXd(Eigen::Vector3d(1, 1, 1)), VectorXd(Eigen::Vector3d(0.1, 20, 3))}) {
      VectorXd of_rows = at.layout.weighted(VectorXd::Ones(at.layout.rows()), weights);
      for (std::size_t i = 0; i < rows.size(); ++i) {
        if (rows[i] == 0) of_rows[static_cast<Index>(i)] = 0;
      }
      const PriorFit whole = least_squares_with_priors(
          of_rows.asDiagonal() * at.columns, of_rows.cwiseProduct(at.target), priors, 1.5);
      const RegressionRows weighted = few.weighted(weights);
      EXPECT_LE(weighted.target.size(), 3 * 7);
      const PriorFit fit =
          least_squares_with_priors(weighted.columns, weighted.target, priors, 1.5);
      EXPECT_LT((fit.x - whole.x).norm(), 1e-9);
      EXPECT_NEAR(fit.residual.norm(), whole.residual.norm(), 1e-9 * whole.residual.norm());
      EXPECT_LT((fit.residual.tail(3) - whole.residual.tail(3)).norm(), 1e-9) << "the priors' rows";
    }
  }
}

// GIVEN stretches that are all at fault, so that no row says anything, THEN there still is a block
// that all of them are of: sums over blocks have somewhere to go.
TEST(Blocks, AreOneWhereNoRowSaysAnything) {
  RowLayout layout = layout_of_two();
  layout.leave_out(std::vector<char>(static_cast<std::size_t>(layout.rows()), 0));
  const RowLayout::Blocks blocks = layout.blocks(0.5);
  EXPECT_EQ(blocks.count, 1);
  for (const int block : blocks.of_row) EXPECT_EQ(block, 0);
}

}  // namespace
}  // namespace offnominal::desk
