#include <fmt/format.h>

#include <cmath>

#include "common/error.hpp"
#include "common/number.hpp"
#include "exchange/export_body.hpp"
#include "exchange/limits.hpp"

namespace offnominal::desk::exchange {
namespace {

using tinyxml2::XMLPrinter;

// What a position is believed up to (docs/robot-file.md), rad or m.
constexpr double kFarthest = 1000;

constexpr const char* kTilt = "world_to_base";  // the joint on which a tilted base stands

// Roll, pitch, yaw about the fixed axes: R = Rz(yaw) Ry(pitch) Rx(roll). Near a pitch of 90 degrees
// only roll and yaw together are determined; with the yaw taken out first, the three fit together
// there too.
std::array<double, 3> rpy_of(const Eigen::Matrix3d& r) {
  const double yaw = std::atan2(r(1, 0), r(0, 0));
  const double s = std::sin(yaw);
  const double c = std::cos(yaw);
  const double pitch = std::atan2(-r(2, 0), c * r(0, 0) + s * r(1, 0));
  const double roll = std::atan2(s * r(0, 2) - c * r(1, 2), c * r(1, 1) - s * r(0, 1));
  return {roll, pitch, yaw};
}

class UrdfWriter {
 public:
  explicit UrdfWriter(const RobotDescription& robot) : robot_(robot) {}

  ExportedRobot write(const std::string& robot_file) {
    joints_ = exported_joints(robot_, {.name = "URDF", .taken = kTilt}, result_);
    const bool tilted = look_at_gravity();
    for (std::size_t i = 0; i < joints_.size(); ++i) {
      look_at_limits(i);
      look_at_inertia(i);
    }
    out_.PushHeader(false, true);
    const std::string comment = head_comment(result_, "export-urdf", robot_file);
    out_.PushComment(comment.c_str());
    out_.OpenElement("robot");
    out_.PushAttribute("name", on_one_line(robot_.name).c_str());
    if (tilted) write_tilt();
    write_bare_link("base");
    for (std::size_t i = 0; i < joints_.size(); ++i) {
      write_link(i);
      write_joint(i);
    }
    out_.CloseElement();
    result_.text = out_.CStr();
    return std::move(result_);
  }

 private:
  std::string link_name(std::size_t index) const { return joints_[index].name + "_link"; }

  // Whether the base has to stand tilted, so that gravity pulls along -z of the root.
  bool look_at_gravity() {
    const Eigen::Vector3d gravity(robot_.gravity_m_s2.data());
    const double size = gravity.norm();
    if (std::fabs(size - 9.81) > 1e-9) {
      result_.not_carried.push_back(
          fmt::format("gravity of {} m/s^2: a URDF has none, readers take 9.81", shortest(size)));
    }
    if (size == 0) return false;
    up_ = -gravity / size;
    const bool tilted = (up_ - Eigen::Vector3d::UnitZ()).norm() > 1e-12;
    if (tilted) {
      result_.changed.emplace_back("gravity's direction: the base stands tilted on `world`");
    }
    return tilted;
  }

  void look_at_limits(std::size_t index) {
    const Joint<double>& joint = robot_.joints[index].joint;
    const std::string& name = joints_[index].name;
    if (joint.type == JointType::kPrismatic && !has_range(joint)) {
      result_.changed.push_back(fmt::format(
          "joint `{}` slides from {} to {} m: URDF asks for a range", name, -kFarthest, kFarthest));
    }
    if (!has_limit(joint)) return;
    if (joint.max_velocity == kUnlimited || joint.max_torque == kUnlimited) {
      result_.changed.push_back(fmt::format(
          "limits of joint `{}` that are not known stand as 0: URDF asks for numbers", name));
    }
  }

  void look_at_inertia(std::size_t index) {
    RigidBody& body = joints_[index].body;
    const Eigen::Matrix3d tensor = loadable_inertia(body);
    if (tensor == body.inertia_kg_m2) return;
    result_.changed.push_back(
        fmt::format("the inertia of the link of joint `{}`, a point mass or a rod: {} kg m^2 are "
                    "added, since simulators take none of zero",
                    joints_[index].name, shortest((tensor - body.inertia_kg_m2)(0, 0))));
    body.inertia_kg_m2 = tensor;
  }

  static bool is_continuous(const Joint<double>& joint) {
    return joint.type == JointType::kRevolute && !has_range(joint);
  }
  static bool has_limit(const Joint<double>& joint) {
    return !is_continuous(joint) || joint.max_velocity != kUnlimited ||
           joint.max_torque != kUnlimited;
  }

  void write_bare_link(const char* name) {
    out_.OpenElement("link");
    out_.PushAttribute("name", name);
    out_.CloseElement();
  }

  void write_ends(const std::string& parent, const std::string& child) {
    out_.OpenElement("parent");
    out_.PushAttribute("link", parent.c_str());
    out_.CloseElement();
    out_.OpenElement("child");
    out_.PushAttribute("link", child.c_str());
    out_.CloseElement();
  }

  void write_origin(std::span<const double> xyz, const std::array<double, 3>& rpy) {
    out_.OpenElement("origin");
    out_.PushAttribute("xyz", numbers(xyz).c_str());
    out_.PushAttribute("rpy", numbers(rpy).c_str());
    out_.CloseElement();
  }

  void write_tilt() {
    write_bare_link("world");
    out_.OpenElement("joint");
    out_.PushAttribute("name", kTilt);
    out_.PushAttribute("type", "fixed");
    // Turns the base's upward direction into z.
    const Eigen::Quaterniond turn =
        Eigen::Quaterniond::FromTwoVectors(up_, Eigen::Vector3d::UnitZ());
    write_origin(std::array{0.0, 0.0, 0.0}, rpy_of(turn.toRotationMatrix()));
    write_ends("world", "base");
    out_.CloseElement();
  }

  void write_link(std::size_t index) {
    const RigidBody& body = joints_[index].body;
    out_.OpenElement("link");
    out_.PushAttribute("name", link_name(index).c_str());
    out_.OpenElement("inertial");
    write_origin(std::span(body.centre_m.data(), 3), {});
    out_.OpenElement("mass");
    out_.PushAttribute("value", shortest(body.mass_kg).c_str());
    out_.CloseElement();
    out_.OpenElement("inertia");
    const char* const names[]{"ixx", "ixy", "ixz", "iyy", "iyz", "izz"};
    const double values[]{body.inertia_kg_m2(0, 0), body.inertia_kg_m2(0, 1),
                          body.inertia_kg_m2(0, 2), body.inertia_kg_m2(1, 1),
                          body.inertia_kg_m2(1, 2), body.inertia_kg_m2(2, 2)};
    for (std::size_t i = 0; i < 6; ++i) {
      out_.PushAttribute(names[i], shortest(values[i] + 0.0).c_str());
    }
    out_.CloseElement();
    out_.CloseElement();
    out_.CloseElement();
  }

  void write_joint(std::size_t index) {
    const Joint<double>& joint = robot_.joints[index].joint;
    out_.OpenElement("joint");
    out_.PushAttribute("name", joints_[index].name.c_str());
    out_.PushAttribute("type", joint.type == JointType::kPrismatic ? "prismatic"
                               : is_continuous(joint)              ? "continuous"
                                                                   : "revolute");
    const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> rotation(
        joint.rotation.data());
    write_origin(joint.origin_m, rpy_of(rotation));
    write_ends(index == 0 ? "base" : link_name(index - 1), link_name(index));
    out_.OpenElement("axis");
    out_.PushAttribute("xyz", numbers(joint.axis).c_str());
    out_.CloseElement();
    if (has_limit(joint)) write_limit(joint);
    const ExportedJoint& exported = joints_[index];
    if (exported.damping != 0 || exported.friction != 0) {
      out_.OpenElement("dynamics");
      out_.PushAttribute("damping", shortest(exported.damping).c_str());
      out_.PushAttribute("friction", shortest(exported.friction).c_str());
      out_.CloseElement();
    }
    out_.CloseElement();
  }

  void write_limit(const Joint<double>& joint) {
    const auto known = [](double limit) { return limit == kUnlimited ? 0 : limit; };
    out_.OpenElement("limit");
    if (!is_continuous(joint)) {
      const bool ranged = has_range(joint);
      out_.PushAttribute("lower", shortest(ranged ? joint.min_position : -kFarthest).c_str());
      out_.PushAttribute("upper", shortest(ranged ? joint.max_position : kFarthest).c_str());
    }
    out_.PushAttribute("effort", shortest(known(joint.max_torque)).c_str());
    out_.PushAttribute("velocity", shortest(known(joint.max_velocity)).c_str());
    out_.CloseElement();
  }

  const RobotDescription& robot_;
  ExportedRobot result_;
  std::vector<ExportedJoint> joints_;
  Eigen::Vector3d up_ = Eigen::Vector3d::UnitZ();
  XMLPrinter out_;
};

}  // namespace

ExportedRobot export_urdf(const RobotDescription& robot, const std::string& robot_file) {
  return UrdfWriter(robot).write(robot_file);
}

}  // namespace offnominal::desk::exchange
