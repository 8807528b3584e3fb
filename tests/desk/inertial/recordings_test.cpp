#include "support/recordings.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "common/error.hpp"
#include "desk/exchange/urdfs.hpp"
#include "desk/support/temporary_folder.hpp"
#include "exchange/import_urdf.hpp"
#include "inertial/identify.hpp"
#include "log/read_log.hpp"
#include "robot/robot_file.hpp"
#include "support/robots.hpp"

// Real machines: numbers that others have published, or that were found by hand.

namespace offnominal::test {
namespace {

using desk::Identification;
using desk::IdentifyRequest;
using desk::Log;
using desk::RobotDescription;

double value_of(const Identification& result, EffectKind kind) {
  for (const auto& one : result.drives) {
    if (one.kind == kind) return one.number.after;
  }
  throw std::runtime_error("no such drive");
}

#define OFFNOMINAL_SKIP_WITHOUT_FILE(file)                                                \
  if (!std::filesystem::exists(file)) {                                                   \
    GTEST_SKIP() << "no recording at " << (file) << "; OFFNOMINAL_DATA names its folder"; \
  }

// A. Janot, M. Gautier, M. Brunot (2019), section 3.4: M 95.109 kg, Fv 203.50, Fc 20.39, offset
// -3.165 N.
TEST(IdentifyEmps, FindsThePublishedNumbersFromTheGeometryAlone) {
  const auto folder = recordings_dir() / "emps";
  OFFNOMINAL_SKIP_WITHOUT_FILE(folder / "DATA_EMPS.mat");
  const RobotDescription robot = desk::read_robot_file(kRobots / "emps.toml");
  const std::vector<Log> logs{desk::read_log(folder / "DATA_EMPS.mat", robot, {})};
  const std::vector<Log> holdout{desk::read_log(folder / "DATA_EMPS_PULSES.mat", robot, {})};
  IdentifyRequest request;
  request.source = "a test";
  request.from_geometry = true;
  const Identification result = identify(robot, request, logs, holdout);
  EXPECT_TRUE(result.objections.empty());
  EXPECT_NEAR(result.robot.joints[0].joint.mass_kg, 95.1, 1);
  EXPECT_NEAR(value_of(result, EffectKind::kViscousFriction), 203.5, 4);
  EXPECT_NEAR(value_of(result, EffectKind::kCoulombFriction), 20.39, 0.5);
  EXPECT_NEAR(value_of(result, EffectKind::kTorqueOffset), -3.165, 0.1);
  EXPECT_LT(result.held_out[0].after_percent, 6);
  EXPECT_GT(result.held_out[0].before_percent, 60);
}

// SOURCE.txt: Coulomb 0.18 to 0.29 N m, viscous about 0, m g l 3.3 N m, off CAD by 5 to 15 %.
TEST(IdentifyPendulum, FindsWeightAndCoulombFrictionFromCadAndFromTheGeometry) {
  const UrdfCase pendulum = all_urdfs().back();
  OFFNOMINAL_SKIP_WITHOUT(pendulum);
  const RobotDescription robot =
      desk::exchange::import_urdf(pendulum.text(), pendulum.file.string(), pendulum.chain()).robot;
  const TemporaryFolder folder;
  put(folder / "channels.toml",
      "time = \"time\"\nposition = [\"position\"]\nvelocity = [\"velocity\"]\n"
      "torque = [\"torque\"]\n");
  desk::ChannelOptions channels;
  channels.file = folder / "channels.toml";
  const std::vector<Log> logs{
      desk::read_log(pendulum.file.parent_path() / "ddp.csv", robot, channels)};
  for (const bool from_geometry : {false, true}) {
    IdentifyRequest request;
    request.source = "a test";
    request.from_geometry = from_geometry;
    const Identification result = identify(robot, request, logs, {});
    EXPECT_TRUE(result.objections.empty());
    EXPECT_GT(value_of(result, EffectKind::kCoulombFriction), 0.15);
    EXPECT_LT(value_of(result, EffectKind::kCoulombFriction), 0.32);
    const Joint<double>& link = result.robot.joints[0].joint;
    const Eigen::Vector3d axis(link.axis.data());
    const Eigen::Vector3d centre(link.centre_of_mass_m.data());
    const double lever = (centre - axis * axis.dot(centre)).norm();
    EXPECT_NEAR(9.81 * link.mass_kg * lever, 3.1, 0.5) << from_geometry;
    EXPECT_LT(result.fitted[0].after_rms, 0.25) << from_geometry;
    EXPECT_LT(result.held_out[0].after_rms, 0.7 * result.held_out[0].before_rms);
  }
}

// The first axis of a one-ton arm, motor side: SOURCE.txt has viscous 6.4 to 7.4 N m s/rad, Coulomb
// 1.4 to 1.7 N m, and 0.8 to 1.0 N m left of it.
TEST(IdentifyKuka, FindsTheFrictionOfItsFirstAxis) {
  const auto folder = recordings_dir() / "kuka_kr300";
  OFFNOMINAL_SKIP_WITHOUT_FILE(folder / "A.mat");
  RobotDescription robot;
  robot.name = "kr300 axis 1";
  robot.gravity_m_s2 = {0, 0, -9.81};
  robot.joints.resize(1);
  robot.joints[0].name = "axis 1";
  robot.joints[0].joint.inertia_kg_m2 = {1, 1, 1, 0, 0, 0};
  const TemporaryFolder scratch;
  put(scratch / "channels.toml",
      "time = \"rec.time_cont\"\n"
      "position = [{source = \"rec.act_pos_mot_deg(1,:)\", unit = \"deg\"}]\n"
      "torque = [\"rec.act_torque_abs_nm(1,:)\"]\n");
  desk::ChannelOptions channels;
  channels.file = scratch / "channels.toml";
  std::vector<Log> logs;
  for (const char* name : {"A.mat", "B.mat"}) {
    logs.push_back(desk::read_log(folder / name, robot, channels));
  }
  const std::vector<Log> holdout{desk::read_log(folder / "C.mat", robot, channels)};
  IdentifyRequest request;
  request.source = "a test";
  request.from_geometry = true;
  const Identification result = identify(robot, request, logs, holdout);
  EXPECT_TRUE(result.objections.empty());
  EXPECT_GT(value_of(result, EffectKind::kViscousFriction), 6);
  EXPECT_LT(value_of(result, EffectKind::kViscousFriction), 7.8);
  EXPECT_GT(value_of(result, EffectKind::kCoulombFriction), 1.2);
  EXPECT_LT(value_of(result, EffectKind::kCoulombFriction), 1.9);
  EXPECT_LT(result.held_out[0].after_rms, 1.0);
  EXPECT_LT(result.held_out[0].after_percent, 33);
}

}  // namespace
}  // namespace offnominal::test
