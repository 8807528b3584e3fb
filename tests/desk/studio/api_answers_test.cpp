// Every answer of every route of Studio's API is as its document says, and every route of the
// document answers.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>

#include "benchmark/benchmark_file.hpp"
#include "common/error.hpp"
#include "desk/exchange/urdfs.hpp"
#include "desk/sil/serial_robot.hpp"
#include "desk/studio/api_document.hpp"
#include "desk/studio/benchmark_results.hpp"
#include "desk/studio/served_studio.hpp"
#include "desk/studio/small_results.hpp"
#include "desk/studio/strange_files.hpp"
#include "desk/studio/studio_input.hpp"
#include "desk/support/temporary_folder.hpp"
#include "live/live.hpp"
#include "studio/api.hpp"
#include "studio/api_contract.hpp"
#include "studio/benchmark_view.hpp"
#include "studio/campaign_view.hpp"
#include "studio/cards.hpp"
#include "studio/intake.hpp"

namespace {

using nlohmann::json;
using offnominal::test::api_document;
using offnominal::test::ServedStudio;
using offnominal::test::TemporaryFolder;
using namespace offnominal::desk;
using namespace offnominal::desk::studio;

using Routes = std::set<std::string>;

std::string number_of_first_step(const json& state) {
  return std::to_string(state.at("steps").at(0).at("id").get<int>());
}

void look(ServedStudio& studio) {
  for (const char* path :
       {"state", "charts?joint=1&recording=1&pixels=300",
        "charts?joint=2&recording=1&pixels=500&beside=2&from=1&to=2.5",
        "map?joint=1&recording=1&x=position&y=velocity",
        "map?joint=2&recording=2&x=load&y=since_reversal&x_joint=1&y_joint=2&from=1&to=3",
        "spectrum?joint=1&recording=1&over=frequency", "spectrum?joint=1&recording=1&over=order",
        "spectrum?joint=2&recording=1&over=order&from=1&to=1.01", "arm?recording=1",
        "arm?recording=2&instants=2&from=4&to=5"}) {
    EXPECT_EQ(studio.get(path).first, 200) << path;
  }
}

Routes of_a_session() {
  const TemporaryFolder folder;
  Input input = offnominal::test::studio_input(folder / "arm.toml", true);
  input.keep_beside = folder / "fitted.csv";
  ServedStudio studio(std::move(input));
  EXPECT_EQ(studio.get("explanation").second.at("state"), "none");
  look(studio);
  EXPECT_EQ(studio.post("explanation").second.at("state"), "running");
  EXPECT_EQ(studio.get("explanation").first, 200);
  EXPECT_EQ(studio.post("explanation").first, 409);
  EXPECT_EQ(studio.erase("explanation").first, 200);
  const auto has_ended = [](const json& now) { return now.at("state") != "running"; };
  EXPECT_EQ(studio.wait_for("explanation", has_ended).at("state"), "stopped");
  EXPECT_EQ(studio.post("explanation").first, 200);
  const json found = studio.wait_for("explanation", has_ended);
  EXPECT_EQ(found.at("state"), "done");
  EXPECT_EQ(found.at("answer").at("verdict"), "found") << found;
  EXPECT_EQ(studio.get("evidence?search=2&finding=0").first, 200);
  EXPECT_EQ(studio.get("evidence?search=1&finding=0").first, 409);

  json state = studio.post("steps", {{"effect", "viscous_friction"}, {"joint", 2}}).second;
  const std::string id = number_of_first_step(state);
  EXPECT_EQ(studio.post("steps", {{"effect", "coulomb_friction"}, {"joint", 2}}).first, 200);
  look(studio);
  EXPECT_EQ(studio.get("evidence?step=" + id).first, 200);
  const std::string moved =
      "moved?step=" + id + "&parameter=coefficient&joint=2&recording=1&pixels=300&value=";
  EXPECT_EQ(studio.get(moved + "0.5").first, 200);
  const json shown{{"joint", 2}, {"recording", 1}, {"beside", 2}, {"from", 1}, {"to", 2.5}};
  EXPECT_EQ(studio.post("look", shown).first, 200);
  EXPECT_EQ(studio.get("state").second.at("look"), shown);
  EXPECT_EQ(studio
                .post("look", {{"joint", 2},
                               {"recording", 1},
                               {"beside", nullptr},
                               {"from", nullptr},
                               {"to", nullptr}})
                .first,
            200);
  EXPECT_EQ(studio.post("save", {{"name", "a.toml"}}).first, 200);
  EXPECT_EQ(studio.post("save", {{"name", "a.toml"}}).first, 409);
  EXPECT_EQ(studio.post("save", {{"name", "../a.toml"}}).first, 400);
  EXPECT_EQ(studio.post("page", {{"name", "a.toml"}}).first, 200);
  EXPECT_EQ(studio.get("state").first, 200);
  EXPECT_EQ(studio.erase("steps/" + id).first, 200);
  EXPECT_EQ(studio.erase("steps/" + id).first, 400);
  EXPECT_EQ(studio.erase("steps").first, 200);
  EXPECT_EQ(studio.post("save").first, 409);
  EXPECT_EQ(studio.get("live").first, 200);
  EXPECT_EQ(studio.get("load").first, 409);
  EXPECT_EQ(studio.get("results").first, 409);
  EXPECT_EQ(studio.get("live/now?from=0").first, 409);
  EXPECT_EQ(studio.post("leave").first, 204);
  return studio.answered();
}

// What parts of the recordings judge, and taken up from a session before.
void of_a_session_that_goes_on() {
  const TemporaryFolder folder;
  const auto input = [&] {
    Input made = offnominal::test::studio_input(folder / "arm.toml", false);
    made.keep_beside = folder / "fitted.csv";
    return made;
  };
  {
    ServedStudio studio(input());
    EXPECT_EQ(studio.get("state").second.at("held_out"), "parts");
    EXPECT_EQ(studio.post("steps", {{"effect", "viscous_friction"}, {"joint", 2}}).first, 200);
    EXPECT_EQ(studio.post("explanation").first, 200);
    studio.wait_for("explanation", [](const json& now) { return now.at("state") != "running"; });
    EXPECT_EQ(studio.get("state").first, 200);
  }
  ServedStudio again(input());
  EXPECT_EQ(again.get("state").second.at("kept").at("taken_up"), 1);
  EXPECT_EQ(again.get("explanation").second.at("state"), "done");
}

void of_an_arm_that_slides() {
  const TemporaryFolder folder;
  Input input = offnominal::test::studio_input(folder / "arm.toml", true);
  input.robot.joints[1].joint.type = offnominal::JointType::kPrismatic;
  ServedStudio studio(std::move(input));
  look(studio);
  const json arm = studio.get("arm?recording=1&instants=20").second;
  EXPECT_FALSE(arm.at("joints").at(1).at("rail_m").is_null());
}

Routes of_files() {
  const TemporaryFolder folder;
  ServedStudio studio(
      std::make_unique<Intake>(
          IntakeSettings{.folder = folder.path(), .limits = {.file = 2'000'000, .all = 3'000'000}}),
      offnominal::test::open_files);
  const auto give = [&](const std::string& name, const std::string& content) {
    return studio.post_text("load/files?name=" + name, content, "application/octet-stream").first;
  };
  EXPECT_EQ(studio.get("load").first, 200);
  EXPECT_EQ(studio.get("state").first, 409);
  EXPECT_EQ(give("run.csv", offnominal::test::strange_csv(1)), 200);
  EXPECT_EQ(studio.post("load/chain", {{"chain", 1}}).first, 409);
  EXPECT_EQ(give("arm.urdf", offnominal::test::sample_arm().text()), 200);
  EXPECT_EQ(studio.get("load").first, 200);
  EXPECT_EQ(studio.post("load/chain", {{"chain", 1}}).first, 200);
  EXPECT_EQ(studio.post("load/chain", {{"chain", 99}}).first, 400);
  EXPECT_EQ(give("arm.toml", offnominal::test::robot_text_of_arm()), 200);
  EXPECT_EQ(give("arm.toml", "joints = 3"), 422);
  EXPECT_EQ(give("more.csv", offnominal::test::strange_csv(0.7)), 200);
  EXPECT_EQ(give("third.csv", offnominal::test::strange_csv(0.5)), 200);
  EXPECT_EQ(studio.post("load/join", {{"recording", 3}, {"to", 1}}).first, 200);
  EXPECT_EQ(studio.get("load/preview?recording=1&pixels=300").first, 200);
  EXPECT_EQ(studio.post("load/split", {{"recording", 1}}).first, 200);
  EXPECT_EQ(studio.erase("load/files/3").first, 200);
  EXPECT_EQ(studio.post("load/held_out", {{"recording", 2}, {"held_out", true}}).first, 200);
  json payload{{"recording", 1}, {"mass_kg", 0.5}, {"x_m", 0}, {"y_m", 0}, {"z_m", 0.1}};
  EXPECT_EQ(studio.post("load/payload", payload).first, 200);
  payload["z_m"] = 101;
  EXPECT_EQ(studio.post("load/payload", payload).first, 422);
  EXPECT_EQ(studio.get("load/preview?recording=1&pixels=300").first, 200);
  EXPECT_EQ(studio.get("load/findings?recording=1&pixels=300").first, 200);
  EXPECT_EQ(studio.erase("load/payload/1").first, 200);
  // Of a column that is no time, what cannot be read.
  EXPECT_EQ(studio.post("load/signal", {{"quantity", "time"}, {"source", "actual_pos_1"}}).first,
            200);
  EXPECT_FALSE(studio.get("load/preview?recording=1&pixels=300").second.at("error").is_null());
  EXPECT_EQ(studio.get("load/findings?recording=1&pixels=300").first, 422);
  EXPECT_EQ(studio.post("load/signal", {{"quantity", "time"}, {"period_s", 0.004}}).first, 200);
  EXPECT_EQ(
      studio.post("load/signal", {{"quantity", "velocity"}, {"joint", 1}, {"source", ""}}).first,
      200);
  EXPECT_EQ(studio.get("load/preview?recording=1&pixels=300").first, 200);
  EXPECT_EQ(studio.post("load/written").first, 409) << "recordings in time";
  EXPECT_EQ(studio.post("load/at_rest", {{"at_rest", true}}).first, 200);
  EXPECT_EQ(studio.get("load/preview?recording=1&pixels=300").first, 200);
  EXPECT_EQ(studio.get("load/findings?recording=1&pixels=300").first, 200);
  EXPECT_EQ(studio.post("load/session").first, 409);
  EXPECT_EQ(studio.post("load/written").first, 200);
  EXPECT_EQ(studio.post("load/guess").first, 200);
  EXPECT_EQ(studio.post("load/signal", {{"quantity", "torque"}, {"joint", 2}, {"scale", -1}}).first,
            200);
  EXPECT_EQ(studio.post("load/session").first, 200);
  look(studio);
  return studio.answered();
}

Routes of_a_campaign() {
  ServedStudio studio(
      std::make_unique<CampaignView>(offnominal::test::small().results().string(), std::nullopt),
      offnominal::test::open_run);
  for (const char* path :
       {"results", "results/figures", "results/figures?kind=offset&joint=", "results/runs?from=0",
        "results/runs?from=3&kind=offset&outcome=missed", "live"}) {
    EXPECT_EQ(studio.get(path).first, 200) << path;
  }
  EXPECT_EQ(studio.get("results/figures?group=single").first, 400) << "of a benchmark alone";
  EXPECT_EQ(studio.get("results/watched?run=2&detector=no_such").first, 400);
  const std::string monitor = offnominal::test::small().rows().campaign.detectors.front().name;
  std::string asked = "results/watched?run=2&detector=" + monitor;
  asked.replace(asked.find(' '), 1, "%20");
  EXPECT_EQ(studio.get(asked).first, 200);
  EXPECT_EQ(studio.post("results/session", {{"run", 1000000}}).first, 400);
  EXPECT_EQ(studio.post("results/session", {{"run", 2}}).first, 200);
  EXPECT_EQ(studio.get("charts?joint=1&recording=1&pixels=300").first, 200);
  return studio.answered();
}

Routes of_a_benchmark() {
  const TemporaryFolder folder;
  const std::string file = (folder / "bench.sqlite").string();
  benchmark::write_benchmark(file, offnominal::test::benchmark_results(), Existing::kRefuse);
  ServedStudio studio(std::make_unique<BenchmarkView>(file), offnominal::test::open_run);
  for (const char* path : {"results", "results/figures", "results/figures?effect=coulomb_friction",
                           "results/runs?from=0", "results/runs?from=0&outcome=failed"}) {
    EXPECT_EQ(studio.get(path).first, 200) << path;
  }
  EXPECT_EQ(studio.post("results/session", {{"run", 5}}).first, 409) << "was not written";
  return studio.answered();
}

Routes of_a_live_view() {
  const TemporaryFolder folder;
  const std::filesystem::path robot_file = folder / "arm.toml";
  live::LiveInput input;
  input.robot = offnominal::test::by_joint_robot(2, 0.5);
  write_robot_file(input.robot, robot_file, Existing::kReplace);
  input.robot_file = robot_file.string();
  input.scenario.plant = input.robot;
  input.folder = folder.path();
  ServedStudio studio(std::make_unique<live::Live>(std::move(input)), [&](const std::string& file) {
    return offnominal::test::open_run(
        {.robot = {robot_file.string(), robot_file.string()}, .logs = {{file, file}}});
  });
  EXPECT_EQ(studio.get("live").second.at("source"), "sil");
  EXPECT_EQ(studio.get("live/frozen?pixels=500").first, 409);
  EXPECT_EQ(studio.post("live/faults", {{"kind", "no_such"}}).first, 400);
  const auto now = [&](const auto& is_there) {
    return studio.wait_for("live/now?from=0", is_there);
  };
  now([](const json& moment) { return moment.at("judging").get<bool>(); });
  EXPECT_EQ(studio.post("live/recording").first, 200);
  EXPECT_EQ(studio.post("live/recording").first, 409);
  now([](const json& moment) { return moment.at("recording_s") > 0.1; });
  EXPECT_EQ(studio.erase("live/recording").first, 200);
  EXPECT_EQ(studio.erase("live/recording").first, 409);
  EXPECT_EQ(studio.post("live/accommodation", {{"on", true}}).first, 200);
  EXPECT_EQ(studio.post("live/accommodation", {{"on", false}}).first, 200);
  EXPECT_EQ(studio.post("live/faults", {{"kind", "frame_loss"}, {"size", 0.001}}).first, 200);
  EXPECT_EQ(studio.get("live/now?from=0").first, 200);
  EXPECT_EQ(studio.erase("live/faults").first, 200);
  const json push{{"kind", "disturbance_torque"}, {"joint", 2}, {"size", 2.5}};
  EXPECT_EQ(studio.post("live/faults", push).first, 200);
  now([](const json& moment) {
    const json& detection = moment.at("detection");
    return !detection.is_null() && detection.at("frozen").get<bool>() &&
           !detection.at("answer").is_null();
  });
  EXPECT_EQ(studio.get("live/frozen?pixels=500").first, 200);
  EXPECT_EQ(studio.post("live/explanation").first, 200);
  EXPECT_EQ(studio.get("live").first, 200);
  EXPECT_EQ(studio.get("state").first, 200);
  EXPECT_FALSE(studio.get("arm?recording=1&instants=20").second.at("over_bound").is_null());
  EXPECT_EQ(studio.erase("explanation").first, 200);
  EXPECT_EQ(studio.post("live/again").first, 200);
  EXPECT_EQ(studio.get("live/now?from=0").first, 200);
  return studio.answered();
}

TEST(StudioApi, AnswersEveryRouteOfItsDocumentAsThatSays) {
  Routes answered;
  for (const Routes& some :
       {of_a_session(), of_files(), of_a_campaign(), of_a_benchmark(), of_a_live_view()}) {
    answered.insert(some.begin(), some.end());
  }
  const std::vector<std::string> all =
      ApiContract(offnominal::desk::studio::assets::api()).routes();
  EXPECT_EQ(answered, Routes(all.begin(), all.end()));
  of_a_session_that_goes_on();
  of_an_arm_that_slides();
}

TEST(StudioApi, HasNoRouteThatItsDocumentHasNotAndLacksNone) {
  httplib::Server server;
  Api api(server, "/api/");
  EXPECT_THROW(api.on("GET /no_such", [](const ApiRequest&) {}), std::out_of_range);
  EXPECT_THROW(api.on("PUT /state", [](const ApiRequest&) {}), std::out_of_range);
  EXPECT_THROW(api.require_all(), std::logic_error);
}

TEST(StudioApi, SaysOfASearchThatFailedWhatItsDocumentSays) {
  const JsonSchema schema(api_document().json(), "/components/schemas/Explanation");
  Job::Report report;
  report.state = Job::State::kFailed;
  report.error = "no memory";
  EXPECT_FALSE(schema.mismatch(json::parse(to_json(report).dump())));
}

}  // namespace
