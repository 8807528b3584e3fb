#include "common/encoding.hpp"

#include <iconv.h>

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <utility>

namespace offnominal::desk {

TextInUtf8 text_in_utf8(std::string_view text, const std::string& encoding) {
  TextInUtf8 result;
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

std::size_t utf8_bytes(std::string_view text) {
  const bool is_ascii = std::none_of(text.begin(), text.end(),
                                     [](char c) { return static_cast<unsigned char>(c) >= 0x80; });
  return is_ascii ? text.size() : text_in_utf8(text, "UTF-8").read;
}

std::string from_windows_1252(std::string_view text) {
  TextInUtf8 windows = text_in_utf8(text, "WINDOWS-1252");
  if (windows.read == text.size()) return std::move(windows.text);
  return text_in_utf8(text, "ISO-8859-1").text;
}

}  // namespace offnominal::desk
