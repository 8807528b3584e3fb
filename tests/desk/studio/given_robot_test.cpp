// A robot that the page is given as a URDF, of one chain of joints or of several.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "common/error.hpp"
#include "common/refused.hpp"
#include "desk/exchange/urdfs.hpp"
#include "desk/studio/loading.hpp"
#include "desk/studio/strange_files.hpp"
#include "exchange/import_report.hpp"
#include "exchange/import_urdf.hpp"

namespace {

using nlohmann::ordered_json;
using offnominal::test::content_of;
using offnominal::test::Loading;
using offnominal::test::put;
using offnominal::test::robot_text_of_arm;
using offnominal::test::sample_arm;
using namespace offnominal::desk;
using namespace offnominal::desk::studio;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

std::string arm_of_three_csv() {
  std::string text = "t,q1,q2,q3,dq1,dq2,dq3,tau1,tau2,tau3\n";
  for (int i = 0; i < 500; ++i) {
    const double t_s = 0.004 * i;
    text += std::to_string(t_s);
    for (int column = 0; column < 9; ++column) {
      text += "," + std::to_string(std::sin((1 + 0.3 * column) * t_s + column));
    }
    text += "\n";
  }
  return text;
}

TEST_F(Loading, ImportsAUrdfAndWritesItsRobotFile) {
  const char* urdf = R"(<robot name="one"><link name="base"/>
    <link name="arm"><inertial><origin xyz="0.2 0 0"/><mass value="1"/>
    <inertia ixx="0.01" iyy="0.02" izz="0.02" ixy="0" ixz="0" iyz="0"/></inertial></link>
    <joint name="shoulder" type="revolute"><parent link="base"/><child link="arm"/>
    <axis xyz="0 1 0"/><limit lower="-2" upper="2" velocity="3" effort="10"/></joint></robot>)";
  const ordered_json state = give("one.urdf", urdf);
  EXPECT_EQ(state.at("robot").at("file"), "one.toml");
  EXPECT_EQ(state.at("robot").at("joints").size(), 1U);
  EXPECT_THAT(refusal_of("two.urdf", "<robot/>"), HasSubstr("two.urdf"));
  EXPECT_EQ(intake_.state().at("robot").at("file"), "one.toml");
  EXPECT_TRUE(state.at("urdf").is_null());
}

TEST_F(Loading, AsksForOneOfSeveralChainsOfAUrdfAndWritesItAsImportUrdfDoes) {
  const std::string text = sample_arm().text();
  const ordered_json asked = give("arm.urdf", text);
  EXPECT_TRUE(asked.at("robot").is_null());
  const ordered_json& chains = asked.at("urdf").at("chains");
  EXPECT_EQ(chains.at(0), (ordered_json{{"base", "world"}, {"tip", "hand"}, {"joints", 3}}));
  ASSERT_EQ(chains.size(), 5U);
  EXPECT_EQ(chains.at(3).at("base"), "hand");
  EXPECT_TRUE(asked.at("urdf").at("chosen").is_null());
  const ordered_json state = intake_.choose_chain(0);
  EXPECT_EQ(state.at("robot").at("file"), "arm.toml");
  EXPECT_EQ(state.at("robot").at("joints").size(), 3U);
  EXPECT_EQ(state.at("urdf").at("chosen"), 1);
  // What cannot be taken leaves what was.
  EXPECT_THROW(static_cast<void>(intake_.choose_chain(5)), Refused);
  EXPECT_EQ(intake_.state(), state);
  put(folder_ / "run.csv", arm_of_three_csv());
  give("run.csv", arm_of_three_csv());
  const SessionFiles files = intake_.files();
  EXPECT_EQ(
      files.commands_note,
      "The robot file is made by: offnominal import-urdf arm.urdf --base world --tip hand -o " +
          (folder_ / "arm.toml").string());
  static_cast<void>(intake_.write(files));
  EXPECT_EQ(content_of(folder_ / "arm.toml"),
            exchange::robot_text_of(exchange::import_urdf(text, "arm.urdf", sample_arm().chain()),
                                    "arm.urdf"));
  // Another one, and then a robot file, which leaves no choice.
  EXPECT_EQ(intake_.choose_chain(1).at("robot").at("joints").size(), 4U);
  EXPECT_TRUE(give("arm.toml", content_of(folder_ / "arm.toml")).at("urdf").is_null());
  EXPECT_THROW(static_cast<void>(intake_.choose_chain(0)), Refused);
  EXPECT_EQ(intake_.files().commands_note, "");
}

TEST_F(Loading, RefusesAChainAsImportUrdfDoesAndGoesOnAsking) {
  std::string text = sample_arm().text();
  const std::string limits = "<limit lower=\"-1.9\" upper=\"2.1\" effort=\"60\" velocity=\"3.5\"/>";
  text.replace(text.find(limits), limits.size(), "<mimic joint=\"slide\"/>" + limits);
  give("arm.toml", robot_text_of_arm());
  give("arm.urdf", text);
  const std::uint64_t used = intake_.folder().used();
  try {
    static_cast<void>(intake_.choose_chain(0));
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), AllOf(StartsWith("arm.urdf: "), HasSubstr("mimic")));
  }
  EXPECT_EQ(intake_.folder().used(), used);
  EXPECT_EQ(intake_.state().at("robot").at("joints").size(), 2U);
  EXPECT_TRUE(intake_.state().at("urdf").at("chosen").is_null());
}

}  // namespace
