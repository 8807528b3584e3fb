#include "common/toml_table.hpp"

#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>

#include "common/error.hpp"
#include "common/nearest.hpp"
#include "common/number.hpp"

namespace offnominal::desk {
namespace {

std::string words_of(const NumberRule& rule) {
  std::string text = "a finite number";
  if (std::isfinite(rule.min) && std::isfinite(rule.max)) {
    text = "a number from " + shortest(rule.min) + " to " + shortest(rule.max);
  } else if (std::isfinite(rule.min)) {
    text = std::string("a finite number ") + (rule.min_allowed ? ">= " : "> ") + shortest(rule.min);
  } else if (std::isfinite(rule.max)) {
    text = "a finite number <= " + shortest(rule.max);
  }
  return rule.unit.empty() || rule.unit == "1" ? text : text + ", in " + rule.unit;
}

std::string words_of(const toml::node& node) {
  switch (node.type()) {
    case toml::node_type::string:
      return "the string \"" + node.as_string()->get() + "\"";
    case toml::node_type::integer:
      return std::to_string(node.as_integer()->get());
    case toml::node_type::floating_point:
      return shortest(node.as_floating_point()->get());
    case toml::node_type::boolean:
      return node.as_boolean()->get() ? "true" : "false";
    case toml::node_type::array:
      return "a list of " + std::to_string(node.as_array()->size());
    case toml::node_type::table:
      return "a table";
    default:
      return "a date or time";
  }
}

// With or without a point; none of any other value.
std::optional<std::int64_t> whole_number(const toml::node& node) {
  if (const auto* integer = node.as_integer()) return integer->get();
  const auto* real = node.as_floating_point();
  constexpr double kExact = 9007199254740992;  // 2^53
  if (real == nullptr || std::abs(real->get()) > kExact) return std::nullopt;
  const double value = real->get();
  if (value != std::floor(value)) return std::nullopt;
  return static_cast<std::int64_t>(value);
}

std::string mend_of_size(const std::string& unit) {
  if (unit == "m" || unit == "m/s^2") {
    return "write it in " + unit + ": a number in m" + unit + " divided by 1000";
  }
  return "look at its unit";
}

std::string count_words(std::size_t min_count, std::size_t max_count) {
  if (min_count == max_count) return std::to_string(min_count);
  return std::to_string(min_count) + " to " + std::to_string(max_count);
}

std::string element_of(const std::string& path, std::size_t index) {
  return path + "[" + std::to_string(index + 1) + "]";
}

}  // namespace

NumberRule any_number(std::string unit) {
  NumberRule rule;
  rule.unit = std::move(unit);
  return rule;
}

NumberRule positive(std::string unit, std::string mend) {
  NumberRule rule = not_negative(std::move(unit), std::move(mend));
  rule.min_allowed = false;
  return rule;
}

NumberRule not_negative(std::string unit, std::string mend) {
  NumberRule rule = any_number(std::move(unit));
  rule.min = 0;
  rule.mend = std::move(mend);
  return rule;
}

NumberRule physical(NumberRule rule) {
  static const std::map<std::string, double> kLargest{{"kg", 1e7}, {"m", 100}, {"m/s^2", 100}};
  constexpr double kLargestOfOthers = 1e12;
  const auto of_unit = kLargest.find(rule.unit);
  rule.largest = of_unit == kLargest.end() ? kLargestOfOthers : of_unit->second;
  return rule;
}

TomlTable::TomlTable(std::string file, std::string path, const toml::table& table,
                     std::vector<std::string> keys)
    : file_(std::move(file)), path_(std::move(path)), table_(table), keys_(std::move(keys)) {
  refuse_unknown_keys();
}

std::string TomlTable::path_of(const std::string& key) const {
  if (key.empty()) return path_;
  return path_.empty() ? key : path_ + "." + key;
}

double TomlTable::number(const std::string& key, const NumberRule& rule) const {
  return checked(require(key, words_of(rule)), path_of(key), rule);
}

double TomlTable::number(const std::string& key, const NumberRule& rule, double if_absent) const {
  return has(key) ? number(key, rule) : if_absent;
}

std::int64_t TomlTable::integer(const std::string& key, std::int64_t min, std::int64_t max) const {
  const std::string allowed =
      "a whole number from " + std::to_string(min) + " to " + std::to_string(max);
  const toml::node& node = require(key, allowed);
  const std::optional<std::int64_t> value = whole_number(node);
  if (!value || *value < min || *value > max) {
    refuse_at(node, path_of(key), words_of(node), allowed, "write such a number");
  }
  return *value;
}

std::int64_t TomlTable::integer(const std::string& key, std::int64_t min, std::int64_t max,
                                std::int64_t if_absent) const {
  return has(key) ? integer(key, min, max) : if_absent;
}

bool TomlTable::boolean(const std::string& key, bool if_absent) const {
  const toml::node* node = table_.get(key);
  if (node == nullptr) return if_absent;
  if (!node->is_boolean()) {
    refuse_at(*node, path_of(key), words_of(*node), "true or false", "write it without quotes");
  }
  return node->as_boolean()->get();
}

std::string TomlTable::text(const std::string& key) const {
  const std::string allowed = "a string that is not empty";
  const toml::node& node = require(key, allowed);
  if (!node.is_string() || node.as_string()->get().empty()) {
    refuse_at(node, path_of(key), words_of(node), allowed, "write it in quotes");
  }
  return node.as_string()->get();
}

std::string TomlTable::text_or_empty(const std::string& key) const {
  const toml::node* node = table_.get(key);
  if (node == nullptr) return {};
  if (!node->is_string()) {
    refuse_at(*node, path_of(key), words_of(*node), "a string", "write it in quotes");
  }
  return node->as_string()->get();
}

std::size_t TomlTable::choice(const std::string& key, const std::vector<std::string>& words) const {
  const toml::node& node = require(key, list_of(words));
  const std::string found = node.is_string() ? node.as_string()->get() : "";
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (node.is_string() && found == words[i]) return i;
  }
  const std::string meant = nearest(found, words);
  refuse_at(node, path_of(key), words_of(node), list_of(words),
            meant.empty() ? "write one of these in quotes" : "write \"" + meant + "\"");
}

std::vector<double> TomlTable::numbers(const std::string& key, const NumberRule& rule,
                                       std::size_t min_count, std::size_t max_count) const {
  const std::string allowed = "a list of " + count_words(min_count, max_count) + " numbers";
  return checked_list(require(key, allowed), path_of(key), rule, min_count, max_count);
}

std::vector<std::vector<double>> TomlTable::rows(const std::string& key, const NumberRule& rule,
                                                 std::size_t min_rows, std::size_t max_rows,
                                                 std::size_t columns) const {
  const std::string allowed = "a list of " + count_words(min_rows, max_rows) + " rows of " +
                              std::to_string(columns) + " numbers";
  const toml::node& node = require(key, allowed);
  const toml::array* list = node.as_array();
  if (list == nullptr || list->size() < min_rows || list->size() > max_rows) {
    refuse_at(node, path_of(key), words_of(node), allowed, "write [[...], [...]], row by row");
  }
  std::vector<std::vector<double>> result;
  for (std::size_t i = 0; i < list->size(); ++i) {
    result.push_back(
        checked_list(*list->get(i), element_of(path_of(key), i), rule, columns, columns));
  }
  return result;
}

TomlTable TomlTable::table(const std::string& key, std::vector<std::string> keys) const {
  const toml::node& node = require(key, "a table");
  return {file_, path_of(key), as_table(key, node), std::move(keys)};
}

std::optional<TomlTable> TomlTable::optional_table(const std::string& key,
                                                   std::vector<std::string> keys) const {
  if (!has(key)) return std::nullopt;
  return table(key, std::move(keys));
}

std::vector<TomlTable> TomlTable::tables(const std::string& key,
                                         const std::vector<std::string>& keys) const {
  const toml::node* node = table_.get(key);
  if (node == nullptr) return {};
  const toml::array* list = node->as_array();
  const std::string header = "write it as [[" + path_of(key) + "]]";
  if (list == nullptr) refuse_at(*node, path_of(key), words_of(*node), "a list of tables", header);
  std::vector<TomlTable> result;
  for (std::size_t i = 0; i < list->size(); ++i) {
    const std::string path = element_of(path_of(key), i);
    const toml::table* entry = list->get(i)->as_table();
    if (entry == nullptr) {
      refuse_at(*list->get(i), path, words_of(*list->get(i)), "a table", header);
    }
    result.emplace_back(file_, path, *entry, keys);
  }
  return result;
}

const toml::table* TomlTable::raw_table(const std::string& key) const {
  const toml::node* node = table_.get(key);
  return node == nullptr ? nullptr : &as_table(key, *node);
}

void TomlTable::refuse(const std::string& key, const std::string& found, const std::string& allowed,
                       const std::string& mend) const {
  const toml::node* node = key.empty() ? nullptr : table_.get(key);
  refuse_at(node != nullptr ? *node : table_, path_of(key), found, allowed, mend);
}

const toml::node& TomlTable::require(const std::string& key, const std::string& allowed) const {
  const toml::node* node = table_.get(key);
  if (node == nullptr) {
    refuse_at(table_, path_of(key), "nothing: the key is missing", allowed,
              "add `" + key + "`" + (path_.empty() ? "" : " to " + path_));
  }
  return *node;
}

double TomlTable::checked(const toml::node& node, const std::string& path,
                          const NumberRule& rule) const {
  if (!node.is_number()) {
    refuse_at(node, path, words_of(node), words_of(rule),
              node.is_string() ? "write the number without quotes" : "write one number");
  }
  const double value = *node.value<double>();
  const bool above = rule.min_allowed ? value >= rule.min : value > rule.min;
  if (!std::isfinite(value) || !above || value > rule.max) {
    refuse_at(node, path, words_of(node), words_of(rule),
              rule.mend.empty() ? "write a number in this range" : rule.mend);
  }
  if (std::abs(value) > rule.largest) {
    refuse_at(node, path, words_of(node),
              "at most " + shortest(rule.largest) + (rule.unit.empty() ? "" : " " + rule.unit) +
                  ": no robot has more",
              rule.mend.empty() ? mend_of_size(rule.unit) : rule.mend);
  }
  return value;
}

std::vector<double> TomlTable::checked_list(const toml::node& node, const std::string& path,
                                            const NumberRule& rule, std::size_t min_count,
                                            std::size_t max_count) const {
  const toml::array* list = node.as_array();
  if (list == nullptr || list->size() < min_count || list->size() > max_count) {
    refuse_at(node, path, words_of(node),
              "a list of " + count_words(min_count, max_count) + " numbers",
              "write [" + std::string(min_count == 3 ? "x, y, z" : "a, b, ...") + "]");
  }
  std::vector<double> result;
  for (std::size_t i = 0; i < list->size(); ++i) {
    result.push_back(checked(*list->get(i), element_of(path, i), rule));
  }
  return result;
}

const toml::table& TomlTable::as_table(const std::string& key, const toml::node& node) const {
  const toml::table* table = node.as_table();
  if (table == nullptr) {
    refuse_at(node, path_of(key), words_of(node), "a table", "write it as [" + path_of(key) + "]");
  }
  return *table;
}

void TomlTable::refuse_at(const toml::node& node, const std::string& path, const std::string& found,
                          const std::string& allowed, const std::string& mend) const {
  std::string place = path;
  if (const auto line = node.source().begin.line; line > 0) {
    place = "line " + std::to_string(line) + (path.empty() ? "" : ", " + path);
  }
  throw InputError({file_, place, found, allowed, mend});
}

void TomlTable::refuse_unknown_keys() const {
  for (const auto& [key, node] : table_) {
    const std::string found(key.str());
    bool known = false;
    for (const std::string& name : keys_) known = known || name == found;
    if (known) continue;
    const std::string meant = nearest(found, keys_);
    refuse_at(node, path_of(found), "an unknown key", list_of(keys_),
              meant.empty() ? "remove it" : "write `" + meant + "`");
  }
}

toml::table parse_toml(std::string_view text, const std::string& file) {
  try {
    return toml::parse(text, file);
  } catch (const toml::parse_error& error) {
    throw InputError({file, "line " + std::to_string(error.source().begin.line),
                      "text that is not TOML: " + std::string(error.description()),
                      "TOML 1.0, every key once", "correct the line"});
  }
}

}  // namespace offnominal::desk
