#include "common/nearest.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace offnominal::desk {
namespace {

const std::vector<std::string> kWords{"mass_kg", "centre_of_mass_m", "inertia_kg_m2"};

TEST(Nearest, FindsTheWordThatWasMeant) {
  EXPECT_EQ(nearest("mas_kg", kWords), "mass_kg");
  EXPECT_EQ(nearest("MASS_KG", kWords), "mass_kg");
  EXPECT_EQ(nearest("center_of_mass_m", kWords), "centre_of_mass_m");
  EXPECT_EQ(nearest("inertia", kWords), "");
}

TEST(Nearest, TakesTheNearerOfTwo) {
  const std::vector<std::string> words{"value", "values"};
  EXPECT_EQ(nearest("values", words), "values");
  EXPECT_EQ(nearest("valu", words), "value");
}

TEST(Nearest, GuessesNothingFarFetched) {
  EXPECT_EQ(nearest("colour", kWords), "");
  EXPECT_EQ(nearest("x", {}), "");
  const std::vector<std::string> short_words{"kp", "type"};
  EXPECT_EQ(nearest("xy", short_words), "");
  EXPECT_EQ(nearest("tpye", short_words), "type");
}

TEST(ListOf, SeparatesWithCommas) {
  EXPECT_EQ(list_of(kWords), "mass_kg, centre_of_mass_m, inertia_kg_m2");
  EXPECT_EQ(list_of({}), "");
}

TEST(ListOf, TakesAnythingThatHasText) {
  const std::vector<int> numbers{1, 22};
  EXPECT_EQ(list_of(numbers, [](int number) { return std::to_string(number); }), "1, 22");
}

TEST(ChoiceOf, HasOrBeforeTheLast) {
  EXPECT_EQ(choice_of(kWords), "mass_kg, centre_of_mass_m or inertia_kg_m2");
  EXPECT_EQ(choice_of(std::span(kWords).first(1)), "mass_kg");
  EXPECT_EQ(choice_of({}), "");
}

}  // namespace
}  // namespace offnominal::desk
