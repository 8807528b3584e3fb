#include "robot/text_with_estimator.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

// Changing [estimator] in a robot file, line by line.

namespace offnominal::desk {
namespace {

const std::vector<EstimatorLine> kChanged = {{"alpha_per_s", "20.0", "tried"}, {"seed", "7", ""}};

TEST(TextWithEstimator, ReplacesALineAndAddsTheOtherBehindTheLast) {
  const std::string old =
      "name = \"r\"  # mine\n\n[estimator]\n# on the pole\nalpha_per_s = 10.0 # old\nhidden_units "
      "= 4\n\n"
      "# of the bound\n[uncertainty_bound]\nkind = \"constant\"\n";
  EXPECT_EQ(text_with_estimator(old, kChanged).value_or("none"),
            "name = \"r\"  # mine\n\n[estimator]\n# on the pole\nalpha_per_s = 20.0  # tried\n"
            "hidden_units = 4\nseed = 7\n\n# of the bound\n[uncertainty_bound]\nkind = "
            "\"constant\"\n");
}

TEST(TextWithEstimator, GivenNoTableThenItFollowsTheLastLine) {
  EXPECT_EQ(text_with_estimator("a = 1\n", kChanged).value_or("none"),
            "a = 1\n\n[estimator]\nalpha_per_s = 20.0  # tried\nseed = 7\n");
}

TEST(TextWithEstimator, KeepsTheEndsOfLines) {
  EXPECT_EQ(
      text_with_estimator("[estimator]\r\nseed = 1\r\n", {{"seed", "2", ""}}).value_or("none"),
      "[estimator]\r\nseed = 2\r\n");
}

TEST(TextWithEstimator, IsNoneWhereLinesDoNotHoldIt) {
  EXPECT_FALSE(text_with_estimator("estimator = {seed = 1}\n", kChanged));
  EXPECT_FALSE(text_with_estimator("estimator.seed = 1\n", kChanged));
  EXPECT_FALSE(text_with_estimator("[estimator\n", kChanged));
}

}  // namespace
}  // namespace offnominal::desk
