#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace offnominal::desk {

// What numbers with a decimal mark, and with one that may as well stand before thousands, were seen
// in one file. Only where both marks are seen can nobody tell which of them is which.
class DecimalMarks {
 public:
  // Two numbers that contradict each other, in words.
  struct Contradiction {
    std::string thousands;
    std::string decimals;
  };

  // Whether note() of a cell could change anything. Any number of threads may ask at once.
  [[nodiscard]] bool is_news(std::string_view text) const;
  // `column`: its name.
  std::optional<Contradiction> note(std::string_view text, const std::string& column);

 private:
  struct Mark {
    char mark;
    std::optional<std::string> any = std::nullopt;  // the first with it
    std::optional<std::string> thousands = std::nullopt;
  };

  static std::optional<Contradiction> between(const Mark& first, const Mark& second);

  Mark points_{'.'};
  Mark commas_{','};
};

}  // namespace offnominal::desk
