#include "studio/api_contract.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <utility>

#include "common/refused.hpp"
#include "studio/json_schema.hpp"
#include "studio/mismatch_words.hpp"

namespace offnominal::desk::studio {

namespace {

[[noreturn]] void refuse(const std::string& words) {
  throw Refused(Refused::Why::kBadRequest, words);
}

template <typename Number>
std::optional<Number> number_in(const std::string& text) {
  Number value{};
  const char* end = text.data() + text.size();
  const auto read = std::from_chars(text.data(), end, value);
  if (text.empty() || read.ec != std::errc{} || read.ptr != end) return std::nullopt;
  return value;
}

// What is no number of the type stays text, and so is none for the schema either.
nlohmann::json value_in(const std::string& text, const nlohmann::json& type) {
  if (type == "integer") {
    if (const auto value = number_in<std::int64_t>(text)) return *value;
  }
  if (type == "number") {
    const auto value = number_in<double>(text);
    if (value && std::isfinite(*value)) return *value;
  }
  return text;
}

std::string upper_case(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 32) : c; });
  return text;
}

// All parameters of an operation together, as the schema of an object.
nlohmann::json object_of(const nlohmann::json& parameters) {
  nlohmann::json schema{{"type", "object"},
                        {"properties", nlohmann::json::object()},
                        {"required", nlohmann::json::array()},
                        {"additionalProperties", false}};
  for (const nlohmann::json& one : parameters) {
    schema["properties"][one.at("name").get<std::string>()] = one.at("schema");
    if (one.at("required").get<bool>()) schema["required"].push_back(one.at("name"));
  }
  return schema;
}

}  // namespace

// A schema of an object, in the document that it points into.
struct RequestSchema {
  RequestSchema(const nlohmann::json& document, const std::string& place)
      : schema(&document.at(nlohmann::json::json_pointer(place))), check(document, place) {}

  // Refuses what is not as it should be; else fills in what has a default.
  void take(nlohmann::json& value, const std::string& whole, const nlohmann::json& document) const {
    if (const auto mismatch = check.mismatch(value)) {
      refuse(words_of(*mismatch, whole, value, *schema, document));
    }
    for (const auto& field : schema->at("properties").items()) {
      const auto by_default = field.value().find("default");
      if (by_default != field.value().end() && !value.contains(field.key())) {
        value[field.key()] = *by_default;
      }
    }
  }

  const nlohmann::json* schema;
  JsonSchema check;
};

struct ApiContract::Route {
  Route(const nlohmann::json& document, const nlohmann::json& operation)
      : parameters(document,
                   "/components/objects/" + operation.at("operationId").get<std::string>()),
        has_answer(operation.at("responses").contains("200")) {
    if (!operation.contains("requestBody")) return;
    const nlohmann::json& sent = operation["requestBody"];
    const auto content = sent.at("content").items().begin();
    content_type = content.key();
    needs_body = sent.at("required").get<bool>();
    if (!content.value().contains("schema")) return;
    body.emplace(document, content.value()["schema"].at("$ref").get<std::string>().substr(1));
  }

  RequestSchema parameters;
  bool has_answer;
  std::string content_type;  // of the body; empty: there is none
  bool needs_body = false;
  std::optional<RequestSchema> body;  // none: any bytes
};

ApiContract::ApiContract(std::string_view document) : document_(nlohmann::json::parse(document)) {
  // From then on nothing of the document moves: routes point into it.
  nlohmann::json& objects = document_.at("components")["objects"];
  for (const auto& path : std::as_const(document_).at("paths").items()) {
    for (const auto& method : path.value().items()) {
      const nlohmann::json& operation = method.value();
      objects[operation.at("operationId").get<std::string>()] =
          object_of(operation.value("parameters", nlohmann::json::array()));
    }
  }
  for (const auto& path : std::as_const(document_).at("paths").items()) {
    for (const auto& method : path.value().items()) {
      routes_.emplace(upper_case(method.key()) + " " + path.key(),
                      std::make_unique<const Route>(document_, method.value()));
    }
  }
}

ApiContract::~ApiContract() = default;

std::vector<std::string> ApiContract::routes() const {
  std::vector<std::string> all;
  for (const auto& [name, route] : routes_) all.push_back(name);
  return all;
}

const ApiContract::Route& ApiContract::route_of(const std::string& route) const {
  const auto found = routes_.find(route);
  if (found != routes_.end()) return *found->second;
  throw std::out_of_range(route + " is not in the document of the API");
}

bool ApiContract::has_answer(const std::string& route) const { return route_of(route).has_answer; }

nlohmann::json ApiContract::parameters_of(const Route& route, const Sent& sent) const {
  const nlohmann::json& known = route.parameters.schema->at("properties");
  nlohmann::json parameters = nlohmann::json::object();
  for (const auto& [name, text] : sent.parameters) {
    if (parameters.contains(name)) refuse(name + " is there twice; allowed: once.");
    const auto schema = known.find(name);
    parameters[name] = schema == known.end() ? nlohmann::json(text)
                                             : value_in(text, resolved(document_, *schema)["type"]);
  }
  route.parameters.take(parameters, "The query", document_);
  return parameters;
}

nlohmann::json ApiContract::body_of(const Route& route, const Sent& sent) const {
  if (route.content_type.empty()) return nullptr;
  const bool is_left_out = route.body && !route.needs_body && sent.body.empty();
  if (!is_left_out && !sent.content_type.starts_with(route.content_type)) {
    refuse("The body has to be " + route.content_type + ".");
  }
  if (!route.body) return nullptr;
  nlohmann::json body =
      is_left_out ? nlohmann::json::object() : nlohmann::json::parse(sent.body, nullptr, false);
  if (body.is_discarded()) refuse("The body is no JSON.");
  route.body->take(body, "The body", document_);
  return body;
}

ApiRequest ApiContract::asked(const std::string& route, const Sent& sent) const {
  const Route& own = route_of(route);
  return {parameters_of(own, sent), body_of(own, sent)};
}

}  // namespace offnominal::desk::studio
