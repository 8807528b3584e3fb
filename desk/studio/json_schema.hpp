#pragma once

#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

namespace offnominal::desk::studio {

/// A JSON schema, ready to check values. Of the language only what a validator of draft 7 and one
/// of 2020-12 understand alike: type, enum, const, properties, required, additionalProperties,
/// items (one for all), minItems, maxItems, minimum, maximum, anyOf, oneOf, and $ref with nothing
/// beside it. A whole number is one that is written without a point. May be used by several threads
/// at once.
class JsonSchema {
 public:
  /// The schema at the place `pointer` of a document ("/components/schemas/Step"), to whose other
  /// places it may refer ("#/components/schemas/Joint"). Throws std::runtime_error where a place is
  /// not there or no schema.
  JsonSchema(const nlohmann::json& document, const std::string& pointer);
  JsonSchema(const JsonSchema&) = delete;
  JsonSchema& operator=(const JsonSchema&) = delete;
  JsonSchema(JsonSchema&&) noexcept;
  JsonSchema& operator=(JsonSchema&&) noexcept;
  ~JsonSchema();

  /// Where a value is another than the schema wants, and what the validator says of it.
  struct Mismatch {
    std::string place;  // pointer in the value, "/joints/0/name"; empty: the value itself
    std::string words;
  };
  /// The first mismatch; none: the value is as the schema wants it.
  [[nodiscard]] std::optional<Mismatch> mismatch(const nlohmann::json& value) const;

 private:
  struct Parsed;
  std::unique_ptr<Parsed> parsed_;
};

}  // namespace offnominal::desk::studio
