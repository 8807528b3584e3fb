#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "studio/json_schema.hpp"

namespace offnominal::desk::studio {

/// A schema that is elsewhere in the document, where this one says no more than that.
[[nodiscard]] const nlohmann::json& resolved(const nlohmann::json& document,
                                             const nlohmann::json& schema);

/// What is wrong with `value`, which is not as `schema`, that of an object, wants it: which field,
/// what was found, what is allowed. `whole`: what the value is called.
[[nodiscard]] std::string words_of(const JsonSchema::Mismatch& mismatch, const std::string& whole,
                                   const nlohmann::json& value, const nlohmann::json& schema,
                                   const nlohmann::json& document);

}  // namespace offnominal::desk::studio
