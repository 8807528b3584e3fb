#pragma once

#include <filesystem>
#include <memory>

#include "campaign/campaign_file.hpp"
#include "campaign/result_file.hpp"
#include "campaign/run_campaign.hpp"
#include "desk/campaign/small_campaign.hpp"
#include "desk/support/temporary_folder.hpp"
#include "log/read_log.hpp"
#include "robot/robot_file.hpp"
#include "studio/session_files.hpp"
#include "studio/workbench.hpp"

namespace offnominal::test {

// Run once for all tests; nobody changes it.
class SmallResults {
 public:
  SmallResults() {
    put(file(), small_campaign("[[fault]]\nkind = \"payload\"\nsizes = [0.5]\n", "robot"));
    plan_ = desk::campaign::read_campaign(file());
    desk::campaign::run_campaign(plan_, {results(), {}, 1}, [](const auto&, auto, auto) {});
    rows_ = desk::campaign::read_results(results());
  }
  [[nodiscard]] std::filesystem::path file() const { return folder_ / "small.toml"; }
  [[nodiscard]] std::filesystem::path results() const { return folder_ / "small.sqlite"; }
  [[nodiscard]] const desk::campaign::Campaign& plan() const { return plan_; }
  [[nodiscard]] const desk::campaign::Results& rows() const { return rows_; }

 private:
  TemporaryFolder folder_;
  desk::campaign::Campaign plan_;
  desk::campaign::Results rows_;
};
inline const SmallResults& small() {
  static const SmallResults results;
  return results;
}

// As the verb opens a run.
inline desk::studio::Input open_run(const desk::studio::SessionFiles& files) {
  using namespace desk;
  using studio::Input;
  Input input;
  input.robot = read_robot_file(files.robot.path);
  Treated recordings;
  recordings.logs.push_back(read_log(files.logs.at(0).path, input.robot));
  input.recordings = std::make_shared<const Treated>(std::move(recordings));
  input.robot_file = files.robot.name;
  input.log_files = {files.logs.at(0).name};
  input.commands_before = files.commands_before;
  input.marks = files.marks;
  return input;
}

}  // namespace offnominal::test
