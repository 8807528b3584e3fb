// Recordings of six joints with a defect or without, and whether the doctor says what is there.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "explain/treatment.hpp"
#include "log/log.hpp"
#include "offnominal/sim/recorded/recording.hpp"
#include "robot/robot.hpp"

namespace offnominal::bench {

// kHeldOut: another robot, other motions and other rates than what the doctor was developed on.
enum class Family { kDeveloped, kHeldOut };

struct DoctorCase {
  desk::RobotDescription robot;  // what its owner knows: a few percent off, friction more
  desk::Log log;
  sim::recorded::TrueDefect truth;
  std::string words;  // motion, rate, habits
};

// Half of the cases have no defect. The same family, seed and number give the same case.
DoctorCase make_doctor_case(Family family, std::uint64_t seed, int number);

struct Judgement {
  bool right = false;
  std::string said;  // what was found, in short
};
// Right: a recording without a defect gives no fault at all, one with a defect that fault on that
// joint at that time, and no other.
Judgement judge(const DoctorCase& made, const std::vector<desk::DataFault>& faults);

}  // namespace offnominal::bench
