// What a run of the controller program shows, as text and JSON.
#pragma once

#include <nlohmann/json.hpp>
#include <offnominal/hal/bus/bus.hpp>
#include <string>
#include <vector>

#include "loop/joint_program.hpp"

namespace offnominal::desk {

struct ControllerOutcome {
  JointProgramReport report;
  std::vector<std::string> joint_names;
  std::string bus_name;
  hal::BusState bus;
  bool can_take_back = false;
  std::uint64_t recording_lost = 0;
};

[[nodiscard]] nlohmann::ordered_json to_json(const ControllerOutcome& outcome);
/// A table.
[[nodiscard]] std::string text_of(const ControllerOutcome& outcome);

}  // namespace offnominal::desk
