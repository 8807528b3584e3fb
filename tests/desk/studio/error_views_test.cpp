#include "studio/error_views.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "common/refused.hpp"
#include "desk/studio/studio_input.hpp"
#include "desk/support/temporary_folder.hpp"

namespace {

using nlohmann::json;
using offnominal::EffectKind;
using offnominal::test::studio_input;
using offnominal::test::TemporaryFolder;
using namespace offnominal::desk;
using namespace offnominal::desk::studio;
using ::testing::HasSubstr;
using ::testing::StartsWith;

class StudioErrorViews : public ::testing::Test {
 protected:
  TemporaryFolder folder_;
  Workbench bench_{studio_input(folder_ / "arm.toml", true)};
  const ErrorOver position_{ErrorVariable::kPosition, 1};
  const ErrorOver velocity_{ErrorVariable::kVelocity, 1};
  const std::string level_ = info_of(EffectKind::kCoulombFriction)->parameters[0].name;

  json evidence_of_last_step() {
    const std::size_t id = bench_.steps().back().id;
    return evidence_of(bench_.compared_with(bench_.robot_without(id)), bench_.now(),
                       bench_.effect(id));
  }
};

TEST_F(StudioErrorViews, MapTheErrorOverAnyTwoVariables) {
  const json map = map_of(bench_, bench_.now(), {.joint = 1}, position_, velocity_);
  EXPECT_EQ(map.at("x").at("name"), "position");
  EXPECT_EQ(map.at("y").at("unit"), "rad/s");
  const json of_other = map_of(bench_, bench_.now(), {.joint = 1}, {ErrorVariable::kLoad, 0},
                               {ErrorVariable::kSinceReversal, 1});
  EXPECT_EQ(of_other.at("x").at("name"), "model torque of joint 1");
  EXPECT_EQ(of_other.at("y").at("name"), "time since reversal");
  // Friction that the file lacks: one sign where it moves this way, the other where that.
  const auto& value = map.at("value");
  const std::size_t columns = map.at("x_edges").size() - 1;
  double slow = 0;
  double fast = 0;
  for (std::size_t i = 0; i < columns; ++i) {
    slow += value.at(2 * columns + i).is_null() ? 0 : value.at(2 * columns + i).get<double>();
    fast += value.at(17 * columns + i).is_null() ? 0 : value.at(17 * columns + i).get<double>();
  }
  EXPECT_LT(slow, -1);
  EXPECT_GT(fast, 1);
}

TEST_F(StudioErrorViews, AreOfTheTimeThatIsShown) {
  const View part{.joint = 1, .from_s = 4, .to_s = 4.5};
  const json map = map_of(bench_, bench_.now(), part, position_, velocity_);
  EXPECT_THAT(map.at("note").get<std::string>(), StartsWith("Of fitted.csv, 4.0"));
  const json whole = map_of(bench_, bench_.now(), {.joint = 1}, position_, velocity_);
  EXPECT_NE(map.at("value"), whole.at("value"));
  const json nothing =
      map_of(bench_, bench_.now(), {.joint = 1, .from_s = 90, .to_s = 99}, position_, velocity_);
  EXPECT_THAT(nothing.at("note").get<std::string>(), HasSubstr("no sample"));
}

TEST_F(StudioErrorViews, ShowTheSpectrumAsReadAndNow) {
  const json alone = spectrum_of(bench_, bench_.now(), {.joint = 1}, SpectrumOver::kFrequency);
  EXPECT_EQ(alone.at("series").size(), 1U);
  bench_.add(EffectKind::kViscousFriction, 1);
  bench_.add(EffectKind::kCoulombFriction, 1);
  for (const SpectrumOver over : {SpectrumOver::kFrequency, SpectrumOver::kOrder}) {
    const json both = spectrum_of(bench_, bench_.now(), {.joint = 1}, over);
    ASSERT_EQ(both.at("series").size(), 2U);
    const auto height = [&](std::size_t i) {
      const auto y = both.at("series").at(i).at("y").get<std::vector<double>>();
      return *std::max_element(y.begin(), y.end());
    };
    EXPECT_LT(height(1), 0.5 * height(0));
    EXPECT_GT(both.at("series").at(1).at("x").size(), 10U);
  }
  const json short_one = spectrum_of(bench_, bench_.now(), {.joint = 1, .from_s = 4, .to_s = 4.01},
                                     SpectrumOver::kFrequency);
  EXPECT_THAT(short_one.at("note").get<std::string>(), HasSubstr("Too short"));
}

TEST_F(StudioErrorViews, LayTheTorqueOfAnEffectOverTheErrorWithoutIt) {
  bench_.add(EffectKind::kViscousFriction, 1);
  bench_.add(EffectKind::kCoulombFriction, 1);
  const json picture = evidence_of_last_step();
  EXPECT_EQ(picture.at("x").at("name"), "velocity");
  EXPECT_THAT(picture.at("title").get<std::string>(), HasSubstr("without coulomb friction"));
  // Made with 1.5 N m: the curve is a step of that height, and the error lies along it.
  auto torque = picture.at("series").at(1).at("y").get<std::vector<double>>();
  std::sort(torque.begin(), torque.end());
  EXPECT_NEAR(torque[torque.size() / 5], -1.5, 0.2);
  EXPECT_NEAR(torque[torque.size() * 4 / 5], 1.5, 0.2);
  const auto mean = picture.at("series").at(2).at("y").get<std::vector<double>>();
  EXPECT_NEAR(mean.front(), -1.5, 0.2);
  EXPECT_NEAR(mean.back(), 1.5, 0.2);
}

TEST_F(StudioErrorViews, ShowAMassOnTheJointThatFeelsItMost) {
  bench_.add(EffectKind::kRotorInertia, 1);
  EXPECT_EQ(evidence_of_last_step().at("x").at("name"), "acceleration");
}

TEST_F(StudioErrorViews, MoveANumberOffItsFitAndLeaveTheModelAlone) {
  bench_.add(EffectKind::kCoulombFriction, 1);
  const std::size_t id = bench_.steps().back().id;
  const double before = bench_.now().fitted.joints[1].relative_error_percent;
  const Compared same =
      bench_.compared_with(bench_.robot_with(id, level_, bench_.effect(id).parameters[0]));
  EXPECT_EQ(same.fitted.joints[1].relative_error_percent, before);
  const Compared off = bench_.compared_with(bench_.robot_with(id, level_, 0.1));
  EXPECT_GT(off.fitted.joints[1].relative_error_percent, before + 1);
  EXPECT_GT(off.held_out->joints[1].relative_error_percent, before + 1);
  EXPECT_EQ(bench_.now().fitted.joints[1].relative_error_percent, before);
  EXPECT_EQ(charts_of(bench_, off, {.joint = 1}).size(), 4U);
}

TEST_F(StudioErrorViews, RefuseWhatIsNotThere) {
  EXPECT_THROW(map_of(bench_, bench_.now(), {.joint = 1}, {ErrorVariable::kLoad, 2}, velocity_),
               Refused);
  EXPECT_THROW(map_of(bench_, bench_.now(), {.joint = 2}, position_, velocity_), Refused);
  EXPECT_THROW(spectrum_of(bench_, bench_.now(), {.recording = 5}, SpectrumOver::kOrder), Refused);
  EXPECT_THROW(static_cast<void>(bench_.robot_without(1)), Refused);
  bench_.add(EffectKind::kCoulombFriction, 1);
  const std::size_t id = bench_.steps().back().id;
  EXPECT_THROW(static_cast<void>(bench_.robot_with(id + 1, level_, 1)), Refused);
  EXPECT_THROW(static_cast<void>(bench_.robot_with(id, "colour", 1)), Refused);
  EXPECT_THROW(static_cast<void>(bench_.robot_with(id, level_, std::nan(""))), Refused);
  const std::string width = info_of(EffectKind::kCoulombFriction)->parameters[1].name;
  EXPECT_THROW(static_cast<void>(bench_.robot_with(id, width, -1)), Refused);
}

}  // namespace
