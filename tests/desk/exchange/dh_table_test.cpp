#include "exchange/dh_table.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <kdl/frames.hpp>
#include <numbers>
#include <random>

#include "common/error.hpp"
#include "desk/support/temporary_file.hpp"
#include "desk/support/temporary_folder.hpp"
#include "exchange/blank_robot.hpp"
#include "robot/robot_file.hpp"
#include "support/places.hpp"
#include "support/repetitions.hpp"
#include "support/seed.hpp"

namespace offnominal::test {
namespace {

using desk::InputError;
using desk::exchange::DhConvention;
using desk::exchange::DhRow;
using desk::exchange::DhTable;
using desk::exchange::joints_of;
using desk::exchange::read_dh_table;
using testing::HasSubstr;

DhTable random_table(std::mt19937_64& generator, DhConvention convention) {
  std::uniform_real_distribution<double> number(-std::numbers::pi, std::numbers::pi);
  DhTable table{convention, {}, {}};
  for (int i = 0; i < 6; ++i) {
    const JointType type = generator() % 4 == 0 ? JointType::kPrismatic : JointType::kRevolute;
    table.rows.push_back({"j" + std::to_string(i), type, number(generator), number(generator),
                          number(generator), number(generator)});
  }
  return table;
}

KDL::Frame by_kdl(const DhRow& row, DhConvention convention, double q) {
  const bool turns = row.type == JointType::kRevolute;
  const double theta = row.theta_rad + (turns ? q : 0);
  const double d = row.d_m + (turns ? 0 : q);
  return convention == DhConvention::kStandard
             ? KDL::Frame::DH(row.a_m, row.alpha_rad, d, theta)
             : KDL::Frame::DH_Craig1989(row.a_m, row.alpha_rad, d, theta);
}

Eigen::Isometry3d moved(const Joint<double>& joint, double q, bool itself) {
  Eigen::Isometry3d place = Eigen::Isometry3d::Identity();
  place.linear() =
      Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(joint.rotation.data());
  place.translation() = Eigen::Vector3d(joint.origin_m.data());
  if (!itself) return place;
  const Eigen::Vector3d axis(joint.axis.data());
  if (joint.type == JointType::kRevolute) return place * Eigen::AngleAxisd(q, axis);
  return place * Eigen::Translation3d(q * axis);
}

double difference(const Eigen::Isometry3d& ours, const KDL::Frame& theirs) {
  double worst = 0;
  for (int i = 0; i < 3; ++i) {
    worst = std::max(worst, std::fabs(ours.translation()[i] - theirs.p(i)));
    for (int j = 0; j < 3; ++j) {
      worst = std::max(worst, std::fabs(ours.linear()(i, j) - theirs.M(i, j)));
    }
  }
  return worst;
}

// In the modified convention link i has the table's frame i. In the standard one joint i stands
// where the table's frame i-1 does, and the rest of row i follows.
TEST(DhTable, PlacesEveryFrameWhereKdlDoes) {
  std::mt19937_64 generator = seeded_generator();
  double worst = 0;
  for (int i = 0; i < repetitions(500); ++i) {
    for (const DhConvention convention : {DhConvention::kStandard, DhConvention::kModified}) {
      const DhTable table = random_table(generator, convention);
      const auto joints = joints_of(table);
      ASSERT_EQ(joints.size(), table.rows.size());
      KDL::Frame theirs = KDL::Frame::Identity();
      Eigen::Isometry3d ours = Eigen::Isometry3d::Identity();
      for (std::size_t j = 0; j < joints.size(); ++j) {
        const double q = std::uniform_real_distribution<double>(-3, 3)(generator);
        const KDL::Frame row = by_kdl(table.rows[j], convention, q);
        if (convention == DhConvention::kStandard) {
          worst = std::max(worst, difference(ours * moved(joints[j].joint, q, false), theirs));
        }
        theirs = theirs * row;
        ours = ours * moved(joints[j].joint, q, true);
        if (convention == DhConvention::kModified) {
          worst = std::max(worst, difference(ours, theirs));
        }
      }
    }
  }
  EXPECT_LE(worst, 1e-12);
}

DhTable read(const std::string& name, const std::string& text,
             std::optional<DhConvention> convention = std::nullopt) {
  const TemporaryFolder folder;
  put(folder / name, text);
  return read_dh_table(folder / name, convention);
}

TEST(DhTable, IsReadAlikeFromCsvAndToml) {
  const DhTable csv = read("arm.csv",
                           "joint,a_m,alpha_deg,d_m,theta_rad,prismatic\n"
                           "1,0.5,90,0.1,0.2,0\n2,0,-90,0.3,0,1\n",
                           DhConvention::kModified);
  const DhTable toml = read("arm.toml", R"(convention = "modified"
    [[joint]]
    a_m = 0.5
    alpha_deg = 90
    d_m = 0.1
    theta_rad = 0.2
    [[joint]]
    type = "prismatic"
    a_m = 0
    alpha_rad = -1.5707963267948966
    d_m = 0.3
    theta_deg = 0
  )");
  ASSERT_EQ(csv.rows.size(), 2U);
  ASSERT_EQ(toml.rows.size(), 2U);
  EXPECT_EQ(toml.convention, DhConvention::kModified);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(csv.rows[i].name, toml.rows[i].name);
    EXPECT_EQ(csv.rows[i].type, toml.rows[i].type);
    EXPECT_EQ(csv.rows[i].a_m, toml.rows[i].a_m);
    EXPECT_DOUBLE_EQ(csv.rows[i].alpha_rad, toml.rows[i].alpha_rad);
    EXPECT_EQ(csv.rows[i].d_m, toml.rows[i].d_m);
    EXPECT_EQ(csv.rows[i].theta_rad, toml.rows[i].theta_rad);
  }
  EXPECT_EQ(csv.rows[1].type, JointType::kPrismatic);
  EXPECT_DOUBLE_EQ(csv.rows[0].alpha_rad, std::numbers::pi / 2);
}

// By whatever name it comes: only .toml says that it is none.
TEST(DhTable, IsCsvUnlessItsNameSaysToml) {
  const std::string csv = "a_m,alpha_deg,d_m,theta_deg\n0.5,90,0,0\n";
  const std::string toml = "[[joint]]\na_m = 0.5\nalpha_deg = 90\nd_m = 0\ntheta_deg = 0\n";
  for (const auto& [name, text] : {std::pair("ARM.CSV", csv), std::pair("arm.txt", csv),
                                   std::pair("arm", csv), std::pair("ARM.TOML", toml)}) {
    EXPECT_EQ(read(name, text, DhConvention::kModified).rows.at(0).a_m, 0.5) << name;
  }
}

TEST(DhTable, SaysWhereANumberIsNone) {
  const auto refusal = [](const std::string& name, const std::string& text) {
    return message_of<InputError>(
        [&] { static_cast<void>(read(name, text, DhConvention::kStandard)); });
  };
  const std::string header = "a_m,alpha_deg,d_m,theta_deg\n0.1,90,0,0\n";
  EXPECT_THAT(refusal("a.csv", header + "0.1,,0,0\n"),
              HasSubstr("line 3, column alpha_deg: found no finite number; allowed: a number of at "
                        "most 1e+05; to mend: write 0 where there is nothing"));
  EXPECT_THAT(refusal("a.csv", header + "inf,0,0,0\n"), HasSubstr("line 3, column a_m: found no"));
  EXPECT_THAT(
      refusal("a.csv", header + "0,1e300,0,0\n"),
      HasSubstr("line 3, column alpha_deg: found 1e+300; allowed: a number of at most 1e+05; "
                "to mend: check the unit"));
  EXPECT_THAT(refusal("a.toml", "[[joint]]\na_m = 0\nalpha_deg = 1e300\nd_m = 0\ntheta_deg = 0\n"),
              HasSubstr("line 3, joint[1].alpha_deg: found 1e+300"));
  EXPECT_THAT(refusal("a.csv", ""), HasSubstr("found an empty file; allowed: a DH table"));
  EXPECT_THAT(refusal("a.toml", ""), HasSubstr("found 0 joints; allowed: 1 to 12, a row each; to "
                                               "mend: write a row for each joint"));
}

TEST(DhTable, AnglesMayBeSharesOfPi) {
  const double pi = std::numbers::pi;
  const std::pair<const char*, double> angles[] = {
      {"pi/2", pi / 2},           {"-pi/2", -pi / 2},  {"pi", pi},        {"2*pi/3", 2 * pi / 3},
      {"-2 pi / 3", -2 * pi / 3}, {"0.5pi", pi / 2},   {"+PI/4", pi / 4}, {"3/4*pi", 3 * pi / 4},
      {"pi*3/4", 3 * pi / 4},     {"\u03c0/2", pi / 2}};
  for (const auto& [text, angle] : angles) {
    const std::string cell = text;
    const DhTable csv =
        read("a.csv", "a_m,alpha_rad,d_m,theta_rad\n0," + cell + ",0,0\n", DhConvention::kStandard);
    EXPECT_DOUBLE_EQ(csv.rows[0].alpha_rad, angle) << text;
    const DhTable toml =
        read("a.toml", "[[joint]]\na_m = 0\nalpha_rad = \"" + cell + "\"\nd_m = 0\ntheta_rad = 0\n",
             DhConvention::kStandard);
    EXPECT_DOUBLE_EQ(toml.rows[0].alpha_rad, angle) << text;
  }
}

TEST(DhTable, SaysWhatToWriteForAnAngleThatIsNone) {
  const auto refusal = [](const std::string& name, const std::string& text) {
    return message_of<InputError>(
        [&] { static_cast<void>(read(name, text, DhConvention::kStandard)); });
  };
  EXPECT_THAT(refusal("a.csv", "a_m,alpha_deg,d_m,theta_deg\n0,-pi/2,0,0\n"),
              HasSubstr("line 2, column alpha_deg: found \"-pi/2\", an angle in rad; allowed: a "
                        "number of degrees; to mend: write -90, or name it alpha_rad"));
  EXPECT_THAT(refusal("a.toml", "[[joint]]\na_m = \"pi\"\nalpha_rad = 0\nd_m = 0\ntheta_rad = 0\n"),
              HasSubstr("joint[1].a_m: found \"pi\", an angle in rad; allowed: a number, in m"));
  for (const char* wrong : {"pi/0", "pie", "pi/", "2*", "pi/-2", "half"}) {
    EXPECT_THAT(refusal("a.csv", "a_m,alpha_rad,d_m,theta_rad\n0," + std::string(wrong) + ",0,0\n"),
                HasSubstr("line 2, column alpha_rad: found \"" + std::string(wrong) + "\""))
        << wrong;
  }
}

TEST(DhTable, IsInTheUnitThatItsNamesSay) {
  const DhTable table =
      read("a.csv", "a_mm,alpha_deg,d_mm,theta_rad\n300,90,-25.5,0\n", DhConvention::kStandard);
  EXPECT_DOUBLE_EQ(table.rows[0].a_m, 0.3);
  EXPECT_DOUBLE_EQ(table.rows[0].d_m, -0.0255);
  EXPECT_TRUE(table.notes.empty());
  // The largest that may be meant.
  EXPECT_EQ(
      read("a.csv", "a_m,alpha_rad,d_m,theta_rad\n17,6.2832,0,-6.2832\n", DhConvention::kStandard)
          .rows[0]
          .a_m,
      17);
}

TEST(DhTable, TheSampleInMillimetresIsRead) {
  const DhTable table =
      read_dh_table(source_dir() / "tests" / "fuzz" / "corpus" / "dh" / "millimetres.csv",
                    DhConvention::kStandard);
  ASSERT_EQ(table.rows.size(), 2U);
  EXPECT_DOUBLE_EQ(table.rows[0].d_m, 0.4);
  EXPECT_DOUBLE_EQ(table.rows[1].a_m, 0.3);
}

TEST(DhTable, NumbersOfAnotherUnitThanTheNameSaysAreRefused) {
  const auto refusal = [](const std::string& name, const std::string& text) {
    return message_of<InputError>(
        [&] { static_cast<void>(read(name, text, DhConvention::kStandard)); });
  };
  EXPECT_THAT(refusal("a.csv", "a_m,alpha_rad,d_m,theta_rad\n0,0,0,0\n0,-90,0.4,0\n"),
              HasSubstr("line 3, column alpha_rad: found -90 rad, which is degrees by its size; "
                        "allowed: an angle of at most one turn, 2 pi; to mend: name it alpha_deg "
                        "where it is in deg, or write it in rad"));
  EXPECT_THAT(refusal("a.csv", "a_m,alpha_deg,d_m,theta_deg\n0,90,400,0\n"),
              HasSubstr("line 2, column d_m: found 400 m, which is millimetres by its size; "
                        "allowed: a length of at most 20 m; to mend: name it d_mm"));
  EXPECT_THAT(refusal("a.toml", "[[joint]]\na_m = 400\nalpha_deg = 90\nd_m = 0\ntheta_deg = 0\n"),
              HasSubstr("line 2, joint[1].a_m: found 400 m"));
  EXPECT_THAT(refusal("a.toml", "[[joint]]\na_m = 0\nalpha_deg = 90\nd_m = 0\ntheta_rad = 180\n"),
              HasSubstr("line 5, joint[1].theta_rad: found 180 rad"));
}

TEST(DhTable, ATitleAboveItIsLeftOutAndTold) {
  const DhTable table =
      read("a.csv", "Arm 7, data sheet\na_m,alpha_deg,d_m,theta_deg\n0,90,0.4,0\n",
           DhConvention::kStandard);
  EXPECT_EQ(table.rows.size(), 1U);
  EXPECT_THAT(table.notes, testing::ElementsAre("line 1 stands before the header: left out"));
}

TEST(DhTable, NumbersThatMayBeOfAnotherUnitAreTold) {
  const DhTable table =
      read("a.csv", "a_mm,alpha_deg,d_mm,theta_deg\n0,1.5708,0.4,-3.1416\n0.3,-1.5708,0,12\n",
           DhConvention::kStandard);
  EXPECT_THAT(table.notes,
              testing::ElementsAre(
                  "alpha_deg = 1.5708 is pi/2 as radians: name it alpha_rad where that is meant",
                  "theta_deg = -3.1416 is -pi as radians: name it theta_rad where that is meant",
                  "no length is above 0.4 mm: name them a_m and d_m where metres are meant"));
}

// A count of the joints is no order of its own, and may be names.
TEST(DhTable, StandsInTheOrderOfItsJoints) {
  const auto with = [](const std::string& first, const std::string& second) {
    return "joint,a_m,alpha_deg,d_m,theta_deg\n" + first + ",0,90,0.4,0\n" + second +
           ",0.3,0,0,0\n";
  };
  for (const auto& [first, second] : {std::pair{"1", "2"}, {"0", "1"}, {"shoulder", "elbow"}}) {
    const DhTable table = read("a.csv", with(first, second), DhConvention::kStandard);
    ASSERT_EQ(table.rows.size(), 2U) << first;
    EXPECT_EQ(table.rows[1].a_m, 0.3) << first;
  }
  EXPECT_THAT(
      message_of<InputError>(
          [&] { static_cast<void>(read("a.csv", with("2", "1"), DhConvention::kStandard)); }),
      HasSubstr("line 2, column joint: found 2; allowed: 1, as the rows stand from the base "
                "outwards; to mend: put the rows in the order of the joints"));
}

TEST(DhTable, IsRefusedWhereItCanBeReadInTwoWays) {
  const auto refusal = [](const std::string& name, const std::string& text,
                          std::optional<DhConvention> convention = std::nullopt) {
    return message_of<InputError>([&] { static_cast<void>(read(name, text, convention)); });
  };
  const std::string row = "\n0,0,0,0\n";
  EXPECT_THAT(refusal("a.csv", "a_m,alpha_rad,d_m,theta_rad" + row),
              HasSubstr("no word on whether the table is a standard or a modified one"));
  const auto standard = DhConvention::kStandard;
  EXPECT_THAT(refusal("a.csv", "a_m,alpha,d_m,theta_rad" + row, standard),
              HasSubstr("column alpha: found a column that is none of a DH table"));
  EXPECT_THAT(refusal("a.csv", "a_m,alpha_rad,alpha_deg,d_m" + row, standard),
              HasSubstr("found both alpha_rad and alpha_deg"));
  EXPECT_THAT(refusal("a.csv", "a_m,alpha_rad,d_m,prismatic" + row, standard),
              HasSubstr("found neither theta_rad nor theta_deg"));
  EXPECT_THAT(refusal("a.csv", "alpha_rad,theta_rad,d_m,prismatic" + row, standard),
              HasSubstr("found neither a_m nor a_mm"));
  EXPECT_THAT(refusal("a.csv", "a_m,alpha_rad,d_m,theta_rad,prismatic\n0,0,0,0,0.5\n", standard),
              HasSubstr("line 2, column prismatic: found 0.5; allowed: 0 or 1"));
  EXPECT_THAT(refusal("a.toml", "convention = \"modified\"\n", standard),
              HasSubstr("convention: found modified, and --convention standard"));
  EXPECT_THAT(refusal("a.toml", "convention = \"modified\"\n"), HasSubstr("found 0 joints"));
  EXPECT_THAT(refusal("a.toml", "convention = \"craig\"\n"), HasSubstr("line 1, convention"));
}

TEST(BlankRobot, NamesTheFirstBlankAndIsReadOnceTheyAreFilledIn) {
  const DhTable table = read("arm.csv", "a_m,alpha_deg,d_m,theta_deg\n0,90,0.4,0\n0.3,0,0,0\n",
                             DhConvention::kStandard);
  std::string text = desk::exchange::blank_robot_text(table, "arm", "/tables/arm.csv");
  EXPECT_THAT(text, HasSubstr("# Written from the standard DH table arm.csv by `offnominal new`."));
  EXPECT_THAT(text, HasSubstr("stands at [0.3, 0, 0] m"));
  const std::string refusal =
      message_of<InputError>([&] { static_cast<void>(desk::parse_robot(text, "arm.toml")); });
  EXPECT_THAT(refusal, HasSubstr("joint[1].link.mass_kg: found nothing: the key is missing"));
  for (const auto& [blank, number] :
       {std::pair("# mass_kg = ", "mass_kg = 2.0 "),
        std::pair("# centre_of_mass_m = ", "centre_of_mass_m = [0.1, 0.0, 0.0] ")}) {
    for (auto at = text.find(blank); at != std::string::npos; at = text.find(blank)) {
      text.replace(at, std::string(blank).size(), number);
    }
  }
  const desk::RobotDescription robot = desk::parse_robot(text, "arm.toml");
  ASSERT_EQ(robot.joint_count(), 2);
  EXPECT_EQ(robot.joints[1].joint.mass_kg, 2);
  EXPECT_EQ(robot.joints[1].joint.origin_m[2], 0.4);
}

}  // namespace
}  // namespace offnominal::test
