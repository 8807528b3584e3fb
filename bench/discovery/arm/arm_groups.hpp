#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace offnominal::bench {

// What a case of the benchmark of arms has that the robot's file does not know, beside errors of
// its CAD, of its friction and of its torque constants.
enum class ArmHides : std::uint8_t {
  kEffects,     // one to four effects on different joints
  kNoFriction,  // the file has no friction at all
  kPayload,     // a load on the flange, and an effect beside it in every second case
  kChange,      // payload, friction, offset or torque constant from some time on
  kPush,        // somebody pushes a link
  kNothing,     // the file is right but for CAD and friction
};

struct ArmRequest {
  ArmHides hides = ArmHides::kEffects;
  std::uint64_t seed = 0;
};

// Cases that are judged by the same numbers.
struct ArmGroup {
  std::string name;   // for --cases
  std::string words;  // for the table
  ArmHides hides = ArmHides::kEffects;
  std::vector<ArmRequest> requests;
};

// 300 cases in five groups and 200 with nothing hidden; quick: 24 in all, the first of each group.
std::vector<ArmGroup> arm_groups(std::uint64_t base_seed, bool quick);

}  // namespace offnominal::bench
