#include "studio/server.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <httplib.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <utility>

#include "desk/studio/api_document.hpp"
#include "desk/studio/studio_input.hpp"
#include "desk/support/temporary_folder.hpp"
#include "studio/routes.hpp"

namespace {

using nlohmann::json;
using offnominal::test::api_document;
using offnominal::test::ApiDocument;
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

  // It is as the document of the API has it.
  static std::pair<int, json> taken(const std::string& method, const std::string& path,
                                    const httplib::Result& result) {
    const json answer = json::parse(result->body);
    EXPECT_TRUE(api_document().keeps(ApiDocument::route_of(method, path), result->status, answer));
    return {result->status, answer};
  }
  json get(const std::string& path) {
    const auto result = client().Get(at("api/" + path));
    EXPECT_TRUE(result);
    EXPECT_EQ(result->status, 200) << result->body;
    return taken("GET", path, result).second;
  }
  // Its status, and what it says.
  std::pair<int, json> post(const std::string& path, const json& body) {
    const auto result =
        client().Post(at("api/" + path), {{"Origin", own()}}, body.dump(), "application/json");
    EXPECT_TRUE(result);
    return taken("POST", path, result);
  }
  std::pair<int, json> erase(const std::string& path) {
    const auto result = client().Delete(at("api/" + path), {{"Origin", own()}});
    EXPECT_TRUE(result);
    return taken("DELETE", path, result);
  }

  // The first that comes back of a request whose body is still to come.
  [[nodiscard]] std::string answer_to(const std::string& request) const {
    const int connection = ::socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in there{};
    there.sin_family = AF_INET;
    there.sin_port = htons(static_cast<std::uint16_t>(server_.port()));
    there.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    std::string answer(256, ' ');
    ssize_t got = -1;
    if (::connect(connection, reinterpret_cast<const sockaddr*>(&there), sizeof there) == 0 &&
        ::send(connection, request.data(), request.size(), 0) ==
            static_cast<ssize_t>(request.size())) {
      got = ::recv(connection, answer.data(), answer.size(), 0);
    }
    ::close(connection);
    answer.resize(static_cast<std::size_t>(std::max<ssize_t>(got, 0)));
    return answer;
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
  for (const char* file : {"studio.css", "studio.js", "arm_view.js"}) {
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

// Whoever writes an address by hand hears in words what is wrong with it; nothing is a fault of the
// program.
TEST_F(StudioServer, DrawsATimeWithoutASampleAndRefusesOneThatCannotBe) {
  const std::string shown = "joint=2&recording=1&";
  for (const char* range : {"from=100&to=200", "from=-20&to=-10", "from=5.0001&to=5.0002"}) {
    for (const std::string& view :
         {"charts?pixels=500&" + shown, "map?x=velocity&y=position&" + shown,
          "spectrum?over=order&" + shown, "spectrum?over=frequency&" + shown,
          std::string("arm?recording=1&")}) {
      get(view + range);
    }
  }
  for (const char* range : {"from=3&to=2", "from=3&to=3", "from=3", "to=2", "from=-1e300&to=1e300",
                            "from=nan&to=1", "from=1&to=1e999"}) {
    for (const std::string& view :
         {"charts?pixels=500&" + shown, std::string("arm?recording=1&")}) {
      const auto answer = client().Get(at("api/" + view + range));
      ASSERT_TRUE(answer);
      EXPECT_EQ(answer->status, 400) << view << range << ": " << answer->body;
    }
  }
  json look{{"joint", 2}, {"recording", 1}, {"beside", nullptr}, {"from", 1}, {"to", 2}};
  EXPECT_EQ(post("look", look).first, 200);
  for (const auto& [from, to] : {std::pair(json(3), json(2)), std::pair(json(-1e300), json(1e300)),
                                 std::pair(json(3), json(nullptr))}) {
    look["from"] = from;
    look["to"] = to;
    const auto [status, answer] = post("look", look);
    EXPECT_EQ(status, 400) << look;
    EXPECT_THAT(answer.at("error").get<std::string>(), HasSubstr("from"));
  }
}

// Of a body in pieces any length would get in so.
TEST_F(StudioServer, RefusesABodyInPieces) {
  const std::string head = "POST " + at("api/steps") +
                           " HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(server_.port()) +
                           "\r\nOrigin: " + own() + "\r\nContent-Type: application/json\r\n";
  EXPECT_THAT(answer_to(head + "Transfer-Encoding: chunked\r\n\r\n"), HasSubstr(" 411 "));
  EXPECT_THAT(answer_to(head + "Content-Length: 2\r\nTransfer-Encoding: chunked\r\n\r\n"),
              HasSubstr(" 411 "));
  EXPECT_THAT(answer_to(head + "\r\n"), HasSubstr(" 411 "));
}

TEST_F(StudioServer, SaysTheSavedNameFromThenOn) {
  EXPECT_EQ(post("steps", {{"effect", "viscous_friction"}, {"joint", 2}}).first, 200);
  EXPECT_EQ(get("state").at("save").at("name"), "arm_studio.toml");
  const auto [status, answer] = post("save", {{"name", "mine.toml"}});
  ASSERT_EQ(status, 200);
  const json save = get("state").at("save");
  EXPECT_EQ(save.at("name"), "mine.toml");
  EXPECT_EQ(save.at("saved"), answer.at("saved"));
  EXPECT_EQ(save.at("commands"), answer.at("commands"));
  EXPECT_THAT(save.at("commands").at(0).get<std::string>(),
              HasSubstr((folder_ / "mine_again.toml").string()));
  // No command can start from a robot file that is not there any more.
  ASSERT_EQ(post("save", {{"name", "arm.toml"}, {"replace", true}}).first, 200);
  EXPECT_TRUE(get("state").at("save").at("commands").empty());
}

TEST(StudioServerAlone, EndsWhereItIsStoppedBeforeItServes) {
  const TemporaryFolder folder;
  Server server(studio_input(folder / "arm.toml", true), 0);
  server.stop();
  std::atomic<bool> has_ended = false;
  std::thread thread([&] {
    server.run();
    has_ended = true;
  });
  for (int i = 0; i < 100 && !has_ended; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  EXPECT_TRUE(has_ended);
  if (has_ended) thread.join();
  if (!has_ended) std::quick_exit(1);
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
        "charts?joint=1&recording=1&pixels=500&from=nan&to=1", "arm",
        "arm?recording=", "arm?recording=0", "arm?recording=3", "arm?recording=-1",
        "arm?recording=1e9", "arm?recording=99999999999999999999", "arm?recording=1&instants=1",
        "arm?recording=1&instants=1001", "arm?recording=1&from=nan&to=1",
        "arm?recording=1&from=2&to=1", "arm?recording=1&from=2&to=2",
        "arm?recording=1&from=1e999&to=2", "arm?recording=1%00&from=1&to=2",
        "arm?recording=<img>&instants=;"}) {
    EXPECT_EQ(client().Get(at("api/") + charts)->status, 400) << charts;
  }
}

TEST_F(StudioServer, GivesTheArmWithTheRevisionOfTheModel) {
  const json whole = get("arm?recording=1");
  EXPECT_EQ(whole.at("revision"), 0);
  EXPECT_GT(whole.at("t_s").size(), 300U);
  EXPECT_EQ(post("steps", {{"effect", "viscous_friction"}, {"joint", 2}}).first, 200);
  const json part = get("arm?recording=2&instants=20&from=2&to=3");
  EXPECT_EQ(part.at("revision"), 1);
  EXPECT_EQ(part.at("recording"), 2);
  for (const char* what : {"position", "measured", "model", "error"}) {
    ASSERT_EQ(part.at(what).size(), 2U) << what;
    EXPECT_EQ(part.at(what).at(1).size(), 20U) << what;
  }
  EXPECT_EQ(part.at("place_m").at(1).size(), 60U);
  EXPECT_EQ(part.at("turn").at(1).size(), 80U);
}

TEST_F(StudioServer, SearchesInTheBackgroundAndStops) {
  EXPECT_EQ(get("explanation").at("state"), "none");
  EXPECT_EQ(post("explanation", json::object()).second.at("state"), "running");
  // One heavy job at a time; what is looked at stays.
  EXPECT_EQ(post("steps", {{"effect", "viscous_friction"}, {"joint", 2}}).first, 409);
  EXPECT_EQ(post("explanation", json::object()).first, 409);
  EXPECT_EQ(get("charts?joint=1&recording=1&pixels=500").at("charts").size(), 4U);
  EXPECT_EQ(get("arm?recording=1").at("joints").size(), 2U);
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
