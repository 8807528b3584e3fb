#include "inertial/identify.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "identify/inertial_regressor.hpp"
#include "inertial/base_parameters.hpp"
#include "inertial/pseudo_inertia.hpp"
#include "mujoco_plant.hpp"
#include "robot/robot_file.hpp"

// Identification on arms whose recordings are MuJoCo's.

namespace offnominal::test {
namespace {

using desk::Identification;
using desk::IdentifiedDrive;
using desk::IdentifiedNumber;
using desk::IdentifyRequest;
using desk::Log;
using desk::RobotDescription;
using testing::HasSubstr;

IdentifyRequest request() {
  IdentifyRequest request;
  request.source = "a test";
  return request;
}

void expect_realisable(const Identification& result) {
  for (const desk::RobotJoint& one : result.robot.joints) {
    const desk::PseudoInertia inertia =
        desk::pseudo_inertia_of(desk::inertial_numbers_of(one.joint));
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<desk::PseudoInertia>(inertia).eigenvalues().minCoeff(),
              0)
        << one.name;
    EXPECT_EQ(validate(one.joint), Status::kOk) << one.name;
  }
  EXPECT_NO_THROW(
      static_cast<void>(desk::parse_robot(desk::robot_text(result.robot), "identified")));
}

const IdentifiedNumber& drive(const Identification& result, EffectKind kind, std::size_t joint) {
  const auto at = std::find_if(
      result.drives.begin(), result.drives.end(),
      [&](const IdentifiedDrive& one) { return one.kind == kind && one.joint == joint; });
  if (at == result.drives.end()) throw std::runtime_error("no such drive");
  return at->number;
}

// The base parameters of an arm, in the order of a result of identify(): rotors included.
std::vector<double> true_base(const RobotDescription& truth, const std::vector<PlantDrive>& drives,
                              const std::vector<IdentifiedNumber>& base) {
  desk::BaseRequest whole;
  for (std::size_t i = 0; i < truth.joints.size(); ++i) {
    whole.links.push_back(i);
    whole.moves.push_back(1);
    whole.stands_at.push_back(0);
    whole.rotors.push_back(i);
  }
  const auto apart = desk::rotors_apart(truth, whole);
  whole.rotors = apart;
  const desk::BaseParameters of = desk::base_parameters(truth, whole);
  EXPECT_EQ(static_cast<std::size_t>(of.count()), base.size());
  Eigen::VectorXd numbers(of.combinations.cols());
  for (std::size_t i = 0; i < truth.joints.size(); ++i) {
    numbers.segment<10>(static_cast<Eigen::Index>(10 * i)) =
        desk::inertial_numbers_of(truth.joints[i].joint);
  }
  for (std::size_t i = 0; i < apart.size(); ++i) {
    numbers[static_cast<Eigen::Index>(10 * truth.joints.size() + i)] = drives[apart[i]].rotor;
  }
  const Eigen::VectorXd values = of.combinations * numbers;
  return {values.begin(), values.end()};
}

struct Coverage {
  int inside = 0;
  int all = 0;
};

void count(const RobotDescription& truth, const std::vector<PlantDrive>& drives,
           const Identification& result, Coverage& coverage) {
  const std::vector<double> values = true_base(truth, drives, result.base);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const IdentifiedNumber& one = result.base[i];
    if (!one.determined || !one.ci95) continue;
    ++coverage.all;
    coverage.inside += values[i] >= (*one.ci95)[0] && values[i] <= (*one.ci95)[1];
  }
}

double worst_held_out(const Identification& result) {
  double worst = 0;
  for (const auto& error : result.held_out) worst = std::max(worst, error.after_percent);
  return worst;
}

TEST(Identify, FindsABaseWithinItsIntervalsFromCadThatIsOffByThirtyPercent) {
  const RobotDescription truth = plain_arm(3);
  const auto drives = plain_drives(3);
  MujocoPlant plant(truth, drives);
  Coverage coverage;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    PlantMotion motion;
    motion.duration_s = 25;
    motion.seed = seed;
    const std::vector<Log> logs{plant.record(motion)};
    const Identification result = identify(with_poor_cad(truth, 0.3, seed), request(), logs, {});
    EXPECT_TRUE(result.objections.empty());
    EXPECT_TRUE(result.doubts.empty());
    expect_realisable(result);
    count(truth, drives, result, coverage);
    EXPECT_GE(result.determined_count(), result.base.size() * 3 / 4);
    EXPECT_LT(worst_held_out(result), 3);
    for (const auto& error : result.held_out) EXPECT_LT(error.after_rms, 0.03);  // the noise's
  }
  std::cout << "inside: " << coverage.inside << " of " << coverage.all << '\n';
  EXPECT_GE(coverage.inside, 0.88 * coverage.all);
  EXPECT_GE(coverage.all, 60);
}

TEST(Identify, FindsTheStandardDriveOfEveryJoint) {
  const RobotDescription truth = plain_arm(3);
  const auto drives = plain_drives(3);
  MujocoPlant plant(truth, drives);
  PlantMotion motion;
  motion.duration_s = 25;
  const std::vector<Log> logs{plant.record(motion)};
  const Identification result = identify(with_poor_cad(truth, 0.2, 3), request(), logs, {});
  for (std::size_t joint = 0; joint < 3; ++joint) {
    EXPECT_NEAR(drive(result, EffectKind::kViscousFriction, joint).after, drives[joint].viscous,
                0.03);
    EXPECT_NEAR(drive(result, EffectKind::kCoulombFriction, joint).after, drives[joint].coulomb,
                0.03);
    EXPECT_NEAR(drive(result, EffectKind::kTorqueOffset, joint).after, drives[joint].offset, 0.03);
  }
  EXPECT_NEAR(drive(result, EffectKind::kRotorInertia, 2).after, drives[2].rotor, 0.01);
  EXPECT_THAT(result.notes, testing::Contains(HasSubstr("rotor's inertia of joint 1")));
}

// GIVEN a rotor behind a gear of a hundred, twenty times the inertia of its link, on a joint about
// whose axis no motion tells the two apart WHEN the file knows the links THEN it is a rotor, and no
// link of a ton.
TEST(Identify, TakesABigRotorOutOfALinkThatCannotBeSoHeavy) {
  const RobotDescription truth = plain_arm(3);
  std::vector<PlantDrive> drives = plain_drives(3);
  drives[1].rotor = 4;
  MujocoPlant plant(truth, drives);
  PlantMotion motion;
  motion.duration_s = 25;
  const std::vector<Log> logs{plant.record(motion)};
  const Identification result = identify(with_poor_cad(truth, 0.1, 3), request(), logs, {});
  EXPECT_TRUE(result.doubts.empty());
  EXPECT_LE(result.share, 0.15);
  EXPECT_NEAR(drive(result, EffectKind::kRotorInertia, 1).after, drives[1].rotor, 0.4);
  EXPECT_FALSE(drive(result, EffectKind::kRotorInertia, 1).determined);
  EXPECT_FALSE(drive(result, EffectKind::kRotorInertia, 1).ci95.has_value());
  EXPECT_TRUE(drive(result, EffectKind::kRotorInertia, 2).ci95.has_value());
  EXPECT_THAT(result.notes, testing::Contains(HasSubstr("with rotors of their own")));
  expect_realisable(result);
}

TEST(Identify, NeedsNoMoreThanTheGeometry) {
  const RobotDescription truth = plain_arm(3);
  MujocoPlant plant(truth, plain_drives(3));
  PlantMotion motion;
  motion.duration_s = 25;
  const std::vector<Log> logs{plant.record(motion)};
  motion.seed = 9;
  const std::vector<Log> holdout{plant.record(motion)};
  RobotDescription blank = truth;
  for (desk::RobotJoint& one : blank.joints) {
    one.joint.mass_kg = 1;
    one.joint.centre_of_mass_m = {};
    one.joint.inertia_kg_m2 = {};
  }
  IdentifyRequest geometry = request();
  blank.blanks = {{0, "mass_kg"}, {1, "mass_kg"}, {2, "mass_kg"}};
  const Identification result = identify(blank, geometry, logs, holdout);
  EXPECT_TRUE(result.objections.empty());
  EXPECT_FALSE(result.before.has_value());
  EXPECT_TRUE(std::isnan(result.held_out[0].before_percent));
  EXPECT_FALSE(result.cross_validated);
  EXPECT_LT(worst_held_out(result), 3);
  expect_realisable(result);
}

TEST(Identify, GivesAnArmOfSixJointsItsTorques) {
  const RobotDescription truth = plain_arm(6);
  MujocoPlant plant(truth, plain_drives(6));
  PlantMotion motion;
  motion.rate_hz = 300;
  const std::vector<Log> logs{plant.record(motion)};
  motion.seed = 5;
  const std::vector<Log> holdout{plant.record(motion)};
  const Identification result = identify(with_poor_cad(truth, 0.3, 4), request(), logs, holdout);
  EXPECT_TRUE(result.objections.empty());
  expect_realisable(result);
  for (const auto& error : result.held_out) {
    EXPECT_LT(error.after_rms, 0.05) << error.joint;
    EXPECT_LT(error.after_rms, 0.3 * error.before_rms) << error.joint;
  }
}

TEST(Identify, LeavesARightFileAsItIsBelieved) {
  const RobotDescription truth = plain_arm(2);
  MujocoPlant plant(truth, plain_drives(2));
  const std::vector<Log> logs{plant.record({})};
  const Identification result = identify(truth, request(), logs, {});
  EXPECT_EQ(result.share, 0.05);
  for (const auto& link : result.links) {
    EXPECT_NEAR(link.mass.after, link.mass.before, 0.05 * link.mass.before);
  }
}

TEST(Identify, LeavesTheDriveOfAJointThatStandsAndSaysSo) {
  const RobotDescription truth = plain_arm(3);
  MujocoPlant plant(truth, plain_drives(3));
  PlantMotion motion;
  motion.standing = {1};
  const std::vector<Log> logs{plant.record(motion)};
  const Identification result = identify(with_poor_cad(truth, 0.2, 2), request(), logs, {});
  EXPECT_THAT(result.standing, testing::ElementsAre(1));
  EXPECT_THAT(result.notes, testing::Contains(HasSubstr("joint 2 stands")));
  for (const IdentifiedDrive& one : result.drives) EXPECT_NE(one.joint, 1U);
  for (const auto& effect : result.robot.effects) EXPECT_NE(effect.joint, 1);
  expect_realisable(result);
}

TEST(Identify, WritesBodiesThatThereCanBeOnPoorAndShortRecordings) {
  const RobotDescription truth = plain_arm(2);
  MujocoPlant plant(truth, plain_drives(2));
  for (const double duration_s : {1.2, 4.0}) {
    for (const double amplitude : {0.01, 0.3}) {
      PlantMotion motion;
      motion.duration_s = duration_s;
      motion.amplitude = amplitude;
      motion.torque_noise = 0.3;
      const std::vector<Log> logs{plant.record(motion)};
      IdentifyRequest geometry = request();
      geometry.from_geometry = true;
      expect_realisable(identify(truth, geometry, logs, {}));
      expect_realisable(identify(with_poor_cad(truth, 0.3, 1), request(), logs, {}));
    }
  }
}

TEST(Identify, RefusesWhereNothingMoves) {
  const RobotDescription truth = plain_arm(2);
  MujocoPlant plant(truth, plain_drives(2));
  PlantMotion motion;
  motion.duration_s = 4;
  motion.standing = {0, 1};
  const std::vector<Log> logs{plant.record(motion)};
  const Identification result = identify(truth, request(), logs, {});
  EXPECT_FALSE(result.may_be_written(true));
  EXPECT_THAT(result.objections, testing::Contains(HasSubstr("no joint moves")));
}

TEST(Identify, FitsEffectsOfTheFileAgainUnlessTheyAreKept) {
  RobotDescription truth = plain_arm(2);
  const auto drives = plain_drives(2);
  MujocoPlant plant(truth, drives);
  const std::vector<Log> logs{plant.record({})};
  desk::RobotEffect viscous;
  viscous.kind = EffectKind::kViscousFriction;
  viscous.parameters = {2 * drives[0].viscous};
  truth.effects.push_back(viscous);
  const Identification again = identify(truth, request(), logs, {});
  EXPECT_NEAR(again.robot.effects[0].parameters[0], drives[0].viscous, 0.05);
  EXPECT_TRUE(again.robot.effects[0].fitted);
  IdentifyRequest keep = request();
  keep.keep = true;
  const Identification kept = identify(truth, keep, logs, {});
  EXPECT_EQ(kept.robot.effects[0].parameters[0], viscous.parameters[0]);
}

TEST(Identify, IsTheSameEveryTime) {
  const RobotDescription truth = plain_arm(2);
  MujocoPlant plant(truth, plain_drives(2));
  PlantMotion motion;
  motion.duration_s = 8;
  const std::vector<Log> logs{plant.record(motion)};
  const RobotDescription cad = with_poor_cad(truth, 0.3, 1);
  EXPECT_EQ(desk::robot_text(identify(cad, request(), logs, {}).robot),
            desk::robot_text(identify(cad, request(), logs, {}).robot));
}

}  // namespace
}  // namespace offnominal::test
