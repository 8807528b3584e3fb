#pragma once

#include <optional>
#include <string>
#include <vector>

#include "arm_effects.hpp"
#include "arm_groups.hpp"
#include "arm_rig.hpp"
#include "robot/robot.hpp"

namespace offnominal::bench {

// What the file does not know, and how much of it there is.
struct ArmTrueEffect {
  ArmEffect effect;
  double rms_nm = 0;  // over the recording; of a payload on the joint where its share is largest
  double share = 0;   // of the joint's rms torque
  // Large enough to be asked for: 2 % of the joint's torque, and the noise of its torque.
  bool is_asked_for = false;
};

struct ArmTruth {
  std::vector<ArmTrueEffect> effects;  // that act throughout
  std::vector<ArmTrueEffect> changes;  // that act from some time on
  std::vector<ArmPush> pushes;
  double cad_error = 0;                       // largest share by which a link may be off
  double friction_error = 0;                  // the same of a known friction
  std::vector<double> link_mass_error_share;  // per joint: as it is per what the file says, less 1
  std::vector<double> torque_constant_error;  // per joint: logged torque per torque given, less 1
  std::vector<double> noise_nm;               // per joint: standard deviation of the logged torque
  std::vector<bool> stands;                   // per joint
  double rate_hz = 0;
  double duration_s = 0;
  std::string positions;  // "17 bit" or "5 digits"
  std::string motion;     // "sines" or "moves"
};

// A case as its owner would bring it: a robot file and texts of recordings.
struct ArmCase {
  desk::RobotDescription robot;
  std::string recording;               // CSV with the common header
  std::optional<std::string> holdout;  // another motion of the same arm
  ArmTruth truth;
};

// The same request gives the same case, byte for byte. Throws std::runtime_error where the arm's
// motion runs away.
ArmCase make_arm_case(const ArmRequest& request);

}  // namespace offnominal::bench
