#include "exchange/blank_robot.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>

#include "common/error.hpp"
#include "common/input_name.hpp"
#include "common/json_text.hpp"
#include "common/number.hpp"
#include "exchange/rigid_body.hpp"
#include "robot/robot_file.hpp"

namespace offnominal::desk::exchange {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

// Of both conventions, where the joint is at 0.
Isometry3d about_x(const DhRow& row) {
  Isometry3d placement(Eigen::AngleAxisd(row.alpha_rad, Vector3d::UnitX()));
  placement.translation() = Vector3d(row.a_m, 0, 0);
  return placement;
}
Isometry3d about_z(const DhRow& row) {
  Isometry3d placement(Eigen::AngleAxisd(row.theta_rad, Vector3d::UnitZ()));
  placement.translation() = Vector3d(0, 0, row.d_m);
  return placement;
}

// Behind the last joint: the flange's frame in that of the last link.
Isometry3d flange_of(const DhTable& table) {
  if (table.convention == DhConvention::kModified) return Isometry3d::Identity();
  return about_z(table.rows.back()) * about_x(table.rows.back());
}

std::string replaced(std::string text, const std::string& old_text, const std::string& new_text) {
  for (auto at = text.find(old_text); at != std::string::npos;
       at = text.find(old_text, at + new_text.size())) {
    text.replace(at, old_text.size(), new_text);
  }
  return text;
}

}  // namespace

std::vector<RobotJoint> joints_of(const DhTable& table) {
  std::vector<RobotJoint> joints;
  Isometry3d before = Isometry3d::Identity();  // what leads to the next joint
  for (const DhRow& row : table.rows) {
    const bool modified = table.convention == DhConvention::kModified;
    RobotJoint joint;
    joint.name = row.name;
    joint.joint.type = row.type;
    put_placement(modified ? about_x(row) * about_z(row) : before, joint.joint);
    before = about_z(row) * about_x(row);
    joints.push_back(joint);
  }
  return joints;
}

std::string blank_robot_text(const DhTable& table, const std::string& name,
                             const std::string& table_file) {
  RobotDescription robot;
  robot.name = name;
  const std::string file = as_utf8(input_name(table_file));
  robot.source = fmt::format("geometry: DH table {} ({})", file, name_of(table.convention));
  robot.joints = joints_of(table);
  std::string text = robot_text(robot);
  // What a link without numbers is written as.
  text =
      replaced(text, "[joint.link]\nmass_kg = 1.0\ncentre_of_mass_m = [0.0, 0.0, 0.0]\n",
               "[joint.link]\n"
               "# mass_kg =            # blank, needed: kg\n"
               "# centre_of_mass_m =   # blank, needed: [x, y, z] in the link's frame, m\n"
               "# inertia_kg_m2 =      # blank: {xx, yy, zz, xy, xz, yz}; left out: a point mass\n"
               "\n[joint.limits]\n"
               "# position =           # blank: [lower, upper], rad or m\n"
               "# velocity =           # blank: rad/s or m/s\n"
               "# torque =             # blank: N m or N\n");
  const Vector3d flange = flange_of(table).translation();
  const std::string frames =
      table.convention == DhConvention::kModified
          ? "A link's frame is the table's frame of the same number."
          : fmt::format(
                "A link's frame is the table's frame before it (number i-1) and turns with "
                "joint i. The flange\n# stands at [{}, {}, {}] m in the last one.",
                shortest(flange.x()), shortest(flange.y()), shortest(flange.z()));
  return fmt::format(
             "# Written from the {} DH table {} by `offnominal new`. Lines with `blank` are not "
             "known:\n"
             "# put the number in and take the first `#` away. What a blank link lacks is named "
             "when "
             "the file is read.\n# {}\n# assumed: gravity of 9.81 m/s^2 along -z of the base\n\n",
             name_of(table.convention), on_one_line(file), frames) +
         text;
}

}  // namespace offnominal::desk::exchange
