#include "studio/charts.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "common/refused.hpp"
#include "desk/studio/studio_input.hpp"
#include "desk/support/temporary_folder.hpp"

namespace {

using nlohmann::json;
using offnominal::EffectKind;
using offnominal::test::studio_input;
using offnominal::test::TemporaryFolder;
using ::testing::Contains;
using ::testing::Not;
using namespace offnominal::desk;
using namespace offnominal::desk::studio;

class StudioCharts : public ::testing::Test {
 protected:
  TemporaryFolder folder_;
  Workbench bench_{studio_input(folder_ / "arm.toml", true)};

  static const json& series(const json& charts, std::size_t chart, std::size_t at) {
    return charts.at(chart).at("series").at(at);
  }
};

TEST_F(StudioCharts, KeepPeaksAndShowMoreOfWhatIsZoomed) {
  constexpr std::size_t kPixels = 100;
  View view{.joint = 1, .pixels = kPixels};
  const json whole = charts_of(bench_, bench_.now(), view);
  ASSERT_EQ(whole.size(), 4U);
  const auto y = series(whole, 0, 0).at("y").get<std::vector<double>>();
  const Eigen::VectorXd measured = bench_.now().fitted.recordings[0].measured.col(1);
  EXPECT_LE(y.size(), 2 * kPixels);
  EXPECT_LT(y.size(), static_cast<std::size_t>(measured.size()));
  EXPECT_NEAR(*std::max_element(y.begin(), y.end()), measured.maxCoeff(), 1e-5);
  EXPECT_NEAR(*std::min_element(y.begin(), y.end()), measured.minCoeff(), 1e-5);

  view.from_s = 4;
  view.to_s = 6;
  const json finer = charts_of(bench_, bench_.now(), view);
  const auto x = series(finer, 0, 0).at("x").get<std::vector<double>>();
  const auto shown = std::count_if(x.begin(), x.end(), [](double t) { return t >= 4 && t < 6; });
  const Eigen::VectorXd& t_s = bench_.now().fitted.recordings[0].t_s;
  EXPECT_EQ(shown, std::count_if(t_s.begin(), t_s.end(), [](double t) { return t >= 4 && t < 6; }));
  EXPECT_TRUE(std::is_sorted(x.begin(), x.end()));
}

TEST_F(StudioCharts, ColourFittedAndHeldOutApart) {
  const json clouds = charts_of(bench_, bench_.now(), {.joint = 1});
  EXPECT_EQ(series(clouds, 2, 0).at("name"), "fitted data");
  EXPECT_EQ(series(clouds, 2, 0).at("tone"), "model");
  EXPECT_EQ(series(clouds, 2, 1).at("name"), "held-out data");
  EXPECT_EQ(series(clouds, 2, 1).at("tone"), "residual");
  const json held_out = charts_of(bench_, bench_.now(), {.joint = 1, .recording = 1});
  EXPECT_EQ(series(held_out, 0, 1).at("name"), "model now, held-out data");
  EXPECT_EQ(series(held_out, 0, 1).at("tone"), "residual");
}

// A reader zooms between two samples, and an address may name a time behind the recording's end.
TEST_F(StudioCharts, OfATimeWithoutASampleMarkNoneInTheClouds) {
  const auto names = [](const json& chart) {
    std::vector<std::string> all;
    for (const json& one : chart.at("series")) all.push_back(one.at("name"));
    return all;
  };
  const View some{.joint = 1, .from_s = 4, .to_s = 6};
  EXPECT_THAT(names(charts_of(bench_, bench_.now(), some).at(2)),
              Contains("the time that is shown"));
  for (const auto& [from_s, to_s] : {std::pair(100., 200.), std::pair(5.0001, 5.0002)}) {
    const View none{.joint = 1, .from_s = from_s, .to_s = to_s};
    const json charts = charts_of(bench_, bench_.now(), none);
    ASSERT_EQ(charts.size(), 4U);
    EXPECT_THAT(names(charts.at(2)), Not(Contains("the time that is shown")));
    EXPECT_EQ(series(charts, 2, 0).at("tone"), "faint");
  }
}

TEST_F(StudioCharts, FallWithEveryStep) {
  bench_.add(EffectKind::kViscousFriction, 1);
  bench_.add(EffectKind::kCoulombFriction, 1);
  const json fall = waterfall_of(bench_, 1);
  const auto& steps = fall.at("steps");
  ASSERT_EQ(steps.size(), 3U);
  EXPECT_GT(steps.at(0).at("value").get<double>(), steps.at(1).at("value").get<double>());
  EXPECT_GT(steps.at(1).at("value").get<double>(), 3 * steps.at(2).at("value").get<double>());
  EXPECT_EQ(steps.at(2).at("label"), "2. Coulomb friction, joint 2");
}

TEST_F(StudioCharts, RefuseWhatIsNotThere) {
  for (const View& view : {View{.joint = 2}, View{.recording = 2}, View{.from_s = 3, .to_s = 2},
                           View{.from_s = 3, .to_s = 3}, View{.from_s = 3}, View{.to_s = 3},
                           View{.from_s = std::numeric_limits<double>::quiet_NaN(), .to_s = 3}}) {
    EXPECT_THROW(charts_of(bench_, bench_.now(), view), Refused);
  }
}

}  // namespace
