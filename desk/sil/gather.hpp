// What the programs of a run in real time have recorded, as the result of one run.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "sil/sil.hpp"

namespace offnominal::desk::sil {

struct Recordings {
  std::filesystem::path controller_csv;
  nlohmann::json controller;
  std::filesystem::path plant_csv;
  nlohmann::json plant;
};

[[nodiscard]] SilResult gather(const RobotDescription& robot, const Scenario& scenario,
                               const std::string& bus_name, const Recordings& recordings);

}  // namespace offnominal::desk::sil
