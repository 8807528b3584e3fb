#include "controller/joint_program.hpp"

#include "common/error.hpp"

namespace offnominal::tools {

std::unique_ptr<JointProgram> make_joint_program(const JointProgramSetup& setup) {
  switch (setup.robot.joints.size()) {
    case 1:
      return detail::make_program_of<1>(setup);
    case 2:
      return detail::make_program_of<2>(setup);
    case 3:
      return detail::make_program_of<3>(setup);
    case 6:
      return detail::make_program_of<6>(setup);
    case 7:
      return detail::make_program_of<7>(setup);
    default:
      throw InputError({"robot " + setup.robot.name, "",
                        std::to_string(setup.robot.joints.size()) + " joints", "1, 2, 3, 6 or 7",
                        "a number more is a line in tools/controller/joint_program.cpp and one in "
                        "its CMakeLists.txt"});
  }
}

}  // namespace offnominal::tools
