#pragma once

#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "studio/assets.hpp"
#include "studio/json_schema.hpp"

namespace offnominal::test {

// What the document of the API says of answers.
class ApiDocument {
 public:
  ApiDocument() {
    for (const auto& path : document_.at("paths").items()) {
      for (const auto& method : path.value().items()) {
        const nlohmann::json& responses = method.value().at("responses");
        if (!responses.contains("200")) continue;
        const std::string place = responses["200"]["content"]["application/json"]["schema"]["$ref"];
        answers_.emplace(in_capitals(method.key()) + " " + path.key(),
                         desk::studio::JsonSchema(document_, place.substr(1)));
      }
    }
  }
  [[nodiscard]] const nlohmann::json& json() const { return document_; }

  // "DELETE /steps/{id}" of "DELETE" and "steps/3?x=1".
  [[nodiscard]] static std::string route_of(const std::string& method, const std::string& path) {
    std::string route = method + " /" + path.substr(0, path.find('?'));
    const std::size_t id = route.find_last_of('/') + 1;
    if (id < route.size() && route.find_first_not_of("0123456789", id) == std::string::npos) {
      route.replace(id, std::string::npos, "{id}");
    }
    return route;
  }

  // Whether that is an answer, or a refusal, that the route may give.
  [[nodiscard]] testing::AssertionResult keeps(const std::string& route, int status,
                                               const nlohmann::json& answer) const {
    const desk::studio::JsonSchema* schema = &refusal_;
    if (status == 200) {
      const auto found = answers_.find(route);
      if (found == answers_.end()) return testing::AssertionFailure() << route << " is not in it";
      schema = &found->second;
    } else if (status != 400 && status != 409 && status != 422) {
      return testing::AssertionFailure() << route << " has no status " << status << ": " << answer;
    }
    const auto mismatch = schema->mismatch(answer);
    if (!mismatch) return testing::AssertionSuccess();
    return testing::AssertionFailure()
           << route << ", " << status << ", at \"" << mismatch->place << "\": " << mismatch->words;
  }

  [[nodiscard]] static std::string in_capitals(std::string text) {
    for (char& c : text) c = static_cast<char>(c - 'a' + 'A');
    return text;
  }

 private:
  nlohmann::json document_ = nlohmann::json::parse(desk::studio::assets::api());
  std::map<std::string, desk::studio::JsonSchema> answers_;
  desk::studio::JsonSchema refusal_{document_, "/components/schemas/Refusal"};
};

inline const ApiDocument& api_document() {
  static const ApiDocument document;
  return document;
}

}  // namespace offnominal::test
