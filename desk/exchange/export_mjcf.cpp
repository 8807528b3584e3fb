#include <fmt/format.h>

#include <algorithm>

#include "common/error.hpp"
#include "exchange/export_body.hpp"
#include "exchange/limits.hpp"

namespace offnominal::desk::exchange {
namespace {

using tinyxml2::XMLPrinter;

void push(XMLPrinter& out, const char* name, double value) {
  out.PushAttribute(name, numbers(std::span(&value, 1)).c_str());
}
void push(XMLPrinter& out, const char* name, std::span<const double> values) {
  out.PushAttribute(name, numbers(values).c_str());
}

class MjcfWriter {
 public:
  explicit MjcfWriter(const RobotDescription& robot) : robot_(robot) {}

  ExportedRobot write(const std::string& robot_file) {
    joints_ = exported_joints(
        robot_, {.name = "MJCF", .taken = "world", .has_armature = true, .has_springs = true},
        result_);
    for (std::size_t i = 0; i < joints_.size(); ++i) say_what_stays(i);
    out_.OpenElement("mujoco");
    out_.PushAttribute("model", on_one_line(robot_.name).c_str());
    const std::string comment = head_comment(result_, "export-mjcf", robot_file);
    out_.PushComment(comment.c_str());
    out_.OpenElement("compiler");
    out_.PushAttribute("angle", "radian");
    out_.PushAttribute("inertiafromgeom", "false");
    out_.CloseElement();
    out_.OpenElement("option");
    // The default of MuJoCo, or the estimator's where that is shorter.
    push(out_, "timestep", std::min(0.002, robot_.estimator.period_s));
    push(out_, "gravity", robot_.gravity_m_s2);
    out_.CloseElement();
    out_.OpenElement("worldbody");
    for (std::size_t i = 0; i < joints_.size(); ++i) open_body(i);
    for (std::size_t i = 0; i < joints_.size(); ++i) out_.CloseElement();
    out_.CloseElement();
    write_motors();
    out_.CloseElement();
    result_.text = out_.CStr();
    return std::move(result_);
  }

 private:
  void say_what_stays(std::size_t index) {
    if (robot_.joints[index].joint.max_velocity == kUnlimited) return;
    result_.not_carried.push_back(
        fmt::format("the limit of velocity of joint `{}`", joints_[index].name));
  }

  void open_body(std::size_t index) {
    const Joint<double>& joint = robot_.joints[index].joint;
    out_.OpenElement("body");
    out_.PushAttribute("name", joints_[index].name.c_str());
    push(out_, "pos", joint.origin_m);
    const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> rotation(
        joint.rotation.data());
    const Eigen::Quaterniond q{Eigen::Matrix3d(rotation)};
    const double quaternion[]{q.w(), q.x(), q.y(), q.z()};
    push(out_, "quat", quaternion);
    write_inertial(joints_[index].body);
    write_joint(joint, joints_[index]);
    write_shape(index);
  }

  void write_inertial(const RigidBody& body) {
    const Eigen::Matrix3d tensor = loadable_inertia(body);
    out_.OpenElement("inertial");
    push(out_, "pos", std::span(body.centre_m.data(), 3));
    push(out_, "mass", body.mass_kg);
    const double full[]{tensor(0, 0), tensor(1, 1), tensor(2, 2),
                        tensor(0, 1), tensor(0, 2), tensor(1, 2)};
    push(out_, "fullinertia", full);
    out_.CloseElement();
  }

  void write_joint(const Joint<double>& joint, const ExportedJoint& exported) {
    out_.OpenElement("joint");
    out_.PushAttribute("name", exported.name.c_str());
    out_.PushAttribute("type", joint.type == JointType::kRevolute ? "hinge" : "slide");
    push(out_, "axis", joint.axis);
    const bool limited = has_range(joint);
    out_.PushAttribute("limited", limited ? "true" : "false");
    if (limited) push(out_, "range", std::array{joint.min_position, joint.max_position});
    const auto unless_zero = [&](const char* name, double value) {
      if (value != 0) push(out_, name, value);
    };
    unless_zero("damping", exported.damping);
    unless_zero("frictionloss", exported.friction);
    unless_zero("armature", exported.armature);
    unless_zero("stiffness", exported.stiffness);
    unless_zero("springref", exported.rest_position);
    out_.CloseElement();
  }

  // From the joint to the next one; from the last one to the middle of its mass.
  void write_shape(std::size_t index) {
    const bool last = index + 1 == joints_.size();
    const double* const end =
        last ? joints_[index].body.centre_m.data() : robot_.joints[index + 1].joint.origin_m.data();
    const double length = Eigen::Map<const Eigen::Vector3d>(end).norm();
    if (!(length > 1e-3)) return;
    out_.OpenElement("geom");
    out_.PushAttribute("type", "capsule");
    push(out_, "fromto", std::array{0.0, 0.0, 0.0, end[0], end[1], end[2]});
    push(out_, "size", length / 10);
    out_.PushAttribute("mass", "0");
    out_.PushAttribute("contype", "0");
    out_.PushAttribute("conaffinity", "0");
    out_.CloseElement();
  }

  void write_motors() {
    out_.OpenElement("actuator");
    for (std::size_t i = 0; i < joints_.size(); ++i) {
      const double most = robot_.joints[i].joint.max_torque;
      out_.OpenElement("motor");
      out_.PushAttribute("name", joints_[i].name.c_str());
      out_.PushAttribute("joint", joints_[i].name.c_str());
      const bool limited = most != kUnlimited;
      out_.PushAttribute("ctrllimited", limited ? "true" : "false");
      if (limited) push(out_, "ctrlrange", std::array{-most, most});
      out_.CloseElement();
    }
    out_.CloseElement();
  }

  const RobotDescription& robot_;
  ExportedRobot result_;
  std::vector<ExportedJoint> joints_;
  XMLPrinter out_;
};

}  // namespace

ExportedRobot export_mjcf(const RobotDescription& robot, const std::string& robot_file) {
  return MjcfWriter(robot).write(robot_file);
}

}  // namespace offnominal::desk::exchange
