#include "arm_outcome.hpp"

#include <fmt/format.h>

#include <cstdlib>
#include <exception>
#include <nlohmann/json.hpp>
#include <system_error>

#include "case_folder.hpp"
#include "common/error.hpp"
#include "common/file.hpp"
#include "log/read_log.hpp"
#include "robot/robot_file.hpp"
#include "wall_clock.hpp"

namespace offnominal::bench {

namespace {

// A folder for the time of one case.
class CaseFolder {
 public:
  CaseFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "offnominal-arm-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) {
      throw desk::InputError({name, "", "no folder could be made", "a folder of its own",
                              "set TMPDIR to a folder that can be written to"});
    }
    path_ = name;
  }
  CaseFolder(const CaseFolder&) = delete;
  CaseFolder& operator=(const CaseFolder&) = delete;
  ~CaseFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

// The case as files, without what it hides.
void write_case(const ArmCase& made, const std::filesystem::path& folder) {
  desk::write_robot_file(made.robot, folder / "robot.toml");
  desk::write_file_atomically(folder / "recording.csv", made.recording);
  if (made.holdout) desk::write_file_atomically(folder / "holdout.csv", *made.holdout);
}

void explain_case(const ArmCase& made, const desk::ExplainOptions& options, ArmOutcome& outcome) {
  const CaseFolder folder;
  write_case(made, folder.path());
  const desk::RobotDescription robot = desk::read_robot_file(folder.path() / "robot.toml");
  const std::vector<desk::Log> logs{desk::read_log(folder.path() / "recording.csv", robot)};
  std::vector<desk::Log> holdout;
  if (made.holdout) holdout.push_back(desk::read_log(folder.path() / "holdout.csv", robot));
  const double start_s = now_s();
  const desk::Explanation told = desk::explain(robot, logs, holdout, options);
  outcome.time_s = now_s() - start_s;
  outcome.verdict = desk::name_of(told.verdict);
  for (const desk::Finding& one : told.found) outcome.named.push_back(one.what);
  outcome.classes = told.ambiguous;
  outcome.score = arm_score_of(made.truth, told);
}

// What a case that could not be read or explained has not answered.
ArmScore score_of_failure(const ArmTruth& truth) { return arm_score_of(truth, {}); }

}  // namespace

ArmOutcome run_arm_case(const ArmRequest& request, const desk::ExplainOptions& options) {
  ArmOutcome outcome;
  outcome.request = request;
  ArmCase made;
  try {
    made = make_arm_case(request);
  } catch (const std::exception& error) {
    outcome.refused = error.what();
    return outcome;
  }
  outcome.truth = made.truth;
  try {
    explain_case(made, options, outcome);
  } catch (const std::exception& error) {
    outcome.failed = error.what();
    outcome.verdict = "error";
    outcome.score = score_of_failure(made.truth);
  }
  return outcome;
}

std::vector<std::filesystem::path> write_arm_cases(const std::vector<ArmGroup>& groups,
                                                   const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> written;
  for (const ArmGroup& group : groups) {
    for (std::size_t i = 0; i < group.requests.size(); ++i) {
      const std::filesystem::path own = new_case_folder(folder, group.name, i);
      const ArmCase made = make_arm_case(group.requests[i]);
      write_case(made, own);
      nlohmann::ordered_json json{{"seed", group.requests[i].seed},
                                  {"in_short", text_of(made.truth)}};
      json.update(json_of(made.truth));
      desk::write_file_atomically(own / "truth.json", json.dump(2) + "\n");
      written.push_back(own);
    }
  }
  return written;
}

}  // namespace offnominal::bench
