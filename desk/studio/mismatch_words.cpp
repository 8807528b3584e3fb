#include "studio/mismatch_words.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <vector>

namespace offnominal::desk::studio {

namespace {

// "a, b or c".
std::string alternatives(const std::vector<std::string>& all) {
  std::string words;
  for (std::size_t i = 0; i < all.size(); ++i) {
    words += (i == 0 ? "" : i + 1 == all.size() ? " or " : ", ") + all[i];
  }
  return words;
}

std::string type_words(const std::string& type) {
  if (type == "integer") return "a whole number";
  if (type == "number") return "a number";
  if (type == "string") return "text";
  if (type == "boolean") return "true or false";
  if (type == "object") return "an object";
  return type == "array" ? "a list" : type;
}

std::string allowed_by(const nlohmann::json& schema) {
  std::vector<std::string> words;
  if (schema.contains("enum")) {
    for (const nlohmann::json& one : schema["enum"]) words.push_back(one.get<std::string>());
    return alternatives(words);
  }
  const nlohmann::json& type = schema.at("type");
  for (const nlohmann::json& one : type.is_array() ? type : nlohmann::json::array({type})) {
    words.push_back(type_words(one.get<std::string>()));
  }
  if (schema.contains("minimum")) words.front() += " from " + schema["minimum"].dump();
  if (schema.contains("maximum")) words.front() += " to " + schema["maximum"].dump();
  return alternatives(words);
}

// Of a long text its beginning; lists and objects may be of any depth.
std::string found_in(const nlohmann::json& value) {
  if (value.is_object()) return "an object";
  if (value.is_array()) return "a list";
  constexpr std::size_t kMostShown = 40;
  nlohmann::json shown = value;
  if (value.is_string() && value.get_ref<const std::string&>().size() > kMostShown) {
    shown = value.get_ref<const std::string&>().substr(0, kMostShown) + "...";
  }
  return shown.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

// Of "/joint/0" the "joint".
std::string field_of(const std::string& pointer) {
  return pointer.empty() ? "" : pointer.substr(1, pointer.find('/', 1) - 1);
}

}  // namespace

const nlohmann::json& resolved(const nlohmann::json& document, const nlohmann::json& schema) {
  const auto ref = schema.find("$ref");
  if (ref == schema.end()) return schema;
  const std::string place = ref->get<std::string>().substr(1);  // behind the "#"
  return resolved(document, document.at(nlohmann::json::json_pointer(place)));
}

std::string words_of(const JsonSchema::Mismatch& mismatch, const std::string& whole,
                     const nlohmann::json& value, const nlohmann::json& schema,
                     const nlohmann::json& document) {
  const nlohmann::json& fields = schema.at("properties");
  std::vector<std::string> names;
  for (const auto& field : fields.items()) names.push_back(field.key());
  const std::string these = names.empty() ? "no field" : alternatives(names);
  if (!value.is_object()) {
    return fmt::format("{} is {}; allowed: an object with {}.", whole, found_in(value), these);
  }
  for (const auto& field : value.items()) {
    if (fields.contains(field.key())) continue;
    return fmt::format("{} is not known; allowed: {}.", found_in(field.key()), these);
  }
  const auto allowed = [&](const std::string& name) {
    return allowed_by(resolved(document, fields.at(name)));
  };
  for (const nlohmann::json& required : schema.at("required")) {
    const auto name = required.get<std::string>();
    if (!value.contains(name))
      return fmt::format("{} is missing; allowed: {}.", name, allowed(name));
  }
  const std::string name = field_of(mismatch.place);
  if (!value.contains(name)) return fmt::format("{}: {}", whole, mismatch.words);
  return fmt::format("{} is {}; allowed: {}.", name, found_in(value[name]), allowed(name));
}

}  // namespace offnominal::desk::studio
