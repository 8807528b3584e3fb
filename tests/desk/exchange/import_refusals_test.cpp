#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/error.hpp"
#include "desk/support/temporary_file.hpp"
#include "exchange/import_urdf.hpp"
#include "urdfs.hpp"

namespace offnominal::test {
namespace {

using desk::InputError;
using desk::exchange::ChainChoice;
using desk::exchange::ChainRequest;
using desk::exchange::chains_in;
using desk::exchange::import_urdf;
using testing::AllOf;
using testing::HasSubstr;

std::string refusal_of(const std::string& text, const ChainRequest& chain,
                       const std::string& file = "arm.urdf") {
  return message_of<InputError>([&] { static_cast<void>(import_urdf(text, file, chain)); });
}

struct Wrong {
  const char* what;  // a word
  std::string old_text;
  std::string new_text;
  std::string told;  // line and what was found
  std::string mend;
  ChainRequest chain = {"world", "hand"};
};

class UrdfRefusal : public testing::TestWithParam<Wrong> {};

TEST_P(UrdfRefusal, NamesTheLineAndHowToMendIt) {
  const Wrong& wrong = GetParam();
  std::string text = sample_arm().text();
  const auto at = text.find(wrong.old_text);
  ASSERT_NE(at, std::string::npos);
  text.replace(at, wrong.old_text.size(), wrong.new_text);
  const std::string message = refusal_of(text, wrong.chain);
  EXPECT_THAT(message,
              AllOf(HasSubstr("arm.urdf: " + wrong.told), HasSubstr("; to mend: " + wrong.mend)));
}

INSTANTIATE_TEST_SUITE_P(
    All, UrdfRefusal,
    testing::Values(
        Wrong{"NoXml", "<parent link=\"upper\"/>", "<parent link=\"upper\">",
              "line 43: found XML that is not well formed", "close every element"},
        Wrong{"Xacro", "<link name=\"world\"/>", "<xacro:arm prefix=\"left\"/>",
              "line 5: found <xacro:arm>, which is xacro and not expanded",
              "expand it with `xacro arm.urdf > arm_expanded.urdf`"},
        Wrong{"XacroProperty", "<mass value=\"2.5\"/>", "<mass value=\"${heavy}\"/>",
              "line 22: found \"${heavy}\", which is xacro", "expand it"},
        Wrong{"NoNumber", "value=\"2.5\"", "value=\"2,5\"",
              "line 22, link `upper`, <mass> value: found \"2,5\"; allowed: a finite number >= 0, "
              "in kg",
              "give the link's mass in kg"},
        Wrong{"NotFinite", "value=\"2.5\"", "value=\"inf\"", "line 22, link `upper`, <mass> value",
              "give"},
        Wrong{"TwoNumbers", "xyz=\"0.1 0 0.12\"", "xyz=\"0.1 0\"",
              "line 27, joint `shoulder`, <origin> xyz: found \"0.1 0\"; allowed: three numbers",
              "write them"},
        Wrong{"TooHeavy", "value=\"2.5\"", "value=\"2.5e9\"",
              "line 22, link `upper`, <mass> value: found 2.5e+09; allowed: at most 1e+07 kg",
              "check the number's unit"},
        Wrong{"LongInMetres", "xyz=\"0.1 0 0.12\"", "xyz=\"100 0 120\"",
              "line 27, joint `shoulder`, <origin> xyz: found 120; allowed: at most 100 m",
              "check the number's unit"},
        Wrong{"AnglesInDegrees", "rpy=\"0.2 -0.1 0.5\"", "rpy=\"90 0 180\"",
              "line 27, joint `shoulder`, <origin> rpy: found 90; allowed: at most 6.2832 rad",
              "write the three angles in rad"},
        Wrong{"NegativeMass", "value=\"2.5\"", "value=\"-2.5\"", "line 22, link `upper`", "give"},
        Wrong{"NoMass", "<mass value=\"2.5\"/>", "",
              "line 20, link `upper`: found no <mass> in <inertial>", "add it"},
        Wrong{"MassOfZero", "<mass value=\"2.5\"/>", "<mass value=\"0\"/>",
              "line 19, link `upper`: found an inertia and a mass of 0", "give the link's mass"},
        Wrong{"TriangleInequality", "izz=\"0.008\"", "izz=\"0.08\"",
              "line 19, link `upper`: found a tensor that breaks the triangle inequality",
              "check the signs"},
        Wrong{"NotPositiveDefinite", "ixy=\"0.001\"", "ixy=\"0.1\"",
              "line 19, link `upper`: found a tensor that is not positive definite",
              "check the signs"},
        Wrong{"NothingWeighsAnything",
              "<parent link=\"carriage\"/>\n    <child link=\"motor\"/>",
              "<parent link=\"world\"/>\n    <child link=\"motor\"/>",
              "line 52, link `carriage`: found no mass behind joint `slide`",
              "add its <inertial>",
              {"world", "carriage"}},
        Wrong{"NoSuchLink", "<child link=\"motor\"/>", "<child link=\"ballast\"/>",
              "line 68, joint `flange`: found the link `ballast`, which is not there",
              "add the link"},
        Wrong{"MissingLink", "<parent link=\"rail\"/>", "<parent link=\"rai\"/>",
              "line 53, joint `slide`: found the link `rai`, which is not there",
              "write `rail`, or add the link"},
        Wrong{"Mimic", "<dynamics friction=\"9\"/>", "<mimic joint=\"shoulder\"/>",
              "line 53, joint `slide`: found a mimic of `shoulder` in the chain",
              "end the chain before it by --tip"},
        Wrong{"Floating", "name=\"slide\" type=\"prismatic\"", "name=\"slide\" type=\"floating\"",
              "line 53, joint `slide`: found a floating joint in the chain",
              "begin behind it: --base carriage"},
        Wrong{"Planar", "name=\"slide\" type=\"prismatic\"", "name=\"slide\" type=\"planar\"",
              "line 53, joint `slide`: found a planar joint in the chain", "begin behind it"},
        Wrong{"Type", "type=\"continuous\"", "type=\"continous\"",
              "line 80, joint `wrist`: found the type \"continous\"", "write type=\"continuous\""},
        Wrong{"AxisOfNoLength", "<axis xyz=\"0 1 0\"/>", "<axis xyz=\"0 0 0\"/>",
              "line 26, joint `shoulder`: found an axis of no length", "give the axis"},
        Wrong{"RangeUpsideDown", "lower=\"-1.9\"", "lower=\"3\"",
              "line 26, joint `shoulder`: found a range from 3 to 2.1", "exchange them"},
        Wrong{"RangeWithoutWidth", "lower=\"-1.9\"", "lower=\"2.1\"",
              "line 26, joint `shoulder`: found a range from 2.1 to 2.1", "correct them"},
        Wrong{"NegativeDamping", "damping=\"0.7\"", "damping=\"-0.7\"",
              "line 32, joint `shoulder`, <dynamics> damping", "give a damping"},
        Wrong{"NoLimit", "<limit lower=\"-0.1\" upper=\"0.3\" effort=\"200\" velocity=\"0.8\"/>",
              "", "line 53, joint `slide`: found no <limit>", "add it"},
        Wrong{"NoEffort", "upper=\"2.1\" effort=\"60\"", "upper=\"2.1\"",
              "line 31, joint `shoulder`, <limit> effort: found nothing",
              "give the largest torque"},
        Wrong{"NoChild", "<child link=\"carriage\"/>", "",
              "line 53, joint `slide`: found no <child> in <joint>", "add it"},
        Wrong{"NoName", "<link name=\"rail\"/>", "<link/>", "line 46, <link>: found no name",
              "give name"},
        Wrong{"TwoLinksOfAName", "<link name=\"rail\"/>", "<link name=\"upper\"/>",
              "line 46, link `upper`: found the name of the link in line 19", "rename"},
        Wrong{"TwoJointsOfAName", "joint name=\"weld\"", "joint name=\"screws\"",
              "line 47, joint `screws`: found the name of the joint in line 41", "rename"},
        Wrong{"TwoLimits", "<limit effort=\"12\" velocity=\"0\"/>",
              "<limit effort=\"12\" velocity=\"0\"/><limit effort=\"12\" velocity=\"0\"/>",
              "line 84, joint `wrist`: found a second <limit>", "remove one"},
        Wrong{"ClosedLoop", "<child link=\"finger\"/>", "<child link=\"upper\"/>",
              "line 94, joint `grip`: found the link `upper` as its child", "cut the loop"},
        Wrong{"TwoRoots", "</robot>", "<link name=\"stray\"/></robot>",
              "found 2 links that are no joint's child: `stray`", "add the joint that is missing"}),
    [](const auto& one) { return std::string(one.param.what); });

TEST(UrdfRefusal, SaysWhichLinkWasMeant) {
  EXPECT_THAT(refusal_of(sample_arm().text(), {"world", "hnd"}),
              AllOf(HasSubstr("--tip: found `hnd`, which is no link of arm.urdf"),
                    HasSubstr("to mend: write `hand`")));
  EXPECT_THAT(refusal_of(sample_arm().text(), {"bas", "hand"}), HasSubstr("--base: found `bas`"));
}

TEST(UrdfRefusal, ListsTheTipsWhereThereAreSeveral) {
  EXPECT_THAT(
      refusal_of(sample_arm().text(), {}),
      HasSubstr("line 5, link `world`: found more than one chain of moving joints beyond it; "
                "allowed: --tip one of hand (3 joints), finger (4 joints), other_finger (4 "
                "joints); to mend: add --tip"));
}

TEST(UrdfChains, AreFromTheRootAndFromWhereTheyPart) {
  std::string words;
  for (const ChainChoice& chain : chains_in(sample_arm().text(), "arm.urdf")) {
    words += chain.base + " " + chain.tip + " " + std::to_string(chain.joints) + "; ";
  }
  EXPECT_EQ(words,
            "world hand 3; world finger 4; world other_finger 4; hand finger 1; "
            "hand other_finger 1; ");
}

TEST(UrdfRefusal, KnowsABaseThatIsNotAboveTheTip) {
  EXPECT_THAT(
      refusal_of(sample_arm().text(), {"hand", "upper"}),
      AllOf(HasSubstr("line 19, link `upper`: found a tip that is not beyond the base `hand`"),
            HasSubstr("to mend: exchange --base and --tip")));
  EXPECT_THAT(refusal_of(sample_arm().text(), {"finger", "other_finger"}),
              HasSubstr("to mend: name a base that is nearer to the root"));
  EXPECT_THAT(refusal_of(sample_arm().text(), {"world", "base"}),
              HasSubstr("found no joint that moves between `world` and it"));
  EXPECT_THAT(refusal_of(sample_arm().text(), {"finger", std::nullopt}),
              HasSubstr("found no joint that moves beyond it"));
}

TEST(UrdfRefusal, RefusesAChainOfMoreJointsThanARobotFileHas) {
  std::string text = "<robot name=\"snake\"><link name=\"l0\"/>";
  for (int i = 1; i <= kMaxJoints + 1; ++i) {
    const std::string at = std::to_string(i);
    text += "<link name=\"l" + at + "\"/><joint name=\"j" + at +
            "\" type=\"continuous\"><parent link=\"l" + std::to_string(i - 1) +
            "\"/><child link=\"l" + at + "\"/></joint>";
  }
  EXPECT_THAT(refusal_of(text + "</robot>", {}), HasSubstr("found 13 moving joints between `l0`"));
}

TEST(UrdfRefusal, SeesARingThatHangsOnNothing) {
  EXPECT_THAT(refusal_of("<robot name=\"r\">\n<link name=\"a\"/><link name=\"b\"/>"
                         "<link name=\"c\"/>\n<joint name=\"j\" type=\"fixed\"><parent link=\"b\"/>"
                         "<child link=\"c\"/></joint>\n<joint name=\"k\" type=\"fixed\">"
                         "<parent link=\"c\"/><child link=\"b\"/></joint></robot>",
                         {}),
              HasSubstr("found links that lead back to `b`: a closed loop"));
}

TEST(UrdfRefusal, NamesOtherEncodings) {
  EXPECT_THAT(refusal_of(std::string("\xFF\xFE<\0r\0", 6), {}),
              AllOf(HasSubstr("line 1: found UTF-16"), HasSubstr("to mend: save it in UTF-8")));
  EXPECT_THAT(refusal_of("\x1f\x8b\x08", {}), HasSubstr("found data packed with gzip"));
}

TEST(UrdfRefusal, NamesOtherFormats) {
  EXPECT_THAT(refusal_of("<mujoco/>", {}), HasSubstr("line 1: found <mujoco> as the root (MJCF)"));
  EXPECT_THAT(refusal_of("<sdf version=\"1.7\"/>", {}), HasSubstr("<sdf> as the root (SDF)"));
  EXPECT_THAT(refusal_of("<robot/>", {}), HasSubstr("found no link"));
  EXPECT_THAT(refusal_of("", {}), HasSubstr("found XML that is not well formed (empty document)"));
  EXPECT_THAT(refusal_of("format = 1\n", {}), HasSubstr("found XML that is not well formed"));
  EXPECT_THAT(refusal_of(std::string("<robot>\n\0</robot>", 17), {}),
              HasSubstr("line 2: found a byte of zero"));
  EXPECT_THAT(refusal_of("<robot xmlns:xacro=\"x\"><xacro:arm/></robot>", {}, "my arm.urdf.xacro"),
              HasSubstr("expand it with `xacro 'my arm.urdf.xacro' > 'my arm.urdf'`"));
}

TEST(UrdfRefusal, DoesNotFallIntoDeepNesting) {
  std::string text = "<robot name=\"deep\">";
  for (int i = 0; i < 200000; ++i) text += "<link>";
  EXPECT_THAT(refusal_of(text, {}), HasSubstr("found XML that is not well formed (element depth"));
}

}  // namespace
}  // namespace offnominal::test
