// The live view behind the server: its routes, and a detection that is handed to the analysis.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <utility>

#include "desk/sil/serial_robot.hpp"
#include "desk/studio/served_studio.hpp"
#include "desk/studio/studio_input.hpp"
#include "desk/support/temporary_folder.hpp"
#include "live/live.hpp"
#include "log/read_log.hpp"
#include "robot/robot_file.hpp"
#include "studio/http.hpp"
#include "studio/server.hpp"

namespace {

using nlohmann::json;
using offnominal::test::by_joint_robot;
using offnominal::test::ServedStudio;
using offnominal::test::TemporaryFolder;
using namespace offnominal::desk;
using namespace offnominal::desk::studio;
using ::testing::HasSubstr;

Input read_written(const std::filesystem::path& robot_file, const std::string& file) {
  Input input;
  input.robot = read_robot_file(robot_file);
  input.robot_file = robot_file.string();
  Treated recordings;
  recordings.logs.push_back(read_log(file, input.robot.joint_count(), std::nullopt));
  input.recordings = std::make_shared<const Treated>(std::move(recordings));
  input.log_files = {file};
  return input;
}

class LiveServer : public ::testing::Test {
 protected:
  std::pair<int, json> get(const std::string& path) { return studio_.get(path); }
  std::pair<int, json> post(const std::string& path, const json& body) {
    return studio_.post(path, body);
  }
  json wait_for(const std::function<bool(const json&)>& is_there) {
    return studio_.wait_for("live/now?from=0", is_there);
  }

  std::unique_ptr<live::Live> bench() {
    const RobotDescription robot = by_joint_robot(2, 0.5);
    write_robot_file(robot, robot_file_, Existing::kReplace);
    live::LiveInput input;
    input.robot = robot;
    input.robot_file = robot_file_.string();
    input.scenario.plant = robot;
    input.folder = folder_.path();
    return std::make_unique<live::Live>(std::move(input));
  }

  TemporaryFolder folder_;
  std::filesystem::path robot_file_ = folder_ / "arm.toml";
  ServedStudio studio_{bench(),
                       [this](const std::string& file) { return read_written(robot_file_, file); }};
};

TEST_F(LiveServer, SaysWhatThereIsAndHasNoSessionYet) {
  const json setup = get("live").second;
  EXPECT_EQ(setup.at("source"), "sil");
  EXPECT_EQ(setup.at("space"), "torque");
  EXPECT_EQ(setup.at("judged").size(), 2U);
  EXPECT_FALSE(setup.at("loaded").get<bool>());
  EXPECT_GT(setup.at("faults").size(), 10U);
  const auto [status, refused] = get("state");
  EXPECT_EQ(status, 409);
  EXPECT_THAT(refused.at("error").get<std::string>(), HasSubstr("No recording is loaded yet"));
  EXPECT_EQ(get("live/frozen?pixels=500").first, 409);
  EXPECT_EQ(post("live/explanation", json::object()).first, 409);
}

TEST_F(LiveServer, GivesEveryStepOnceToWhoAsksForWhatIsNew) {
  const json first = wait_for([](const json& now) { return now.at("steps").at("next") > 10; });
  const int next = first.at("steps").at("next");
  EXPECT_EQ(first.at("steps").at("t_s").size(), static_cast<std::size_t>(next));
  const json more = get("live/now?from=" + std::to_string(next)).second;
  EXPECT_EQ(more.at("steps").at("first"), next);
  for (const char* from : {"live/now", "live/now?from=", "live/now?from=-1", "live/now?from=x"}) {
    EXPECT_EQ(get(from).first, 400) << from;
  }
}

TEST_F(LiveServer, TakesChangesOnlyFromItsOwnPage) {
  const json fault{{"kind", "friction_jump"}, {"joint", 1}, {"size", 1}};
  EXPECT_EQ(
      studio_.client().Post(studio_.at("live/faults"), fault.dump(), "application/json")->status,
      403);
  EXPECT_EQ(studio_.client().Get("/api/live")->status, 404);
  for (const json& body :
       {json{{"kind", "no_such"}}, json::array(), json{{"kind", "friction_jump"}, {"joint", 9}},
        json{{"kind", "friction_jump"}, {"joint", 1}, {"size", -1}},
        json{{"kind", "friction_jump"}, {"joint", 1}, {"size", 0}},
        json{{"kind", "friction_jump"}, {"joint", 1}, {"size", nullptr}},
        json{{"kind", "friction_jump"}, {"joint", 1}}, json{{"kind", "frame_loss"}},
        json{{"kind", "friction_jump"}, {"joint", "1"}, {"size", 1}}}) {
    EXPECT_EQ(post("live/faults", body).first, 400) << body;
  }
  EXPECT_EQ(post("live/accommodation", {{"on", 1}}).first, 400);
  EXPECT_EQ(post("live/accommodation", {{"on", true}}).first, 200);
  EXPECT_TRUE(get("live/now?from=0").second.at("accommodates").get<bool>());
}

TEST_F(LiveServer, HandsADetectionToTheAnalysis) {
  wait_for([](const json& now) { return now.at("judging").get<bool>(); });
  const json fault{{"kind", "disturbance_torque"}, {"joint", 2}, {"size", 2.5}};
  ASSERT_EQ(post("live/faults", fault).first, 200);
  const json there = wait_for([](const json& now) {
    return !now.at("detection").is_null() && now.at("detection").at("frozen").get<bool>();
  });
  EXPECT_EQ(there.at("detection").at("joint"), 2);
  const double detected_s = there.at("detection").at("t_s");
  EXPECT_EQ(get("live/frozen?pixels=500").second.at("charts").size(), 2U);
  wait_for([&](const json& now) { return now.at("t_s") > detected_s + 6; });
  const auto [status, answer] = post("live/explanation", json::object());
  ASSERT_EQ(status, 200) << answer;
  EXPECT_TRUE(std::filesystem::exists(answer.at("saved").get<std::string>()));
  EXPECT_TRUE(std::filesystem::exists(answer.at("before").get<std::string>()));
  EXPECT_TRUE(get("live").second.at("loaded").get<bool>());
  // Another page sees that there is a session, and its own click begins no second one.
  EXPECT_EQ(there.at("session"), 0);
  EXPECT_EQ(answer.at("session"), 1);
  EXPECT_EQ(get("live/now?from=0").second.at("session"), 1);
  EXPECT_EQ(post("live/explanation", json::object()).second, answer);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "arm_detection_2.csv"));
  const json state = get("state").second;
  EXPECT_EQ(state.at("recordings").at(0).at("name"), answer.at("saved"));
  json explanation;
  do {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    explanation = get("explanation").second;
  } while (explanation.at("state") == "running");
  EXPECT_EQ(explanation.at("state"), "done") << explanation;
}

TEST_F(LiveServer, WritesARecordingWholeAndOverNothing) {
  EXPECT_EQ(studio_.client().Delete(studio_.at("live/recording"), studio_.own())->status, 409);
  wait_for([](const json& now) { return now.at("judging").get<bool>(); });
  for (const char* name : {"arm_live.csv", "arm_live_2.csv"}) {
    ASSERT_EQ(post("live/recording", json::object()).first, 200);
    EXPECT_EQ(post("live/recording", json::object()).first, 409);
    wait_for([](const json& now) { return now.at("recording_s") > 0.3; });
    const json written =
        json::parse(studio_.client().Delete(studio_.at("live/recording"), studio_.own())->body);
    EXPECT_EQ(written.at("saved"), (folder_ / name).string());
    const Log log = read_log(folder_ / name, 2, std::nullopt);
    EXPECT_GT(log.sample_count(), 200);
    EXPECT_TRUE(log.gaps.empty());
  }
}

TEST(LiveServerOfRecordings, SaysThatThereIsNoLiveView) {
  const TemporaryFolder folder;
  Server server(offnominal::test::studio_input(folder / "arm.toml", true), 0);
  std::thread thread([&] { server.run(); });
  const std::string address = server.address();
  const std::string path = address.substr(address.find('/', std::string("http://").size()));
  httplib::Client client("127.0.0.1", server.port());
  EXPECT_TRUE(json::parse(client.Get(path + "api/live")->body).at("source").is_null());
  EXPECT_EQ(client.Get(path + "api/live/now?from=0")->status, 409);
  server.stop();
  thread.join();
}

}  // namespace
