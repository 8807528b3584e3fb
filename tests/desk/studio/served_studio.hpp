#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <functional>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <thread>
#include <utility>

#include "desk/studio/api_document.hpp"
#include "studio/http.hpp"
#include "studio/server.hpp"

namespace offnominal::test {

// A server while it serves, and its page: every answer is held against the document of the API.
class ServedStudio {
 public:
  using Answer = std::pair<int, nlohmann::json>;  // the status, and what it says

  template <typename... Shown>
  explicit ServedStudio(Shown&&... shown)
      : server_(std::forward<Shown>(shown)..., 0), thread_([this] { server_.run(); }) {}
  ServedStudio(const ServedStudio&) = delete;
  ServedStudio& operator=(const ServedStudio&) = delete;
  ~ServedStudio() {
    server_.stop();
    thread_.join();
  }

  Answer get(const std::string& path) { return taken("GET", path, client().Get(at(path))); }
  Answer post(const std::string& path, const nlohmann::json& body = nlohmann::json::object()) {
    return post_text(path, body.dump(), "application/json");
  }
  Answer post_text(const std::string& path, const std::string& body, const std::string& type) {
    return taken("POST", path, client().Post(at(path), own(), body, type));
  }
  Answer erase(const std::string& path) {
    return taken("DELETE", path, client().Delete(at(path), own()));
  }
  // What there is once `is_there` says so; no time is asserted.
  nlohmann::json wait_for(const std::string& path,
                          const std::function<bool(const nlohmann::json&)>& is_there) {
    nlohmann::json now;
    for (int i = 0; i < 12000; ++i) {
      now = get(path).second;
      if (is_there(now)) return now;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    ADD_FAILURE() << "did not come about: " << now;
    return now;
  }
  // Routes that have given an answer.
  [[nodiscard]] const std::set<std::string>& answered() const { return answered_; }

  // For requests that the page would not make: where, by whom, and the headers of its own.
  [[nodiscard]] std::string at(const std::string& path) const {
    const std::string address = server_.address();
    return address.substr(address.find('/', std::string("http://").size())) + "api/" + path;
  }
  [[nodiscard]] httplib::Client client() const {
    httplib::Client made("127.0.0.1", server_.port());
    made.set_read_timeout(120);
    return made;
  }
  [[nodiscard]] httplib::Headers own() const {
    return {{"Origin", "http://127.0.0.1:" + std::to_string(server_.port())}};
  }

 private:
  Answer taken(const std::string& method, const std::string& path, const httplib::Result& result) {
    const std::string route = ApiDocument::route_of(method, path);
    if (!result) {
      ADD_FAILURE() << route << " has no answer";
      return {0, nullptr};
    }
    EXPECT_EQ(result->get_header_value("Cache-Control"), "no-store") << route;
    if (result->status == 204) {
      EXPECT_TRUE(result->body.empty()) << route;
      answered_.insert(route);
      return {204, nullptr};
    }
    nlohmann::json answer = nlohmann::json::parse(result->body, nullptr, false);
    EXPECT_TRUE(api_document().keeps(route, result->status, answer)) << path;
    if (result->status == 200) answered_.insert(route);
    return {result->status, std::move(answer)};
  }

  desk::studio::Server server_;
  std::thread thread_;
  std::set<std::string> answered_;
};

}  // namespace offnominal::test
