#include "exchange/export_body.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <optional>
#include <set>

#include "common/error.hpp"
#include "common/input_name.hpp"
#include "common/json_text.hpp"
#include "common/number.hpp"
#include "robot/effect_text.hpp"
#include "robot/geometry.hpp"
#include "robot/transmission.hpp"

namespace offnominal::desk::exchange {
namespace {

std::string one_of(const std::set<std::string>& taken, const std::string& name) {
  std::string free = name;
  for (int i = 2; taken.contains(free); ++i) free = fmt::format("{}_{}", name, i);
  return free;
}

std::string words_of(const RobotEffect& effect, const std::string& place) {
  const EffectInfo& info = *info_of(effect.kind);
  std::string values;
  for (std::size_t i = 0; i < info.parameters.size(); ++i) {
    values += fmt::format("{}{} = {}", i == 0 ? "" : ", ", info.parameters[i].name,
                          shortest(effect.parameters[i]));
  }
  return fmt::format("{} of {} ({})", info.name, place, values);
}

std::string named(const ExportedJoint& joint) { return fmt::format("joint `{}`", joint.name); }

class Exporter {
 public:
  Exporter(const RobotDescription& robot, const FormatTraits& format, ExportedRobot& result)
      : robot_(robot), format_(format), result_(result) {}

  std::vector<ExportedJoint> run() {
    std::set<std::string> names{format_.taken};
    for (const RobotJoint& from : robot_.joints) {
      ExportedJoint& to = joints_.emplace_back();
      const std::string asked = on_one_line(from.name);
      to.name = one_of(names, asked);
      if (to.name != asked) {
        result_.changed.push_back(
            fmt::format("the name of joint `{}`: `{}`, since the other is taken", asked, to.name));
      }
      names.insert(to.name);
      to.body = body_of(from.joint);
    }
    for (const RobotEffect& effect : robot_.effects) take(effect);
    for (std::size_t i = 0; i < joints_.size(); ++i) {
      drop_negative(joints_[i].damping, "damping", i);
      drop_negative(joints_[i].friction, "dry friction", i);
      say_what_stays(i);
    }
    if (robot_.bound) result_.not_carried.emplace_back("the uncertainty bound");
    result_.not_carried.emplace_back("the settings of estimator and arming");
    if (robot_.transmission) result_.not_carried.emplace_back("the transmission");
    if (robot_.channels) result_.not_carried.emplace_back("the channels of recordings");
    return std::move(joints_);
  }

 private:
  void take(const RobotEffect& effect) {
    if (effect.of_motor) return take_of_motor(effect);
    ExportedJoint& joint = joints_[effect.joint];
    const double first = effect.parameters[0];
    switch (effect.kind) {
      case EffectKind::kViscousFriction:
        joint.damping += first;
        return;
      case EffectKind::kCoulombFriction:
        joint.friction += first;
        changed(effect, "dry friction changes its sign at once, not over `smoothing`");
        return;
      case EffectKind::kRotorInertia:
        if (!format_.has_armature) break;
        joint.armature += first;
        return;
      case EffectKind::kJointStiffness:
        if (!format_.has_springs || first <= 0) break;
        joint.rest_position =
            (joint.stiffness * joint.rest_position + first * effect.parameters[1]) /
            (joint.stiffness + first);
        joint.stiffness += first;
        return;
      case EffectKind::kTipPayload:
      case EffectKind::kLinkMass:
        if (!add_mass(effect)) break;
        changed(effect, "part of the link's mass and inertia");
        return;
      default:
        break;
    }
    result_.not_carried.push_back(words_of(effect, named(joint)));
  }

  // The joint that a motor alone moves, and by how much it turns; none where motors are shared.
  struct Gear {
    std::size_t joint = 0;
    double ratio = 1;
  };
  std::optional<Gear> gear_of(std::size_t motor) const {
    if (!robot_.transmission) return Gear{motor, 1};
    const Eigen::MatrixXd per_joint = motor_per_joint(*robot_.transmission);
    const auto row = static_cast<Eigen::Index>(motor);
    Eigen::Index joint = 0;
    const double ratio = per_joint.row(row).cwiseAbs().maxCoeff(&joint);
    if ((per_joint.row(row).array() != 0).count() != 1 ||
        (per_joint.col(joint).array() != 0).count() != 1) {
      return std::nullopt;
    }
    return Gear{static_cast<std::size_t>(joint), ratio};
  }

  // What acts on a motor's shaft, as it is at the joint behind the gear.
  void take_of_motor(const RobotEffect& effect) {
    const std::string words = words_of(effect, place_of(effect));
    const auto gear = gear_of(effect.joint);
    if (!gear) {
      result_.not_carried.push_back(words + ": joints share the motors it moves with");
      return;
    }
    ExportedJoint& joint = joints_[gear->joint];
    const double first = effect.parameters[0];
    const double squared = gear->ratio * gear->ratio;
    const auto at_joint = [&](double& value, double added, const char* how) {
      value += added;
      result_.changed.push_back(fmt::format(
          "{}: {} at {}, {} times the ratio{}", words, shortest(added), named(joint), how,
          effect.kind == EffectKind::kCoulombFriction ? "; it changes its sign at once"
                                                      : " squared"));
    };
    if (effect.kind == EffectKind::kViscousFriction) {
      at_joint(joint.damping, squared * first, "damping");
    } else if (effect.kind == EffectKind::kCoulombFriction) {
      at_joint(joint.friction, gear->ratio * first, "dry friction");
    } else if (effect.kind == EffectKind::kRotorInertia && format_.has_armature) {
      at_joint(joint.armature, squared * first, "armature");
    } else {
      result_.not_carried.push_back(words);
    }
  }

  void changed(const RobotEffect& effect, const std::string& how) {
    result_.changed.push_back(
        fmt::format("{}: {}", words_of(effect, named(joints_[effect.joint])), how));
  }

  // False, and nothing added, where no body could be like what is left.
  bool add_mass(const RobotEffect& effect) {
    const Joint<double>& joint = robot_.joints[effect.joint].joint;
    Eigen::Vector3d at(joint.centre_of_mass_m.data());
    if (effect.kind == EffectKind::kTipPayload) at = Eigen::Vector3d(&effect.parameters[1]);
    RigidBody& body = joints_[effect.joint].body;
    const RigidBody both[]{body, {effect.parameters[0], at, Eigen::Matrix3d::Zero()}};
    const RigidBody sum = joined(both);
    Joint<double> probe;
    put_body(sum, probe);
    if (!(sum.mass_kg > 0) || !inertia_fault(probe.inertia_kg_m2).empty()) return false;
    body = sum;
    return true;
  }

  void drop_negative(double& value, const char* what, std::size_t joint) {
    if (value >= 0) return;
    result_.not_carried.push_back(fmt::format("{} below zero ({}) of joint `{}`", what,
                                              shortest(value), joints_[joint].name));
    value = 0;
  }

  void say_what_stays(std::size_t index) {
    const RobotJoint& joint = robot_.joints[index];
    const std::string& name = joints_[index].name;
    if (joint.encoder.counts_per_unit != 0) {
      result_.not_carried.push_back(fmt::format("the encoder of joint `{}`", name));
    }
    if (joint.kp != 0 || joint.kd != 0) {
      result_.not_carried.push_back(fmt::format("the gains of joint `{}`", name));
    }
  }

  const RobotDescription& robot_;
  const FormatTraits& format_;
  ExportedRobot& result_;
  std::vector<ExportedJoint> joints_;
};

}  // namespace

std::vector<ExportedJoint> exported_joints(const RobotDescription& robot,
                                           const FormatTraits& format, ExportedRobot& result) {
  return Exporter(robot, format, result).run();
}

Eigen::Matrix3d loadable_inertia(const RigidBody& body) {
  const Eigen::Vector3d moments =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(body.inertia_kg_m2, Eigen::EigenvaluesOnly)
          .eigenvalues();
  const double least = std::max(1e-12, 1e-9 * moments[2]);
  if (moments[0] >= least) return body.inertia_kg_m2;
  return body.inertia_kg_m2 + least * Eigen::Matrix3d::Identity();
}

std::string numbers(std::span<const double> values) {
  std::string text;
  for (const double value : values) text += (text.empty() ? "" : " ") + shortest(value + 0.0);
  return text;
}

std::string head_comment(const ExportedRobot& result, const std::string& verb,
                         const std::string& robot_file) {
  std::string text = fmt::format(" Written from {} by `offnominal {}`.\n",
                                 on_one_line(as_utf8(input_name(robot_file))), verb);
  for (const std::string& line : result.changed) text += "     changed: " + line + "\n";
  for (const std::string& line : result.not_carried) text += "     not carried: " + line + "\n";
  // A comment may hold no two hyphens in a row, and not end in one.
  for (auto at = text.find("--"); at != std::string::npos; at = text.find("--", at + 1)) {
    text.replace(at, 2, "- -");
  }
  return text;
}

}  // namespace offnominal::desk::exchange
