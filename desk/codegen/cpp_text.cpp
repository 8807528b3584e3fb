#include "codegen/cpp_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <limits>

#include "common/nearest.hpp"
#include "common/number.hpp"

namespace offnominal::desk::cpp_text {
namespace {

constexpr std::size_t kLineLength = 100;

bool is_word(char c) {
  const auto byte = static_cast<unsigned char>(c);
  return byte < 0x80 && (std::isalnum(byte) != 0 || c == '_');
}

constexpr std::array kReserved{"alignas",       "alignof",     "and",
                               "and_eq",        "asm",         "auto",
                               "bitand",        "bitor",       "bool",
                               "break",         "case",        "catch",
                               "char",          "char16_t",    "char32_t",
                               "char8_t",       "class",       "co_await",
                               "co_return",     "co_yield",    "compl",
                               "concept",       "const",       "const_cast",
                               "consteval",     "constexpr",   "constinit",
                               "continue",      "decltype",    "default",
                               "delete",        "do",          "double",
                               "dynamic_cast",  "else",        "enum",
                               "explicit",      "export",      "extern",
                               "false",         "float",       "for",
                               "friend",        "goto",        "if",
                               "inline",        "int",         "long",
                               "mutable",       "namespace",   "new",
                               "noexcept",      "not",         "not_eq",
                               "nullptr",       "operator",    "or",
                               "or_eq",         "private",     "protected",
                               "public",        "register",    "reinterpret_cast",
                               "requires",      "return",      "short",
                               "signed",        "sizeof",      "static",
                               "static_assert", "static_cast", "struct",
                               "switch",        "template",    "this",
                               "thread_local",  "throw",       "true",
                               "try",           "typedef",     "typeid",
                               "typename",      "union",       "unsigned",
                               "using",         "virtual",     "void",
                               "volatile",      "wchar_t",     "while",
                               "xor",           "xor_eq"};

// Macros of the headers that the generated one includes.
constexpr std::array kMacros{"EOF", "INFINITY", "NAN", "NULL", "assert", "errno", "offsetof"};

bool is_identifier(std::string_view name) {
  if (name.empty() || std::isdigit(static_cast<unsigned char>(name[0])) != 0) return false;
  if (!std::all_of(name.begin(), name.end(), is_word)) return false;
  // Reserved to the compiler and its library.
  if (name[0] == '_' || name.find("__") != std::string_view::npos) return false;
  const auto is_name = [name](const char* other) { return name == other; };
  return std::none_of(kReserved.begin(), kReserved.end(), is_name) &&
         std::none_of(kMacros.begin(), kMacros.end(), is_name);
}

// How many bytes from `at` are one character of Unicode that turns the direction of writing; 0
// where there is none.
std::size_t direction_mark(std::string_view text, std::size_t at) {
  constexpr std::array<std::string_view, 12> kMarks{"\xD8\x9C",     "\xE2\x80\x8E", "\xE2\x80\x8F",
                                                    "\xE2\x80\xAA", "\xE2\x80\xAB", "\xE2\x80\xAC",
                                                    "\xE2\x80\xAD", "\xE2\x80\xAE", "\xE2\x81\xA6",
                                                    "\xE2\x81\xA7", "\xE2\x81\xA8", "\xE2\x81\xA9"};
  for (const std::string_view mark : kMarks) {
    if (text.substr(at).starts_with(mark)) return mark.size();
  }
  return 0;
}

std::string printable(std::string_view text) {
  std::string result;
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t mark = direction_mark(text, i);
    const auto byte = static_cast<unsigned char>(text[i]);
    const bool control = byte < 0x20 || byte == 0x7f;
    result += mark > 0 || control ? ' ' : text[i];
    i += std::max<std::size_t>(mark, 1);
  }
  return result;
}

}  // namespace

std::string number(double value) {
  constexpr double kLargest = std::numeric_limits<double>::max();
  constexpr auto kLargestFloat = static_cast<double>(std::numeric_limits<float>::max());
  const char* sign = value < 0 ? "-" : "";
  if (std::fabs(value) >= kLargest)
    return fmt::format("{}std::numeric_limits<Scalar>::max()", sign);
  if (std::fabs(value) <= kLargestFloat) return fmt::format("Scalar({})", shortest_real(value));
  return fmt::format(
      "{}Scalar(std::min({}, static_cast<double>(std::numeric_limits<Scalar>::max())))", sign,
      shortest_real(std::fabs(value)));
}

std::string numbers(std::span<const double> values) { return "{" + list_of(values, number) + "}"; }

std::string literal(std::string_view text) {
  std::string result = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      result += '\\';
      result += c;
    } else if (byte < 0x20 || byte >= 0x7f || c == '?') {
      // A question mark may begin a trigraph.
      result += c == '?' ? std::string("\\?") : fmt::format("\\{:03o}", byte);
    } else {
      result += c;
    }
  }
  return result + '"';
}

std::string comment(std::string_view text, std::string_view indent) {
  const std::string clean = printable(text);
  const std::string begin = std::string(indent) + "//";
  std::string result;
  std::string line;
  const auto end_line = [&] {
    if (line.empty()) return;
    // A backslash would draw the next line into the comment.
    if (line.back() == '\\') line += '.';
    result += begin + line + "\n";
    line.clear();
  };
  for (std::size_t at = 0; at < clean.size();) {
    const std::size_t word = clean.find_first_not_of(' ', at);
    if (word == std::string::npos) break;
    const std::size_t end = std::min(clean.find(' ', word), clean.size());
    if (begin.size() + line.size() + 1 + (end - word) > kLineLength) end_line();
    line += ' ' + clean.substr(word, end - word);
    at = end;
  }
  end_line();
  return result;
}

bool is_namespace(std::string_view name) {
  // Nobody may add to these.
  const std::string_view outermost = name.substr(0, name.find("::"));
  if (outermost == "std" || outermost == "posix") return false;
  for (;;) {
    const std::size_t end = name.find("::");
    if (!is_identifier(name.substr(0, end))) return false;
    if (end == std::string_view::npos) return true;
    name.remove_prefix(end + 2);
  }
}

std::string member(std::string_view name, std::string_view value, std::string_view remark) {
  std::string text = fmt::format(".{} = {},", name, value);
  if (!remark.empty()) text += fmt::format("  // {}", remark);
  return text + "\n";
}

std::string indented(std::string_view text, std::string_view indent) {
  std::string result;
  while (!text.empty()) {
    const std::size_t end = text.find('\n') + 1;
    result += indent;
    result += text.substr(0, end);
    text.remove_prefix(end);
  }
  return result;
}

}  // namespace offnominal::desk::cpp_text
