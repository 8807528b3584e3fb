#include "exchange/import_urdf.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <tuple>

#include "common/error.hpp"
#include "desk/support/temporary_file.hpp"
#include "exchange/import_report.hpp"
#include "robot/robot_file.hpp"
#include "urdfs.hpp"

namespace offnominal::test {
namespace {

using desk::exchange::import_urdf;
using desk::exchange::ImportedRobot;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

std::vector<std::string> notes_of(const ImportedRobot& imported) {
  std::vector<std::string> notes;
  for (const auto& note : imported.notes) {
    notes.push_back(std::string(name_of(note.kind)) + " " + std::to_string(note.line) + " " +
                    note.text);
  }
  return notes;
}

ImportedRobot imported_arm() {
  return import_urdf(sample_arm().text(), "arm.urdf", sample_arm().chain());
}

// Two balls of 1 kg on a bar: in the link itself at x = 1, in a link fixed to it at x = -1. By
// hand: 2 kg, centre between them, 2 kg m^2 about y and z, nothing about x.
TEST(ImportUrdf, MergesFixedLinksAsWorkedOutByHand) {
  const ImportedRobot imported = import_urdf(R"(<robot name="bar">
    <link name="ground"/>
    <link name="bar"><inertial><origin xyz="1 0 0"/><mass value="1"/>
      <inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/></inertial></link>
    <link name="ball"><inertial><origin xyz="0 0 0.5"/><mass value="1"/>
      <inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/></inertial></link>
    <joint name="pin" type="continuous"><parent link="ground"/><child link="bar"/>
      <axis xyz="0 0 1"/></joint>
    <joint name="weld" type="fixed"><origin xyz="-0.5 0 0" rpy="0 -1.5707963267948966 0"/>
      <parent link="bar"/><child link="ball"/></joint></robot>)",
                                             "bar.urdf");
  ASSERT_EQ(imported.robot.joint_count(), 1);
  const Joint<double>& joint = imported.robot.joints[0].joint;
  EXPECT_DOUBLE_EQ(joint.mass_kg, 2);
  for (const double x : joint.centre_of_mass_m) EXPECT_NEAR(x, 0, 1e-15);
  const double by_hand[]{0, 2, 2, 0, 0, 0};
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(joint.inertia_kg_m2[i], by_hand[i], 1e-15) << i;
}

std::string urdf_with_joint(const std::string& name, const std::string& declaration = {}) {
  return declaration +
         "<robot name=\"a\">\n<link name=\"ground\"/>\n"
         "<link name=\"bar\"><inertial><mass value=\"1\"/>"
         "<inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" "
         "izz=\"1\"/></inertial></link>\n"
         "<joint name=\"" +
         name +
         "\" type=\"continuous\"><parent link=\"ground\"/><child link=\"bar\"/>"
         "<axis xyz=\"0 0 1\"/></joint></robot>";
}

std::string declared(const std::string& encoding) {
  return "<?xml version=\"1.0\" encoding=\"" + encoding + "\"?>";
}

// As an editor of long ago saves umlauts.
TEST(ImportUrdf, ReadsLatin1AndSaysWhereNothingDeclaresIt) {
  for (const std::string& declaration : {std::string(), declared("utf-8")}) {
    const ImportedRobot imported = import_urdf(urdf_with_joint("Gelenk_H\xFC"
                                                               "fte",
                                                               declaration),
                                               "bar.urdf");
    EXPECT_EQ(imported.robot.joints[0].name, "Gelenk_H\u00FCfte");
    EXPECT_THAT(
        notes_of(imported),
        Contains("assumed 4 Windows-1252 (Latin-1), since the file is no UTF-8 and declares "
                 "nothing else, in the name `Gelenk_H\u00FCfte`: declare its encoding, or "
                 "save it in UTF-8, where that is wrong"));
    const std::string text = desk::exchange::robot_text_of(imported, "bar.urdf");
    EXPECT_EQ(desk::parse_robot(text, "bar.toml").joints[0].name, "Gelenk_H\u00FCfte");
  }
  EXPECT_THAT(notes_of(imported_arm()), Not(Contains(HasSubstr("UTF-8"))));
}

TEST(ImportUrdf, ReadsTheEncodingThatIsDeclared) {
  for (const auto& [encoding, bytes, name] : {std::tuple{"ISO-8859-1",
                                                         "H\xFC"
                                                         "fte",
                                                         "H\u00FCfte"},
                                              std::tuple{"windows-1252",
                                                         "H\xFC"
                                                         "fte",
                                                         "H\u00FCfte"},
                                              std::tuple{"ISO-8859-15", "k\xA4", "k\u20AC"}}) {
    const ImportedRobot imported =
        import_urdf(urdf_with_joint(bytes, declared(encoding)), "bar.urdf");
    EXPECT_EQ(imported.robot.joints[0].name, name) << encoding;
    EXPECT_THAT(notes_of(imported), Not(Contains(HasSubstr("UTF-8")))) << encoding;
  }
  // Whatever is declared, UTF-8 is no chance.
  const ImportedRobot utf8 =
      import_urdf(urdf_with_joint("H\u00FCfte", declared("ISO-8859-1")), "bar.urdf");
  EXPECT_EQ(utf8.robot.joints[0].name, "H\u00FCfte");
}

TEST(ImportUrdf, RefusesBytesOfNoEncodingThatIsDeclared) {
  const auto refusal = [](const std::string& text) {
    return message_of<desk::InputError>([&] { static_cast<void>(import_urdf(text, "bar.urdf")); });
  };
  for (const char* encoding : {"X-NONE", "../UTF-8", "ISO-8859-1//TRANSLIT"}) {
    EXPECT_THAT(
        refusal(urdf_with_joint("H\xFC"
                                "fte",
                                declared(encoding))),
        testing::AllOf(HasSubstr("bar.urdf: line 4: found the byte 0xFC, which is no UTF-8, in "
                                 "a file that declares " +
                                 std::string(encoding)),
                       HasSubstr("to mend: save it in UTF-8, or declare what it is saved in")));
  }
  EXPECT_THAT(
      refusal(urdf_with_joint("a\x81", declared("windows-1252"))),
      HasSubstr("line 4: found the byte 0x81, which is no windows-1252, as the file declares"));
}

TEST(ImportUrdf, TellsNamesThatAreInNoEncoding) {
  const ImportedRobot imported = import_urdf(urdf_with_joint("Gel\x81nk"), "bar.urdf");
  EXPECT_EQ(imported.robot.joints[0].name, "Gel\uFFFDnk");
  EXPECT_THAT(notes_of(imported),
              Contains("assumed 4 U+FFFD for bytes that are no UTF-8 in the name "
                       "`Gel\uFFFDnk`: saved in UTF-8 the file keeps them"));
  EXPECT_NO_THROW(static_cast<void>(
      desk::parse_robot(desk::exchange::robot_text_of(imported, "bar.urdf"), "bar.toml")));
}

std::string brick_with(const std::string& inertia) {
  return R"(<robot name="brick">
    <link name="ground"/>
    <link name="brick"><inertial><mass value="1"/>
      <inertia )" +
         inertia + R"(/></inertial></link>
    <joint name="pin" type="continuous"><parent link="ground"/><child link="brick"/>
      <axis xyz="0 0 1"/></joint></robot>)";
}

// 0.1 + 0.2 lack 0.02 of 0.32: both get half of it.
TEST(ImportUrdf, TakesTheNearestInertiaThatABodyCanHave) {
  const ImportedRobot imported = import_urdf(
      brick_with(R"(ixx="0.1" ixy="0" ixz="0" iyy="0.2" iyz="0" izz="0.32")"), "brick.urdf");
  const auto& inertia = imported.robot.joints[0].joint.inertia_kg_m2;
  const double by_hand[]{0.11, 0.21, 0.32, 0, 0, 0};
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(inertia[i], by_hand[i], 1e-6) << i;
  EXPECT_THAT(notes_of(imported),
              Contains(HasSubstr("assumed 3 the nearest inertia of link `brick` that a body can "
                                 "have: the file's is a tensor that breaks the triangle")));
}

// The first link of a real arm's URDF lacks two thirds of its largest moment.
TEST(ImportUrdf, TakesTheNearestInertiaHoweverFarWhereAsked) {
  const std::string text =
      brick_with(R"(ixx="0.0004" ixy="0" ixz="0" iyy="0.0048" iyz="0" izz="0.0146")");
  EXPECT_THAT(
      message_of<desk::InputError>([&] { static_cast<void>(import_urdf(text, "brick.urdf")); }),
      HasSubstr("or take the nearest that a body can have: --nearest-inertia"));
  const ImportedRobot imported =
      import_urdf(text, "brick.urdf", {}, desk::exchange::InertiaRule::kNearest);
  const auto& inertia = imported.robot.joints[0].joint.inertia_kg_m2;
  const double by_hand[]{0.0051, 0.0095, 0.0146, 0, 0, 0};
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(inertia[i], by_hand[i], 1e-6) << i;
  EXPECT_THAT(notes_of(imported), Contains(HasSubstr("assumed 3 the nearest inertia")));
}

// As files for Drake have it.
TEST(ImportUrdf, TakesAWorldThatNothingSaysForTheGround) {
  const ImportedRobot imported = import_urdf(R"(<robot name="pendulum">
    <link name="base"/>
    <link name="rod"><inertial><mass value="1"/>
      <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link>
    <joint name="weld" type="fixed"><parent link="world"/><child link="base"/></joint>
    <joint name="pin" type="continuous"><parent link="base"/><child link="rod"/>
      <axis xyz="0 1 0"/></joint></robot>)",
                                             "pendulum.urdf");
  EXPECT_EQ(imported.robot.joint_count(), 1);
  EXPECT_THAT(notes_of(imported), Contains(HasSubstr("the link `world`, which joints name")));
}

// A brick whose axes are turned by 90 degrees about z: xx and yy change places.
TEST(ImportUrdf, TurnsAnInertiaIntoTheLinksFrame) {
  const ImportedRobot imported = import_urdf(R"(<robot name="brick">
    <link name="ground"/>
    <link name="brick"><inertial><origin rpy="0 0 1.5707963267948966"/><mass value="1"/>
      <inertia ixx="0.1" ixy="0.01" ixz="0" iyy="0.2" iyz="0" izz="0.25"/></inertial></link>
    <joint name="pin" type="continuous"><parent link="ground"/><child link="brick"/>
      <axis xyz="0 0 1"/></joint></robot>)",
                                             "brick.urdf");
  const double by_hand[]{0.2, 0.1, 0.25, -0.01, 0, 0};
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_NEAR(imported.robot.joints[0].joint.inertia_kg_m2[i], by_hand[i], 1e-15) << i;
  }
}

TEST(ImportUrdf, SaysThatARangeOfManyTurnsMayBeInDegrees) {
  const auto notes_for = [](const std::string& type, const std::string& limits) {
    return notes_of(import_urdf(R"(<robot name="r"><link name="ground"/>
      <link name="arm"><inertial><mass value="1"/>
        <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
      <joint name="pin" type=")" + type +
                                    R"("><parent link="ground"/><child link="arm"/>
        <limit )" + limits + R"( effort="1" velocity="1"/></joint></robot>)",
                                "r.urdf"));
  };
  const auto degrees = HasSubstr("Where it is meant in degrees, write -2.96706 and 2.96706");
  EXPECT_THAT(notes_for("revolute", "lower=\"-170\" upper=\"170\""), Contains(degrees));
  const auto any = Contains(HasSubstr("in degrees"));
  EXPECT_THAT(notes_for("revolute", "lower=\"-6.28\" upper=\"12.5\""), Not(any));
  EXPECT_THAT(notes_for("prismatic", "lower=\"-170\" upper=\"170\""), Not(any));
}

TEST(ImportUrdf, KeepsLimitsAndTurnsDynamicsIntoEffects) {
  const desk::RobotDescription robot = imported_arm().robot;
  ASSERT_EQ(robot.joint_count(), 3);
  const Joint<double>& shoulder = robot.joints[0].joint;
  EXPECT_EQ(shoulder.min_position, -1.9);
  EXPECT_EQ(shoulder.max_position, 2.1);
  EXPECT_EQ(shoulder.max_velocity, 3.5);
  EXPECT_EQ(shoulder.max_torque, 60);
  EXPECT_EQ(robot.joints[1].joint.type, JointType::kPrismatic);
  const Joint<double> unlimited;
  const Joint<double>& wrist = robot.joints[2].joint;
  EXPECT_EQ(wrist.max_position, unlimited.max_position);
  EXPECT_EQ(wrist.max_velocity, unlimited.max_velocity);
  EXPECT_EQ(wrist.max_torque, 12);
  struct Expected {
    EffectKind kind;
    int joint;
    double value;
  };
  const Expected expected[]{{EffectKind::kViscousFriction, 0, 0.7},
                            {EffectKind::kCoulombFriction, 0, 1.25},
                            {EffectKind::kCoulombFriction, 1, 9},
                            {EffectKind::kViscousFriction, 2, 0.05}};
  ASSERT_EQ(robot.effects.size(), std::size(expected));
  for (std::size_t i = 0; i < std::size(expected); ++i) {
    EXPECT_EQ(robot.effects[i].kind, expected[i].kind) << i;
    EXPECT_EQ(robot.effects[i].joint, expected[i].joint) << i;
    EXPECT_EQ(robot.effects[i].parameters[0], expected[i].value) << i;
    EXPECT_FALSE(robot.effects[i].fitted);
  }
}

TEST(ImportUrdf, SaysWhatItMergedHeldLeftOutAndAssumed) {
  const std::vector<std::string> notes = notes_of(imported_arm());
  for (const char* expected :
       {"merged 34 link `cover` (0.4 kg) into `upper`",
        "merged 61 link `motor` (0.9 kg) into `carriage`",
        "held 94 joint `grip`, not in the chain, at 0.01 m", "left out 5 the 4 kg of base `world`",
        "left out 12 <visual>", "left out 85 `K` of <dynamics>", "left out 116 <transmission>",
        "assumed 0 gravity of 9.81 m/s^2 along -z of the root `world`",
        "assumed 53 the axis of joint `slide`, of length 2",
        "assumed 80 the axis 1 0 0 of joint `wrist`: the URDF gives none",
        "assumed 80 no limit of velocity is known of joint `wrist`",
        "assumed 87 a point mass: the inertia of link `finger` is zero",
        "assumed 0 friction changes its sign over 0.01"}) {
    EXPECT_THAT(notes, Contains(HasSubstr(expected)));
  }
  // Both ends were given.
  EXPECT_THAT(notes, Not(Contains(HasSubstr("base `world`: the root"))));
  EXPECT_THAT(notes, Not(Contains(HasSubstr("tip `"))));
}

// Of a tool's frame simulators ask for an inertia, and it is none of the arm's.
TEST(ImportUrdf, LeavesOutTheInertiaOfAFrameThatHasNoMass) {
  std::string text = sample_arm().text();
  const auto end = text.find("</robot>");
  ASSERT_NE(end, std::string::npos);
  text.insert(end,
              "<link name=\"tcp\"><inertial><mass value=\"0\"/>"
              "<inertia ixx=\"1e-6\" ixy=\"0\" ixz=\"0\" iyy=\"1e-6\" iyz=\"0\" izz=\"1e-6\"/>"
              "</inertial></link><joint name=\"tcp_joint\" type=\"fixed\">"
              "<parent link=\"hand\"/><child link=\"tcp\"/></joint>");
  const auto with_frame = import_urdf(text, "arm.urdf", sample_arm().chain());
  EXPECT_THAT(notes_of(with_frame), Contains(HasSubstr("the inertia of link `tcp`, 1e-06 kg m^2")));
  const auto without = imported_arm();
  EXPECT_EQ(with_frame.robot.joints.back().joint.inertia_kg_m2,
            without.robot.joints.back().joint.inertia_kg_m2);
}

TEST(ImportUrdf, TakesTheRootAndTheOnlyTipAndSaysSo) {
  std::string text = sample_arm().text();
  for (const char* grip : {"\"grip\" type=\"prismatic\"", "\"other_grip\" type=\"prismatic\""}) {
    const auto at = text.find(grip);
    ASSERT_NE(at, std::string::npos);
    const std::string fixed =
        std::string(grip).substr(0, std::string(grip).find(' ')) + " type=\"fixed\"";
    text.replace(at, std::string(grip).size(), fixed);
  }
  const auto imported = import_urdf(text, "arm.urdf");
  EXPECT_EQ(imported.base, "world");
  EXPECT_EQ(imported.tip, "hand");
  EXPECT_THAT(notes_of(imported), Contains("assumed 5 base `world`: the root"));
  EXPECT_THAT(notes_of(imported),
              Contains("assumed 73 tip `hand`: the only chain of moving joints ends in it"));
}

TEST(ImportUrdf, TurnsGravityIntoTheFrameOfABaseThatIsNotTheRoot) {
  const auto imported = import_urdf(sample_arm().text(), "arm.urdf", {"base", "hand"});
  // The base stands tilted by 0.3 rad about y.
  EXPECT_NEAR(imported.robot.gravity_m_s2[0], 9.81 * std::sin(0.3), 1e-12);
  EXPECT_NEAR(imported.robot.gravity_m_s2[1], 0, 1e-12);
  EXPECT_NEAR(imported.robot.gravity_m_s2[2], -9.81 * std::cos(0.3), 1e-12);
  EXPECT_THAT(notes_of(imported), Contains(HasSubstr("1 link between the root and the base")));
}

TEST(ImportUrdf, SaysThatWhatFollowsAJointOfTheChainIsHeldAllTheSame) {
  const auto imported = import_urdf(sample_arm().text(), "arm.urdf", {"world", "finger"});
  ASSERT_EQ(imported.robot.joint_count(), 4);
  EXPECT_THAT(notes_of(imported), Contains(HasSubstr("it follows `grip`, which moves")));
}

TEST(ImportUrdf, WritesARobotFileThatIsReadAgainWithTheNotesAsComments) {
  const ImportedRobot imported = imported_arm();
  const std::string text = desk::exchange::robot_text_of(imported, "/somewhere/arm.urdf");
  EXPECT_THAT(text, testing::StartsWith(
                        "# Imported from the URDF arm.urdf by `offnominal import-urdf --base "
                        "world --tip hand`.\n"));
  EXPECT_THAT(text, HasSubstr("\n# merged: link `cover` (0.4 kg) into `upper` (line 34)\n"));
  const auto robot = desk::parse_robot(text, "arm.toml");
  EXPECT_EQ(robot.joint_count(), 3);
  EXPECT_EQ(robot.joints[0].source, "link upper with cover, rail");
}

}  // namespace
}  // namespace offnominal::test
