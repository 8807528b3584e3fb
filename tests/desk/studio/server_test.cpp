#include "studio/server.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <httplib.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>

#include "desk/studio/studio_input.hpp"
#include "desk/support/temporary_folder.hpp"
#include "studio/routes.hpp"

namespace {

using nlohmann::json;
using offnominal::test::studio_input;
using offnominal::test::TemporaryFolder;
using namespace offnominal::desk;
using namespace offnominal::desk::studio;
using ::testing::HasSubstr;
using ::testing::Not;

class StudioServer : public ::testing::Test {
 protected:
  void TearDown() override {
    server_.stop();
    thread_.join();
  }

  // The path of an address of the page.
  [[nodiscard]] std::string at(const std::string& path) const {
    const std::string address = server_.address();
    return address.substr(address.find('/', std::string("http://").size())) + path;
  }
  [[nodiscard]] std::string own() const {
    return "http://127.0.0.1:" + std::to_string(server_.port());
  }
  [[nodiscard]] httplib::Client client() const {
    httplib::Client made("127.0.0.1", server_.port());
    made.set_read_timeout(120);
    return made;
  }

  json get(const std::string& path) {
    const auto result = client().Get(at("api/" + path));
    EXPECT_TRUE(result);
    EXPECT_EQ(result->status, 200) << result->body;
    return json::parse(result->body);
  }
  // Its status, and what it says.
  std::pair<int, json> post(const std::string& path, const json& body) {
    const auto result =
        client().Post(at("api/" + path), {{"Origin", own()}}, body.dump(), "application/json");
    EXPECT_TRUE(result);
    return {result->status, json::parse(result->body)};
  }
  std::pair<int, json> erase(const std::string& path) {
    const auto result = client().Delete(at("api/" + path), {{"Origin", own()}});
    EXPECT_TRUE(result);
    return {result->status, json::parse(result->body)};
  }

  TemporaryFolder folder_;
  Server server_{studio_input(folder_ / "arm.toml", true), 0};
  std::thread thread_{[this] { server_.run(); }};
};

TEST_F(StudioServer, ServesThePageWithoutInlineScriptAndNothingWithoutTheToken) {
  const auto page = client().Get(at(""));
  ASSERT_TRUE(page);
  EXPECT_EQ(page->status, 200);
  EXPECT_THAT(page->get_header_value("Content-Security-Policy"), HasSubstr("script-src 'self';"));
  EXPECT_THAT(page->get_header_value("Content-Security-Policy"), HasSubstr("default-src 'none'"));
  EXPECT_EQ(page->get_header_value("Referrer-Policy"), "no-referrer");
  EXPECT_THAT(page->body, Not(HasSubstr("<script>")));
  for (const char* file : {"studio.css", "studio.js", "report.js", "echarts.js"}) {
    EXPECT_EQ(client().Get(at(file))->status, 200) << file;
  }
  EXPECT_EQ(client().Get("/")->status, 404);
  EXPECT_EQ(client().Get("/api/state")->status, 404);
  EXPECT_EQ(client().Get(at("../../etc/passwd"))->status, 404);
  EXPECT_EQ(client().Get(at("arm.toml"))->status, 404);
}

TEST_F(StudioServer, RefusesAnotherHostOriginMethodAndTooLongABody) {
  EXPECT_EQ(client().Get(at("api/state"), {{"Host", "evil.example"}})->status, 403);
  EXPECT_EQ(client().Get(at("api/state"), {{"Origin", "http://evil.example"}})->status, 403);
  EXPECT_EQ(client().Post(at("api/steps"), "{}", "application/json")->status, 403);
  EXPECT_EQ(client().Put(at("api/steps"), {{"Origin", own()}}, "{}", "application/json")->status,
            405);
  const std::string long_body(kMostBody + 1, ' ');
  EXPECT_EQ(
      client().Post(at("api/steps"), {{"Origin", own()}}, long_body, "application/json")->status,
      413);
  EXPECT_EQ(client().Post(at("api/steps"), {{"Origin", own()}}, "{}", "text/plain")->status, 400);
}

TEST_F(StudioServer, AddsUndoesAndSavesByTheNumbersOfTheWorkbench) {
  Workbench same(studio_input(folder_ / "same.toml", true));
  EXPECT_EQ(post("steps", {{"effect", "viscous_friction"}, {"joint", 2}}).first, 200);
  const auto [status, state] = post("steps", {{"effect", "coulomb_friction"}, {"joint", 2}});
  EXPECT_EQ(status, 200);
  same.add(offnominal::EffectKind::kViscousFriction, 1);
  same.add(offnominal::EffectKind::kCoulombFriction, 1);
  const json& now = state.at("joints").at(1).at("now");
  EXPECT_EQ(now.at("held_out_percent").get<double>(), same.held_out_percent(1, 2));
  EXPECT_EQ(now.at("fitted_percent").get<double>(), same.fitted_percent(1, 2));
  EXPECT_EQ(get("charts?joint=2&recording=1&pixels=500").at("charts").size(), 4U);
  EXPECT_EQ(post("save", {{"name", "a.toml"}}).first, 200);
  EXPECT_TRUE(post("save", {{"name", "a.toml"}}).second.at("confirm").get<bool>());

  const std::string first = std::to_string(state.at("steps").at(0).at("id").get<int>());
  const json undone = erase("steps/" + first).second;
  same.undo(same.steps()[0].id);
  EXPECT_EQ(undone.at("joints").at(1).at("now").at("held_out_percent").get<double>(),
            same.held_out_percent(1, 1));
  EXPECT_EQ(erase("steps/" + first).first, 400);
}

TEST_F(StudioServer, RefusesWhatItDoesNotUnderstandInWords) {
  for (const json& body :
       {json{{"effect", "no_such"}, {"joint", 1}}, json{{"effect", "viscous_friction"}},
        json{{"effect", "viscous_friction"}, {"joint", 9}}, json{{"effect", 3}, {"joint", 1}},
        json::array(), json{{"effect", "viscous_friction"}, {"joint", "1"}}}) {
    const auto [status, answer] = post("steps", body);
    EXPECT_EQ(status, 400) << body;
    EXPECT_FALSE(answer.at("error").get<std::string>().empty());
  }
  for (const char* charts :
       {"charts", "charts?joint=0&recording=1&pixels=500", "charts?joint=1&recording=1&pixels=5e9",
        "charts?joint=1&recording=1&pixels=500&from=nan&to=1"}) {
    EXPECT_EQ(client().Get(at("api/") + charts)->status, 400) << charts;
  }
}

TEST_F(StudioServer, SearchesInTheBackgroundAndStops) {
  EXPECT_EQ(get("explanation").at("state"), "none");
  EXPECT_EQ(post("explanation", json::object()).second.at("state"), "running");
  // One heavy job at a time; what is looked at stays.
  EXPECT_EQ(post("steps", {{"effect", "viscous_friction"}, {"joint", 2}}).first, 409);
  EXPECT_EQ(post("explanation", json::object()).first, 409);
  EXPECT_EQ(get("charts?joint=1&recording=1&pixels=500").at("charts").size(), 4U);
  erase("explanation");
  json answer;
  do {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    answer = get("explanation");
  } while (answer.at("state") == "running");
  EXPECT_EQ(answer.at("state"), "stopped");
  EXPECT_EQ(post("steps", {{"effect", "viscous_friction"}, {"joint", 2}}).first, 200);
}

}  // namespace
