#include "campaign/cad_errors.hpp"

#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <offnominal/model/effect_list.hpp>

namespace offnominal::desk::campaign {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using sim::hidden::Draws;

namespace {

Vector3d drawn_shift(Draws& draws, double size) {
  const double x = draws.uniform(-size, size);
  const double y = draws.uniform(-size, size);
  return {x, y, draws.uniform(-size, size)};
}

void scale_tensor(double by, Joint<double>& link) {
  for (double& one : link.inertia_kg_m2) one *= by;
}

double trace_of(const Joint<double>& link) {
  return link.inertia_kg_m2[0] + link.inertia_kg_m2[1] + link.inertia_kg_m2[2];
}

}  // namespace

RobotDescription with_cad_errors(RobotDescription robot, double error, Draws& draws) {
  for (RobotJoint& joint : robot.joints) {
    Joint<double>& link = joint.joint;
    const double by_mass = 1 + draws.uniform(-error, error);
    const double by_shape = 1 + draws.uniform(-error, error);
    const double radius = link.mass_kg > 0 ? std::sqrt(trace_of(link) / 2 / link.mass_kg) : 0;
    const Vector3d moved = drawn_shift(draws, error * radius);
    link.mass_kg *= by_mass;
    for (std::size_t i = 0; i < 3; ++i) {
      link.centre_of_mass_m[i] += moved[static_cast<Eigen::Index>(i)];
    }
    scale_tensor(by_mass * by_shape, link);
  }
  return robot;
}

RobotDescription with_friction_errors(RobotDescription robot, double error, Draws& draws) {
  for (RobotEffect& effect : robot.effects) {
    if (info_of(effect.kind)->action == EffectAction::kReflectedInertia) continue;
    effect.parameters[0] *= 1 + error * draws.sign();
  }
  return robot;
}

}  // namespace offnominal::desk::campaign
