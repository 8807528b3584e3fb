// What isolation says after a detection of a monitor that judges joint by joint.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <offnominal/diagnosis/isolation_state.hpp>
#include <string>
#include <vector>

#include "robot/robot.hpp"

namespace offnominal::desk {

/// Fields as of the core's FaultDiagnosis.
struct IsolatedFault {
  FaultKind kind = FaultKind::kUnknown;
  int joint = 0;  // from 0; of kUnknown none
  double size = 0;
  double deviation = 0;
  std::string unit;  // of both; empty where the kind has no size
  double confidence = 0;
  double unexplained = 0;
  double detection_time_s = 0;  // of the recording, or of the run
  double time_s = 0;            // of the answer
  bool decided = false;         // otherwise it ended before, or the monitor began afresh
};

/// `found` of a robot whose joints are of these types, told at `time_s` of a detection at
/// `detection_time_s`.
template <typename Scalar>
[[nodiscard]] IsolatedFault isolated_fault_of(const FaultDiagnosis<Scalar>& found,
                                              const std::vector<JointType>& types,
                                              double detection_time_s, double time_s) {
  return {found.kind,
          found.joint,
          static_cast<double>(found.size),
          static_cast<double>(found.deviation),
          size_unit_of(found.kind, types[found.joint]),
          static_cast<double>(found.confidence),
          static_cast<double>(found.unexplained),
          detection_time_s,
          time_s,
          found.decided};
}

[[nodiscard]] std::vector<JointType> joint_types(const RobotDescription& robot);
[[nodiscard]] std::vector<std::string> joint_names(const RobotDescription& robot);

/// What it is, "Joint 4 (elbow): friction up by 3.00 N m (2.80 to 3.20), 0.32 s after the
/// detection, confidence 99 %"; `names`: of the joints.
[[nodiscard]] std::string words_of(const IsolatedFault& fault,
                                   const std::vector<std::string>& names);

/// {kind, joint, size, deviation, unit, confidence, unexplained, detection_time_s, time_s, decided,
/// words}; joints count from 1, null where there is none.
[[nodiscard]] nlohmann::json to_json(const IsolatedFault& fault,
                                     const std::vector<std::string>& names);
/// What to_json() made.
[[nodiscard]] IsolatedFault isolated_fault_of(const nlohmann::json& json);

}  // namespace offnominal::desk
