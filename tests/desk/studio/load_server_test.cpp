// Files that the page is given behind the server: its routes, and the session that comes of them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "desk/studio/served_studio.hpp"
#include "desk/studio/strange_files.hpp"
#include "desk/support/temporary_folder.hpp"
#include "studio/intake.hpp"

namespace {

using nlohmann::json;
using offnominal::test::open_files;
using offnominal::test::robot_text_of_arm;
using offnominal::test::ServedStudio;
using offnominal::test::strange_csv;
using offnominal::test::TemporaryFolder;
using namespace offnominal::desk;
using namespace offnominal::desk::studio;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

class LoadServer : public ::testing::Test {
 protected:
  std::pair<int, json> give(const std::string& name, const std::string& content) {
    return studio_.post_text("load/files?name=" + name, content, "application/octet-stream");
  }
  std::pair<int, json> post(const std::string& path, const json& body) {
    return studio_.post(path, body);
  }
  json get(const std::string& path) { return studio_.get(path).second; }

  TemporaryFolder folder_;
  ServedStudio studio_{
      std::make_unique<Intake>(IntakeSettings{.folder = folder_.path(),
                                              .limits = {.file = 2'000'000, .all = 3'000'000}}),
      open_files};
};

TEST_F(LoadServer, BeginsWithNothingAndBecomesASession) {
  EXPECT_EQ(
      get("live"),
      (json{
          {"source", nullptr}, {"loaded", false}, {"takes_files", true}, {"has_results", false}}));
  EXPECT_EQ(studio_.client().Get(studio_.at("state"))->status, 409);
  EXPECT_EQ(post("load/session", json::object()).first, 409);
  ASSERT_EQ(give("arm.toml", robot_text_of_arm()).first, 200);
  ASSERT_EQ(give("run.csv", strange_csv(1)).first, 200);
  ASSERT_EQ(give("more.csv", strange_csv(0.7)).first, 200);
  ASSERT_EQ(post("load/held_out", {{"recording", 2}, {"held_out", true}}).first, 200);
  ASSERT_EQ(post("load/signal", {{"quantity", "torque"}, {"joint", 2}, {"scale", -1}}).first, 200);
  const json findings = get("load/findings?recording=1&pixels=300");
  const auto [status, answer] = post("load/session", json::object());
  ASSERT_EQ(status, 200) << answer;
  EXPECT_EQ(answer.at("written").size(), 2U);
  const json state = get("state");
  EXPECT_EQ(state.at("held_out"), "recordings");
  EXPECT_EQ(state.at("joints").at(1).at("now").at("fitted_percent"),
            findings.at("joints").at(1).at("error_percent"));
  // Once something was added, another session needs a word.
  ASSERT_EQ(post("steps", {{"effect", "viscous_friction"}, {"joint", 2}}).first, 200);
  EXPECT_TRUE(post("load/session", json::object()).second.at("confirm").get<bool>());
  EXPECT_EQ(post("load/session", {{"replace", true}}).first, 200);
  EXPECT_TRUE(get("state").at("steps").empty());
}

TEST_F(LoadServer, GivesTheSessionAndItsCommandsWhatARecordingCarried) {
  ASSERT_EQ(give("arm.toml", robot_text_of_arm()).first, 200);
  ASSERT_EQ(give("run.csv", strange_csv(1)).first, 200);
  ASSERT_EQ(give("more.csv", strange_csv(0.7)).first, 200);
  ASSERT_EQ(post("load/held_out", {{"recording", 2}, {"held_out", true}}).first, 200);
  ASSERT_EQ(post("load/signal", {{"quantity", "torque"}, {"joint", 2}, {"scale", -1}}).first, 200);
  json payload{{"recording", 2}, {"mass_kg", -1}, {"x_m", 0}, {"y_m", 0}, {"z_m", 0.1}};
  const auto [status, refused] = post("load/payload", payload);
  EXPECT_EQ(status, 422);
  EXPECT_THAT(refused.at("error").get<std::string>(),
              HasSubstr("more.csv: payload: found -1 kg at [0, 0, 0.1] m of the last link"));
  for (const auto& [recording, mass_kg] : {std::pair{1, 0.5}, std::pair{2, 0.25}}) {
    payload["recording"] = recording;
    payload["mass_kg"] = mass_kg;
    ASSERT_EQ(post("load/payload", payload).first, 200);
  }
  const json findings = get("load/findings?recording=1&pixels=300");
  ASSERT_EQ(post("load/session", json::object()).first, 200);
  EXPECT_EQ(get("state").at("joints").at(0).at("now").at("fitted_percent"),
            findings.at("joints").at(0).at("error_percent"));
  ASSERT_EQ(post("steps", {{"effect", "viscous_friction"}, {"joint", 2}}).first, 200);
  const json commands = get("state").at("save").at("commands");
  EXPECT_THAT(commands.at(0).get<std::string>(),
              HasSubstr("--payload run.csv=0.5@0,0,0.1 --payload more.csv=0.25@0,0,0.1"));
  EXPECT_THAT(commands.at(1).get<std::string>(), Not(HasSubstr("more.csv")));
  // Without it, the next session is of the arm alone.
  EXPECT_EQ(studio_.client().Delete(studio_.at("load/payload/1"), studio_.own())->status, 200);
  EXPECT_EQ(studio_.client().Delete(studio_.at("load/payload/2"), studio_.own())->status, 200);
  EXPECT_EQ(studio_.client().Delete(studio_.at("load/payload/3"), studio_.own())->status, 400);
  ASSERT_EQ(post("load/session", {{"replace", true}}).first, 200);
  EXPECT_LT(get("state").at("joints").at(0).at("now").at("fitted_percent"),
            findings.at("joints").at(0).at("error_percent"));
}

TEST_F(LoadServer, TakesLongBodiesForFilesAloneAndSaysTheLimit) {
  const std::string long_body(20'000, ' ');
  // Refused before the API: in plain text, which no answer of a route is.
  EXPECT_EQ(studio_.client()
                .Post(studio_.at("load/signal"), studio_.own(),
                      json{{"quantity", long_body}}.dump(), "application/json")
                ->status,
            413);
  EXPECT_EQ(give("long.csv", long_body).first, 422);  // no recording, but let in
  const auto [status, answer] = give("huge.csv", std::string(20'000'000, ' '));
  EXPECT_EQ(status, 422);
  EXPECT_THAT(answer.at("error").get<std::string>(), HasSubstr("1.91 MiB a file"));
  EXPECT_EQ(studio_.client()
                .Post(studio_.at("load/files?name=a.csv"),
                      {*studio_.own().begin(), {"Content-Encoding", "gzip"}}, "x",
                      "application/octet-stream")
                ->status,
            415);
  EXPECT_EQ(studio_.client()
                .Post(studio_.at("load/files?name=a.csv"), "t,q1\n", "application/octet-stream")
                ->status,
            403);
  EXPECT_EQ(give("..%2Fa.csv", "x").first, 400);
  EXPECT_EQ(give("a%00b.csv", "x").first, 400);
  EXPECT_THAT(get("load").at("recordings"), IsEmpty());
  EXPECT_EQ(get("load").at("limits").at("used"), 0);
}

TEST_F(LoadServer, RefusesWhatItDoesNotUnderstand) {
  give("arm.toml", robot_text_of_arm());
  give("run.csv", strange_csv(1));
  for (const char* path : {"load/preview", "load/preview?recording=1&pixels=1",
                           "load/preview?recording=9&pixels=300", "load/findings?pixels=300"}) {
    EXPECT_EQ(studio_.client().Get(studio_.at(path))->status, 400) << path;
  }
  for (const json& body :
       {json::array(), json{{"quantity", 3}}, json{{"quantity", "torque"}, {"joint", -1}},
        json{{"quantity", "torque"}, {"joint", 0}, {"scale", 1}},
        json{{"quantity", "torque"}, {"joint", 1}, {"scale", "1"}}}) {
    EXPECT_EQ(post("load/signal", body).first, 400) << body;
  }
  EXPECT_EQ(studio_.client().Delete(studio_.at("load/files/9"), studio_.own())->status, 400);
  EXPECT_EQ(studio_.client().Delete(studio_.at("load/files/1"), studio_.own())->status, 200);
  EXPECT_TRUE(get("load").at("map").is_null());
}

}  // namespace
