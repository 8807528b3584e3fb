#pragma once

#include <toml++/toml.h>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace offnominal::desk {

/// Which numbers a key takes. They are always finite.
struct NumberRule {
  double min = -std::numeric_limits<double>::infinity();
  bool min_allowed = true;
  double max = std::numeric_limits<double>::infinity();
  std::string unit = {};  // "kg"; empty: none
  std::string mend = {};  // advice for this key; empty: a general one
  // Told only where a number is larger, whatever its sign.
  double largest = std::numeric_limits<double>::infinity();
};

[[nodiscard]] NumberRule any_number(std::string unit);
[[nodiscard]] NumberRule positive(std::string unit, std::string mend = {});
[[nodiscard]] NumberRule not_negative(std::string unit, std::string mend = {});
/// The same rule for what a robot is made of: above what there is in that unit, in m and m/s^2 also
/// below its millimetres, and far below what makes torques of it that no number holds, it ends.
[[nodiscard]] NumberRule physical(NumberRule rule);

/// The document of a file's text. Throws InputError, with the line, where it is not TOML.
[[nodiscard]] toml::table parse_toml(std::string_view text, const std::string& file);

/// One table of a TOML file, read strictly: every refusal is an InputError with the file, the line,
/// the key's path, what was found, what is allowed and how to mend it. Keys that are not among
/// `keys` are refused at once.
class TomlTable {
 public:
  TomlTable(std::string file, std::string path, const toml::table& table,
            std::vector<std::string> keys);

  [[nodiscard]] bool has(const std::string& key) const { return table_.contains(key); }
  [[nodiscard]] std::string path_of(const std::string& key) const;
  [[nodiscard]] const std::string& file() const { return file_; }

  [[nodiscard]] double number(const std::string& key, const NumberRule& rule) const;
  [[nodiscard]] double number(const std::string& key, const NumberRule& rule,
                              double if_absent) const;
  [[nodiscard]] std::int64_t integer(const std::string& key, std::int64_t min,
                                     std::int64_t max) const;
  [[nodiscard]] std::int64_t integer(const std::string& key, std::int64_t min, std::int64_t max,
                                     std::int64_t if_absent) const;
  [[nodiscard]] bool boolean(const std::string& key, bool if_absent) const;
  /// A string that is not empty.
  [[nodiscard]] std::string text(const std::string& key) const;
  [[nodiscard]] std::string text_or_empty(const std::string& key) const;
  /// The index of the key's string in `words`.
  [[nodiscard]] std::size_t choice(const std::string& key,
                                   const std::vector<std::string>& words) const;
  /// Numbers of a list with min_count to max_count entries.
  [[nodiscard]] std::vector<double> numbers(const std::string& key, const NumberRule& rule,
                                            std::size_t min_count, std::size_t max_count) const;
  /// A list of min_rows to max_rows lists of `columns` numbers.
  [[nodiscard]] std::vector<std::vector<double>> rows(const std::string& key,
                                                      const NumberRule& rule, std::size_t min_rows,
                                                      std::size_t max_rows,
                                                      std::size_t columns) const;

  [[nodiscard]] TomlTable table(const std::string& key, std::vector<std::string> keys) const;
  [[nodiscard]] std::optional<TomlTable> optional_table(const std::string& key,
                                                        std::vector<std::string> keys) const;
  /// The tables of [[key]], with paths key[1], key[2], ...; none where it is absent.
  [[nodiscard]] std::vector<TomlTable> tables(const std::string& key,
                                              const std::vector<std::string>& keys) const;
  /// The table as toml++ has it, for a reader that does its own checks; null where it is absent.
  [[nodiscard]] const toml::table* raw_table(const std::string& key) const;

  /// Refuses the value of `key`, or the whole table where the key is absent or empty.
  [[noreturn]] void refuse(const std::string& key, const std::string& found,
                           const std::string& allowed, const std::string& mend) const;

 private:
  [[nodiscard]] const toml::node& require(const std::string& key, const std::string& allowed) const;
  [[nodiscard]] double checked(const toml::node& node, const std::string& path,
                               const NumberRule& rule) const;
  [[nodiscard]] std::vector<double> checked_list(const toml::node& node, const std::string& path,
                                                 const NumberRule& rule, std::size_t min_count,
                                                 std::size_t max_count) const;
  [[nodiscard]] const toml::table& as_table(const std::string& key, const toml::node& node) const;
  [[noreturn]] void refuse_at(const toml::node& node, const std::string& path,
                              const std::string& found, const std::string& allowed,
                              const std::string& mend) const;
  void refuse_unknown_keys() const;

  std::string file_;
  std::string path_;
  const toml::table& table_;
  std::vector<std::string> keys_;
};

}  // namespace offnominal::desk
