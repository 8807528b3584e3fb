#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "campaign/result_file.hpp"
#include "campaign/run_campaign.hpp"
#include "desk/campaign/small_campaign.hpp"
#include "desk/support/run_command.hpp"
#include "support/places.hpp"

// `offnominal-campaign-mpi` on a few processes of this machine.

namespace offnominal::desk::campaign {
namespace {

using test::CommandResult;
using testing::HasSubstr;

CommandResult on_processes(int count, const std::vector<std::string>& arguments) {
  const std::string program =
      (std::filesystem::path(test::command_file()).parent_path() / "offnominal-campaign-mpi");
  // As containers need it: root, fewer cores than processes, no debugger's system calls.
  std::vector<std::string> words{"--allow-run-as-root",
                                 "--oversubscribe",
                                 "--mca",
                                 "btl_vader_single_copy_mechanism",
                                 "none",
                                 "-n",
                                 std::to_string(count),
                                 program};
  words.insert(words.end(), arguments.begin(), arguments.end());
  return test::run_command(OFFNOMINAL_MPIRUN, words);
}

TEST(CampaignOverMpi, GivesTheRowsOfOneProcessAndGoesOn) {
  const test::TemporaryFolder folder;
  test::put(folder / "small.toml", test::small_campaign());
  const Campaign plan = read_campaign(folder / "small.toml");
  run_campaign(plan, {folder / "one.sqlite", {}, 1}, {});
  const std::string results = (folder / "mpi.sqlite").string();
  run_campaign(plan, {results, {2, 3}, 1}, {});
  const CommandResult run = on_processes(3, {(folder / "small.toml").string(), "-o", results});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("campaign small: 11 of 11 runs"));
  EXPECT_EQ(read_results(results).rows, read_results(folder / "one.sqlite").rows);
}

TEST(CampaignOverMpi, SaysOnceWhatIsWrong) {
  const test::TemporaryFolder folder;
  const CommandResult run = on_processes(
      2, {(folder / "none.toml").string(), "-o", (folder / "results.sqlite").string()});
  EXPECT_NE(run.exit_code, 0);
  const std::string words = "none.toml: ";
  EXPECT_NE(run.err.find(words), std::string::npos) << run.err;
  EXPECT_EQ(run.err.find(words), run.err.rfind(words)) << run.err;
}

}  // namespace
}  // namespace offnominal::desk::campaign
