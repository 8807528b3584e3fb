#include "common/number.hpp"

#include <charconv>

namespace offnominal::tools {

std::string shortest(double value) {
  char text[32];
  const auto result = std::to_chars(text, text + sizeof text, value);
  return {text, result.ptr};
}

}  // namespace offnominal::tools
