#include "write_cases.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "case_folder.hpp"
#include "common/file.hpp"
#include "log/csv_text.hpp"
#include "log/sampling.hpp"
#include "recorded_case.hpp"
#include "robot/robot_file.hpp"

namespace offnominal::bench {

using nlohmann::ordered_json;

namespace {

ordered_json json_of_parameters(const std::vector<sim::hidden::TrueParameter>& parameters) {
  ordered_json json = ordered_json::object();
  for (const sim::hidden::TrueParameter& one : parameters) {
    json[one.name] = {{"value", one.value}, {"unit", one.unit}};
  }
  return json;
}

ordered_json json_of_truth(const sim::hidden::Request& request, const sim::hidden::Truth& truth) {
  ordered_json json{{"seed", request.seed}, {"effects", ordered_json::array()}};
  for (const sim::hidden::TrueEffect& one : truth.effects) {
    json["effects"].push_back({{"effect", std::string(name(one.effect))},
                               {"joint", one.joint + 1},
                               {"parameters", json_of_parameters(one.parameters)}});
  }
  json["outside"] = {{"effect", std::string(name(truth.outside.effect))},
                     {"joint", truth.outside.joint + 1},
                     {"parameters", json_of_parameters(truth.outside.parameters)}};
  json["data_fault"] = std::string(name(truth.fault));
  return json;
}

desk::Log whole(const sim::hidden::Recording& recording) {
  desk::Log log = log_of(recording);
  desk::derive_velocities(log);
  return log;
}

}  // namespace

std::vector<std::filesystem::path> write_cases(const std::vector<CaseGroup>& groups,
                                               const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> written;
  for (const CaseGroup& group : groups) {
    for (std::size_t i = 0; i < group.requests.size(); ++i) {
      const std::filesystem::path own = new_case_folder(folder, group.name, i);
      const sim::hidden::Case made = make_case(group.requests[i]);
      desk::RobotDescription robot = robot_of(made.nominal);
      robot.name = fmt::format("{}-{:03}", group.name, i);
      robot.source =
          "Drawn by the simulator of ./dev bench discovery; truth.json has what it hides.";
      desk::write_robot_file(robot, own / "robot.toml");
      desk::write_file_atomically(own / "recording.csv", csv_text(whole(made.recording)));
      desk::write_file_atomically(own / "holdout.csv", csv_text(whole(made.holdout)));
      desk::write_file_atomically(own / "truth.json",
                                  json_of_truth(group.requests[i], made.truth).dump(2) + "\n");
      written.push_back(own);
    }
  }
  return written;
}

}  // namespace offnominal::bench
