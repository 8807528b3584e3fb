// What Studio's API refuses before a route sees it: of every route of the document, every field
// that is missing, unknown, of another type or out of its range.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "common/refused.hpp"
#include "desk/studio/api_document.hpp"
#include "desk/studio/served_studio.hpp"
#include "desk/studio/studio_input.hpp"
#include "desk/support/temporary_folder.hpp"
#include "studio/api_contract.hpp"
#include "studio/arm.hpp"
#include "studio/charts.hpp"
#include "studio/mismatch_words.hpp"

namespace {

using nlohmann::json;
using offnominal::test::api_document;
using offnominal::test::ApiDocument;
using offnominal::test::ServedStudio;
using offnominal::test::TemporaryFolder;
using namespace offnominal::desk;
using namespace offnominal::desk::studio;
using ::testing::HasSubstr;

const json& resolved_here(const json& schema) { return resolved(api_document().json(), schema); }

// Something that the schema of a field allows.
json allowed_by(const json& field) {
  const json& schema = resolved_here(field);
  if (schema.contains("enum")) return schema["enum"][0];
  const json type = schema["type"].is_array() ? schema["type"][0] : schema["type"];
  if (type == "string") return "some";
  if (type == "boolean") return true;
  return schema.value("minimum", json(1));
}

// What it does not allow: another type, and what lies outside of its range.
std::vector<json> not_allowed_by(const json& field) {
  const json& schema = resolved_here(field);
  const json type = schema["type"].is_array() ? schema["type"][0] : schema["type"];
  std::vector<json> wrong{json::array(), json::object(), json::array({1})};
  if (!schema["type"].is_array()) wrong.push_back(nullptr);
  if (type == "string") wrong.push_back(1);
  if (type == "boolean") wrong.insert(wrong.end(), {1, "true"});
  if (type == "integer") wrong.insert(wrong.end(), {"1", 1.5, true});
  if (type == "number") wrong.insert(wrong.end(), {"1", false});
  if (schema.contains("enum")) wrong.push_back("no_such");
  if (schema.contains("minimum")) wrong.push_back(schema["minimum"].get<double>() - 1);
  if (type == "integer" && schema.contains("minimum")) {
    wrong.push_back(schema["minimum"].get<std::int64_t>() - 1);
    // Beyond what a program counts with.
    wrong.insert(wrong.end(), {INT64_MIN, 9223372036854775808U, UINT64_MAX});
  }
  if (schema.contains("maximum")) wrong.push_back(schema["maximum"].get<std::int64_t>() + 1);
  return wrong;
}

// The same in a query, where all is text.
std::vector<std::string> texts_not_allowed_by(const json& field) {
  const json& schema = resolved_here(field);
  std::vector<std::string> wrong;
  if (schema["type"] == "string") {
    if (schema.contains("enum")) wrong = {"", "no_such", "1"};
    return wrong;
  }
  wrong = {"", "x", "nan", "inf", "1x", " 1", "+1", "0x10", "1e999", "<img>", "1\n"};
  if (schema["type"] == "integer") {
    wrong.insert(wrong.end(), {"1.0", "1e2", "99999999999999999999", "18446744073709551615"});
  }
  if (schema.contains("minimum")) {
    wrong.push_back(std::to_string(schema["minimum"].get<std::int64_t>() - 1));
  }
  if (schema.contains("maximum")) {
    wrong.push_back(std::to_string(schema["maximum"].get<std::int64_t>() + 1));
  }
  return wrong;
}

// A request that the document allows.
struct Request {
  std::string method;
  std::string path;
  std::map<std::string, std::string> query;
  std::string type;
  json body;
  std::string text;  // in place of the body, where there is any

  [[nodiscard]] std::string address() const {
    std::string all = path.substr(1);
    for (const auto& [name, value] : query) {
      const std::string whole = name + "=" + httplib::detail::encode_query_param(value);
      all += (all.find('?') == std::string::npos ? "?" : "&") + whole;
    }
    return all;
  }
};

class StudioRequests : public ::testing::Test {
 protected:
  ServedStudio::Answer send(const Request& one) {
    if (one.method == "GET") return studio_.get(one.address());
    if (one.method == "DELETE") return studio_.erase(one.address());
    return studio_.post_text(one.address(), one.text.empty() ? one.body.dump() : one.text,
                             one.type);
  }
  // It is not understood, and the words name the field.
  void expect_refused(const Request& one, const std::string& field) {
    const auto [status, answer] = send(one);
    const std::string what = one.method + " " + one.address() + " " + one.body.dump();
    EXPECT_EQ(status, 400) << what;
    if (status != 400) return;
    EXPECT_THAT(answer.at("error").get<std::string>(), HasSubstr(field)) << what;
    EXPECT_FALSE(answer.at("confirm").get<bool>());
    ++refused_;
  }

  void expect_query_is_checked(const Request& good, const json& parameters) {
    Request bad = good;
    bad.query["colour"] = "red";
    expect_refused(bad, "\"colour\" is not known");
    for (const json& one : parameters) {
      if (one["in"] != "query") continue;
      const std::string name = one["name"];
      bad = good;
      bad.query.erase(name);
      if (one["required"].get<bool>()) expect_refused(bad, name + " is missing");
      for (const std::string& wrong : texts_not_allowed_by(one["schema"])) {
        bad.query[name] = wrong;
        expect_refused(bad, name + " is ");
      }
      bad = good;
      bad.query.erase(name);
      bad.path += "?" + name + "=1&" + name + "=2";  // of the same twice httplib tells nothing
      expect_refused(bad, name + " is there twice");
    }
  }

  void expect_body_is_checked(const Request& good, const json& schema) {
    Request bad = good;
    for (const json& wrong : {json::array(), json(1), json("x"), json(nullptr)}) {
      bad.body = wrong;
      expect_refused(bad, "The body is ");
    }
    bad = good;
    bad.body["colour"] = "red";
    expect_refused(bad, "\"colour\" is not known");
    for (const char* text : {"{", "{'a': 1}", "{\"a\": 1e999}", "nonsense", "{} {}"}) {
      bad.text = text;
      expect_refused(bad, "The body is no JSON.");
    }
    bad = good;
    bad.type = "text/plain";
    expect_refused(bad, "The body has to be application/json.");
    for (const auto& field : schema["properties"].items()) {
      bad = good;
      bad.body.erase(field.key());
      const json& required = schema["required"];
      if (std::find(required.begin(), required.end(), field.key()) != required.end()) {
        expect_refused(bad, field.key() + " is missing");
      }
      for (const json& wrong : not_allowed_by(field.value())) {
        bad.body[field.key()] = wrong;
        expect_refused(bad, field.key() + " is ");
      }
    }
  }

  TemporaryFolder folder_;
  ServedStudio studio_{offnominal::test::studio_input(folder_ / "arm.toml", true)};
  int refused_ = 0;
};

TEST_F(StudioRequests, OfEveryRouteAreRefusedWhereAFieldIsNotAsTheDocumentSays) {
  for (const auto& path : api_document().json()["paths"].items()) {
    for (const auto& method : path.value().items()) {
      const json& operation = method.value();
      const json parameters = operation.value("parameters", json::array());
      Request good{ApiDocument::in_capitals(method.key()), path.key(), {}, "", nullptr, ""};
      const std::size_t id = good.path.find("{id}");
      if (id != std::string::npos) good.path.replace(id, 4, "1");
      for (const json& one : parameters) {
        if (one["in"] != "query" || !one["required"].get<bool>()) continue;
        const json value = allowed_by(one["schema"]);
        good.query[one["name"]] = value.is_string() ? value.get<std::string>() : value.dump();
      }
      json schema;
      if (operation.contains("requestBody")) {
        const auto content = operation["requestBody"]["content"].items().begin();
        good.type = content.key();
        if (content.value().contains("schema")) schema = resolved_here(content.value()["schema"]);
      }
      if (schema.is_object()) {
        good.body = json::object();
        for (const json& name : schema["required"]) {
          const std::string field = name;
          good.body[field] = allowed_by(schema["properties"][field]);
        }
      }
      expect_query_is_checked(good, parameters);
      if (schema.is_object()) expect_body_is_checked(good, schema);
    }
  }
  EXPECT_GT(refused_, 600);
}

TEST_F(StudioRequests, OfAPlaceInTheirPathAreRefusedWhereItIsNoNumber) {
  for (const char* path : {"steps/x", "steps/0", "steps/-1", "steps/1000000000", "steps/1.5",
                           "load/files/x", "load/files/99999999999999999999"}) {
    const auto [status, answer] = studio_.erase(path);
    EXPECT_EQ(status, 400) << path;
    EXPECT_THAT(answer.at("error").get<std::string>(), HasSubstr("id is ")) << path;
  }
}

TEST_F(StudioRequests, AreRefusedInOneLineThatSaysFieldFoundAndAllowed) {
  const auto error_of = [](const ServedStudio::Answer& answer) {
    return answer.second.at("error").get<std::string>();
  };
  EXPECT_EQ(error_of(studio_.post("steps", {{"effect", "backlash"}})),
            "joint is missing; allowed: a whole number from 1 to 1000.");
  EXPECT_EQ(error_of(studio_.post("steps", {{"effect", "backlash"}, {"jiont", 1}})),
            "\"jiont\" is not known; allowed: effect or joint.");
  EXPECT_EQ(error_of(studio_.post("steps", {{"effect", "backlash"}, {"joint", 0}})),
            "joint is 0; allowed: a whole number from 1 to 1000.");
  EXPECT_EQ(error_of(studio_.post("save", {{"replace", std::string(200, 'a')}})),
            "replace is \"" + std::string(40, 'a') + "...\"; allowed: true or false.");
  EXPECT_EQ(error_of(studio_.post("explanation", {{"a", 1}})),
            "\"a\" is not known; allowed: no field.");
  EXPECT_EQ(error_of(studio_.get("spectrum?joint=1&recording=1&over=time")),
            "over is \"time\"; allowed: frequency or order.");
  EXPECT_EQ(error_of(studio_.get("charts?joint=1&recording=1&pixels=5e9")),
            "pixels is \"5e9\"; allowed: a whole number from 100 to 8000.");
  // What a document cannot say of several fields together.
  EXPECT_EQ(error_of(studio_.get("arm?recording=1&from=1")),
            "from and to go together: one of them is missing.");
  EXPECT_THAT(error_of(studio_.get("evidence?search=1")), HasSubstr("step is missing"));
}

TEST_F(StudioRequests, OfAnyDepthAndOfStrangeLettersAreRefused) {
  const std::string deep(16'000, '[');
  EXPECT_EQ(studio_.post_text("steps", deep, "application/json").first, 400);
  std::string closed = "{\"effect\":";
  closed += std::string(8'000, '[') + std::string(8'000, ']') + ",\"joint\":1}";
  EXPECT_EQ(studio_.post_text("steps", closed, "application/json").first, 400);
  EXPECT_EQ(studio_.post_text("steps", "{\"\xff\":1}", "application/json").first, 400);
  EXPECT_EQ(studio_.get("map?joint=1&recording=1&x=%FF%FE&y=load").first, 400);
  EXPECT_EQ(
      studio_.post_text("load/files?name=a.csv", "x", "multipart/form-data; boundary=b").first,
      400);
}

TEST_F(StudioRequests, AreTakenWhereTheyLeaveOutWhatHasADefault) {
  EXPECT_EQ(studio_.post("steps", {{"effect", "viscous_friction"}, {"joint", 2}}).first, 200);
  EXPECT_EQ(studio_.post_text("save", "{}", "application/json; charset=utf-8").first, 200);
  EXPECT_EQ(studio_.post("save").first, 409) << "and replaces nothing";
  EXPECT_EQ(studio_.post_text("explanation", "", "").first, 200) << "without a body";
}

TEST(StudioContract, GivesNumbersAndDefaults) {
  const ApiContract contract(assets::api());
  const ApiRequest arm =
      contract.asked("GET /arm", {{{"recording", "2"}, {"from", "1"}, {"to", "2.5"}}, "", ""});
  EXPECT_EQ(arm.parameters,
            (json{{"recording", 2}, {"from", 1.0}, {"to", 2.5}, {"instants", kMostInstants}}));
  EXPECT_TRUE(arm.body.is_null());
  const ApiRequest save = contract.asked("POST /save", {{}, "application/json", "{}"});
  EXPECT_EQ(save.body, (json{{"name", ""}, {"replace", false}, {"accept_doubts", false}}));
  EXPECT_THROW(static_cast<void>(contract.asked("GET /no_such", {})), std::out_of_range);
}

// Of these there are two: the program's and the document's.
TEST(StudioContract, HasTheProgramsOwnLimits) {
  const json& paths = api_document().json()["paths"];
  const auto schema_of = [&](const char* path, const std::string& name) {
    for (const json& one : paths[path]["get"]["parameters"]) {
      if (one["name"] == name) return one["schema"];
    }
    return json();
  };
  EXPECT_EQ(schema_of("/charts", "pixels").at("maximum"), kMostPixels);
  EXPECT_EQ(schema_of("/arm", "instants").at("maximum"), kMostInstants);
  for (const char* side : {"x", "y"}) {
    const json names = schema_of("/map", side).at("enum");
    for (const json& name : names) {
      EXPECT_TRUE(error_variable(name.get<std::string>())) << name;
    }
  }
}

// valijson reads over a word that it does not know: what it does not check would seem checked.
void expect_known_words(const json& schema, const std::string& place) {
  static const std::set<std::string> known{
      "type",  "enum",  "const",       "properties", "required", "additionalProperties",
      "items", "oneOf", "minItems",    "maxItems",   "minimum",  "maximum",
      "anyOf", "$ref",  "description", "default"};
  for (const auto& word : schema.items()) {
    EXPECT_TRUE(known.contains(word.key())) << place << ": " << word.key();
    const bool is_list = word.key() == "oneOf" || word.key() == "anyOf";
    const bool is_schema = word.key() == "items" || word.key() == "additionalProperties";
    if (is_schema && word.value().is_object()) expect_known_words(word.value(), place);
    if (!is_list && word.key() != "properties") continue;
    for (const auto& one : word.value().items()) {
      expect_known_words(one.value(), place + "/" + one.key());
    }
  }
  EXPECT_TRUE(!schema.contains("$ref") || schema.size() == 1) << place;
  if (!schema.contains("properties")) return;
  EXPECT_EQ(schema.at("additionalProperties"), false) << place;
  for (const json& name : schema.at("required")) {
    EXPECT_TRUE(schema["properties"].contains(name.get<std::string>())) << place << ": " << name;
  }
}

TEST(StudioSchema, HasOnlyWordsThatValidatorsOfBothDraftsUnderstand) {
  for (const auto& schema : api_document().json()["components"]["schemas"].items()) {
    expect_known_words(schema.value(), schema.key());
  }
  for (const auto& path : api_document().json()["paths"].items()) {
    for (const auto& method : path.value().items()) {
      for (const json& one : method.value().value("parameters", json::array())) {
        expect_known_words(one["schema"], path.key() + " " + one["name"].get<std::string>());
      }
    }
  }
}

TEST(StudioSchema, FindsAFieldThatIsMissingMisspeltOrOfAnotherType) {
  const JsonSchema schema(api_document().json(), "/components/schemas/Step");
  const json errors{{"fitted_percent", 1.5}, {"held_out_percent", nullptr}};
  const json good{
      {"id", 1},
      {"effect", "a"},
      {"words", ""},
      {"joint", 1},
      {"parameters",
       {{"level", {{"value", 1}, {"unit", "N m"}, {"ci95", {0.5, 1.5}}, {"fitted", true}}}}},
      {"draggable", json::object()},
      {"refitted", json::array()},
      {"before", errors},
      {"after", errors},
      {"verdict", ""},
      {"notes", json::array()},
      {"doubts", {"one"}}};
  EXPECT_FALSE(schema.mismatch(good));
  const auto place_after = [&](const std::string& change) {
    const auto mismatch = schema.mismatch(good.patch(json::parse(change)));
    return mismatch ? mismatch->place : "none";
  };
  EXPECT_EQ(place_after(R"([{"op": "remove", "path": "/verdict"}])"), "");
  EXPECT_EQ(place_after(R"([{"op": "move", "from": "/verdict", "path": "/verdicts"}])"), "");
  EXPECT_EQ(place_after(R"([{"op": "replace", "path": "/id", "value": 0}])"), "/id");
  EXPECT_EQ(place_after(R"([{"op": "replace", "path": "/id", "value": 1.5}])"), "/id");
  EXPECT_EQ(place_after(R"([{"op": "replace", "path": "/doubts/0", "value": 1}])"), "/doubts/0");
  EXPECT_EQ(place_after(R"([{"op": "replace", "path": "/before/fitted_percent", "value": "1"}])"),
            "/before/fitted_percent");
  EXPECT_EQ(place_after(R"([{"op": "add", "path": "/before/colour", "value": 1}])"), "/before");
  EXPECT_EQ(place_after(R"([{"op": "add", "path": "/parameters/level/ci95/-", "value": 1}])"),
            "/parameters/level/ci95");
  EXPECT_THROW(JsonSchema(api_document().json(), "/components/schemas/NoSuch"), std::exception);
}

}  // namespace
