#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace offnominal::desk {

/// Text in UTF-8 as far as the encoding goes.
struct TextInUtf8 {
  std::string text;
  std::size_t read = 0;   // bytes, where it ends
  bool is_known = false;  // the encoding
};

/// `encoding` by any name that iconv has: "UTF-8", "ISO-8859-1", "windows-1252".
[[nodiscard]] TextInUtf8 text_in_utf8(std::string_view text, const std::string& encoding);

/// The bytes up to the first that is no UTF-8; all of them where there is none.
[[nodiscard]] std::size_t utf8_bytes(std::string_view text);

/// As from Windows-1252, of which Latin-1 is a part, or from Latin-1 where a byte has no letter
/// there: any bytes are some text.
[[nodiscard]] std::string from_windows_1252(std::string_view text);

}  // namespace offnominal::desk
