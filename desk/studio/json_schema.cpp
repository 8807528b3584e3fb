#include "studio/json_schema.hpp"

#include <nlohmann/json.hpp>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validation_results.hpp>
#include <valijson/validator.hpp>
#include <vector>

namespace offnominal::desk::studio {
namespace {

using valijson::adapters::NlohmannJsonAdapter;

// valijson says "<root>", "[joints]", "[0]".
std::string pointer_of(const std::vector<std::string>& context) {
  std::string pointer;
  for (std::size_t i = 1; i < context.size(); ++i) {
    const std::string& part = context[i];
    const bool is_bracketed = part.size() > 2 && part.front() == '[' && part.back() == ']';
    pointer += "/" + (is_bracketed ? part.substr(1, part.size() - 2) : part);
  }
  return pointer;
}

}  // namespace

struct JsonSchema::Parsed {
  valijson::Schema schema;
};

JsonSchema::JsonSchema(const nlohmann::json& document, const std::string& pointer)
    : parsed_(std::make_unique<Parsed>()) {
  // By a name the document is read where it lies; without one this would have to hold a copy of it.
  const nlohmann::json whole{{"$ref", "urn:offnominal:document#" + pointer}};
  valijson::SchemaParser parser;
  parser.populateSchema<NlohmannJsonAdapter>(
      NlohmannJsonAdapter(whole), parsed_->schema,
      [&document](const std::string&) { return &document; }, [](const nlohmann::json*) {});
}

JsonSchema::JsonSchema(JsonSchema&&) noexcept = default;
JsonSchema& JsonSchema::operator=(JsonSchema&&) noexcept = default;
JsonSchema::~JsonSchema() = default;

std::optional<JsonSchema::Mismatch> JsonSchema::mismatch(const nlohmann::json& value) const {
  // Without a place for words it ends at the first mismatch. A validator is of one thread.
  const NlohmannJsonAdapter target(value);
  if (valijson::Validator().validate(parsed_->schema, target, nullptr)) return std::nullopt;
  valijson::ValidationResults results;
  valijson::Validator().validate(parsed_->schema, target, &results);
  valijson::ValidationResults::Error error;
  if (!results.popError(error)) return Mismatch{"", "it is not as the schema wants it"};
  return Mismatch{pointer_of(error.context), error.description};
}

}  // namespace offnominal::desk::studio
