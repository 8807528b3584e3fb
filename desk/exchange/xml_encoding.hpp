#pragma once

#include <string>
#include <string_view>

namespace offnominal::desk::exchange {

/// The text of an XML file in UTF-8.
struct XmlText {
  std::string text;
  // The first line with bytes that are no UTF-8 and, since the file declares nothing else, were
  // taken for Windows-1252, of which Latin-1 is a part; 0: there are none.
  int assumed_line = 0;
};

/// From what the file declares: <?xml version="1.0" encoding="ISO-8859-1"?>. What is UTF-8 stays,
/// whatever is declared. Throws InputError, with line and byte, where the declared encoding is not
/// known or has no such byte; without a declaration, text that is not Windows-1252 either stays.
[[nodiscard]] XmlText xml_in_utf8(std::string_view text, const std::string& file);

}  // namespace offnominal::desk::exchange
