#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "compare/inverse_model.hpp"
#include "compare/motion.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk {

// A number of a robot description that enters the torque linearly and that least squares finds.
struct Unknown {
  enum class Kind {
    kEffectParameter,  // robot.effects[effect].parameters[parameter]
    kLinkScale,        // factor on mass and inertia of one link, minus 1
  };
  Kind kind = Kind::kEffectParameter;
  std::size_t effect = 0;
  std::size_t parameter = 0;
  std::size_t joint = 0;  // from 0; the effect's joint, or the link behind that joint
  double start = 0;       // what the description has now
  bool is_new = false;    // gives way first where the data cannot tell it from others
};

// The linear parameters of one effect of the robot.
std::vector<Unknown> unknowns_of_effect(const RobotDescription& robot, std::size_t effect,
                                        bool is_new);

// "coulomb_friction.level of joint 1", "mass and inertia of link 2"
std::string name_of(const RobotDescription& robot, const Unknown& unknown);

// One joint's column of a regressor, a value per sample of the motion.
struct JointColumn {
  std::size_t joint = 0;
  Eigen::VectorXd values;
};

// d torque / d unknown over the motion, for the joints whose torque the unknown changes. Shape
// parameters are those of `robot`; the effect's other linear parameters play no part. Where path
// effects scale the torque the derivative is the one at the values of `robot`.
std::vector<JointColumn> regressor(const RobotDescription& robot, const Unknown& unknown,
                                   const Motion& motion);
// The same of several unknowns in turn; `told`: of the robot and the motion, made where it is
// needed and there is none yet.
std::vector<JointColumn> regressor(const RobotDescription& robot, const Unknown& unknown,
                                   const Motion& motion, std::optional<ToldTorque>& told);

// True where the unknown changes inertia or weight: its torque passes the gear.
bool is_load(const RobotDescription& robot, const Unknown& unknown);

// regressor() in two steps, for an unknown that is no path effect's: what it adds to the load or to
// the effects' torque, which for a load does not depend on any effect's value; and what the drive
// has to be told for that.
std::vector<JointColumn> regressor_before_path(const RobotDescription& robot,
                                               const Unknown& unknown, const Motion& motion);
void pass_path(const RobotDescription& robot, const Unknown& unknown, const ToldTorque& told,
               std::vector<JointColumn>& columns);

// The joints that regressor() has columns for.
std::vector<std::size_t> joints_of(const RobotDescription& robot, const Unknown& unknown);

}  // namespace offnominal::desk
