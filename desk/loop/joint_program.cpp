#include "loop/joint_program.hpp"

#include "loop/in_space.hpp"

namespace offnominal::desk {

std::unique_ptr<JointProgram> make_joint_program(const JointProgramSetup& setup) {
  if (setup.robot.estimator.space == EstimatorSpace::kTorque) return program_in_torque(setup);
  return program_in_acceleration(setup);
}

}  // namespace offnominal::desk
