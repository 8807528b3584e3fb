#include "exchange/xml_encoding.hpp"

#include <fmt/format.h>
#include <iconv.h>

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <optional>
#include <utility>

#include "common/error.hpp"

namespace offnominal::desk::exchange {
namespace {

// Text in UTF-8 as far as the encoding goes, and where it ends.
struct Converted {
  std::string text;
  std::size_t read = 0;   // bytes
  bool is_known = false;  // the encoding
};

Converted converted(std::string_view text, const std::string& encoding) {
  Converted result;
  // Behind a slash iconv takes more than a name.
  const bool is_name = std::all_of(encoding.begin(), encoding.end(), [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '-' || c == '_' || c == '.' || c == ':';
  });
  if (!is_name) return result;
  const iconv_t converter = iconv_open("UTF-8", encoding.c_str());
  if (reinterpret_cast<std::intptr_t>(converter) == -1) return result;
  result.is_known = true;
  constexpr std::size_t kMostBytesOfOne = 8;
  result.text.resize(kMostBytesOfOne * text.size());
  std::string source(text);
  char* from = source.data();
  std::size_t left = source.size();
  char* to = result.text.data();
  std::size_t room = result.text.size();
  static_cast<void>(iconv(converter, &from, &left, &to, &room));
  iconv_close(converter);
  result.text.resize(result.text.size() - room);
  result.read = text.size() - left;
  return result;
}

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
  const std::size_t good = converted(text, "UTF-8").read;
  if (good == text.size()) return {std::string(text)};
  const std::string encoding = declared_encoding(text);
  if (encoding.empty() || is_utf8(encoding)) {
    Converted latin = converted(text, "WINDOWS-1252");
    if (latin.read != text.size()) return {std::string(text)};
    return {std::move(latin.text), line_of(text, good)};
  }
  Converted declared = converted(text, encoding);
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
