#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "explain/excitation.hpp"
#include "identify/data.hpp"
#include "log/log.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk {

// A short stretch of time in which something from outside acts on the arm: a hand, a bump, a cable
// that catches.
struct Push {
  std::string file;   // of the recording
  double from_s = 0;  // by the recording's own time stamps
  double to_s = 0;
  // What the model leaves there, of every joint on which it shows.
  struct OnJoint {
    Eigen::Index joint = 0;
    double rms_torque = 0;  // N m or N
    std::string unit;
  };
  std::vector<OnJoint> joints;
  // What is left out with it: until the error is as it always is.
  double out_from_s = 0;
  double out_to_s = 0;
};

// What lasts longer is a change.
inline constexpr double kLongestPushS = 2;

// "8.71 to 9.24 s of pick.csv (joints 1, 2, 3; most on joint 2: 15 N m)".
std::string words_of(const Push& push);

// The pushes of the recordings, in the order of their time. They are asked beside links of which
// nothing is known and friction on every joint, so that what the file has wrong is no push, and
// fitted without what is pushed, so that a push is not taken for a heavier link. One has to stand
// far above what the model leaves at all other times, for no longer than two seconds, and must
// not come back wherever a joint has the same position, velocity or load. `excitation`: per joint.
std::vector<Push> pushes_in(const Data& data, const RobotDescription& robot,
                            const std::vector<Excitation>& excitation);

// Whether pushes hold one at the same time of the same recording, which may have been given twice.
bool is_among(const Push& one, const std::vector<Push>& pushes);

// Leaves the pushes of a recording out of every joint of it.
void leave_out(const std::vector<Push>& pushes, Log& log);
void leave_out(const std::vector<Push>& pushes, std::vector<Log>& logs);

}  // namespace offnominal::desk
