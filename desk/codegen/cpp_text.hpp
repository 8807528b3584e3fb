#pragma once

#include <span>
#include <string>
#include <string_view>

// Numbers, strings and remarks as the text of a C++ header that compiles without a warning,
// whatever they hold.

namespace offnominal::desk::cpp_text {

/// An expression of type Scalar, a template parameter there, that is `value` rounded to it; beyond
/// what Scalar holds, its largest number. Finite values only.
[[nodiscard]] std::string number(double value);

/// The same for a list: "{Scalar(1.0), Scalar(2.0)}".
[[nodiscard]] std::string numbers(std::span<const double> values);

/// A string literal; what is not printable ASCII stands as octal escapes.
[[nodiscard]] std::string literal(std::string_view text);

/// `text` as lines of a comment, broken at spaces, each behind `indent` and "// ". Control
/// characters, those that turn the direction of writing among them, become spaces. Empty for empty
/// text.
[[nodiscard]] std::string comment(std::string_view text, std::string_view indent = {});

/// One member of a designated initialiser, a line, with what it means.
[[nodiscard]] std::string member(std::string_view name, std::string_view value,
                                 std::string_view remark = {});

/// Every line of `text` behind `indent`; the last one ends as all do.
[[nodiscard]] std::string indented(std::string_view text, std::string_view indent);

/// True for names that a program may give to a namespace, nested ones with `::` between them.
[[nodiscard]] bool is_namespace(std::string_view name);

}  // namespace offnominal::desk::cpp_text
