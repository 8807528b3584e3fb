#include "exchange/xml_encoding.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <utility>

#include "common/encoding.hpp"
#include "common/error.hpp"

namespace offnominal::desk::exchange {
namespace {

// What <?xml encoding="..."?> says; empty: nothing.
std::string declared_encoding(std::string_view text) {
  const std::size_t begin = text.find("<?xml");
  if (begin == std::string_view::npos) return {};
  const std::string_view declaration = text.substr(begin, text.find("?>", begin) - begin);
  const std::size_t key = declaration.find("encoding");
  if (key == std::string_view::npos) return {};
  const std::size_t open = declaration.find_first_of("\"'", key);
  if (open == std::string_view::npos) return {};
  const std::size_t close = declaration.find(declaration[open], open + 1);
  if (close == std::string_view::npos) return {};
  return std::string(declaration.substr(open + 1, close - open - 1));
}

bool is_utf8(std::string name) {
  std::transform(name.begin(), name.end(), name.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return name == "UTF-8" || name == "UTF8" || name == "US-ASCII" || name == "ASCII";
}

int line_of(std::string_view text, std::size_t at) {
  return static_cast<int>(
      1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n'));
}

}  // namespace

XmlText xml_in_utf8(std::string_view text, const std::string& file) {
  const std::size_t good = utf8_bytes(text);
  if (good == text.size()) return {std::string(text)};
  const std::string encoding = declared_encoding(text);
  if (encoding.empty() || is_utf8(encoding)) {
    TextInUtf8 latin = text_in_utf8(text, "WINDOWS-1252");
    if (latin.read != text.size()) return {std::string(text)};
    return {std::move(latin.text), line_of(text, good)};
  }
  TextInUtf8 declared = text_in_utf8(text, encoding);
  if (declared.is_known && declared.read == text.size()) return {std::move(declared.text)};
  const std::size_t at = declared.is_known ? declared.read : good;
  throw InputError({.file = file,
                    .place = fmt::format("line {}", line_of(text, at)),
                    .found = fmt::format(
                        "the byte 0x{:02X}, which is no {}", static_cast<unsigned char>(text[at]),
                        declared.is_known ? encoding + ", as the file declares"
                                          : "UTF-8, in a file that declares " + encoding),
                    .allowed = "UTF-8, or an encoding that is known and declared, such as "
                               "<?xml version=\"1.0\" encoding=\"ISO-8859-1\"?>",
                    .mend = "save it in UTF-8, or declare what it is saved in"});
}

}  // namespace offnominal::desk::exchange
