#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace offnominal::desk {

/// How a robot's drives are spoken to. Without [drives] in its file: the first protocol of the
/// list, which is offnominal's own.
struct DriveSettings {
  std::size_t protocol = 0;       // of drive_protocols()
  std::vector<double> shared;     // of its keys
  std::vector<double> of_joints;  // of its joint_keys, joint after joint
  std::string source = {};        // where the numbers come from, free text; empty: not said
};

}  // namespace offnominal::desk
