#include "identify/link_masses.hpp"

#include <fmt/format.h>

#include <cstddef>

namespace offnominal::desk {
namespace {

// With what the effects of the file add to it, kg.
double mass_of_link(const RobotDescription& robot, std::size_t link) {
  double mass_kg = robot.joints[link].joint.mass_kg;
  for (const RobotEffect& effect : robot.effects) {
    if (effect.kind == EffectKind::kLinkMass && effect.joint == static_cast<int>(link))
      mass_kg += effect.parameters[0];
  }
  return mass_kg;
}

bool is_beyond_belief(double before_kg, double after_kg, double arm_kg) {
  constexpr double kFarOff = 10;
  constexpr double kOfTheArm = 0.02;
  if (!(before_kg > kOfTheArm * arm_kg)) return after_kg > arm_kg;
  return after_kg >= kFarOff * before_kg || after_kg * kFarOff <= before_kg;
}

}  // namespace

std::vector<std::string> masses_beyond_belief(const RobotDescription& file,
                                              const RobotDescription& improved) {
  std::vector<std::string> objections;
  double arm_kg = 0;
  for (std::size_t link = 0; link < file.joints.size(); ++link) arm_kg += mass_of_link(file, link);
  for (std::size_t link = 0; link < file.joints.size(); ++link) {
    const double before_kg = mass_of_link(file, link);
    const double after_kg = mass_of_link(improved, link);
    if (!is_beyond_belief(before_kg, after_kg, arm_kg)) continue;
    objections.push_back(fmt::format(
        "link {} would have {:.4g} kg instead of {:.4g}: look at the unit of the torque first "
        "(scale in [channels]: mN m, torque before a gear, a current), then at the mass in the "
        "robot file",
        link + 1, after_kg, before_kg));
  }
  return objections;
}

}  // namespace offnominal::desk
