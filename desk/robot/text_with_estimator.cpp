#include "robot/text_with_estimator.hpp"

#include <toml++/toml.h>

#include <algorithm>
#include <cstddef>
#include <map>

#include "robot/text_lines.hpp"

namespace offnominal::desk {
namespace {

std::string text_of(const EstimatorLine& line) {
  return line.key + " = " + line.value + (line.reason.empty() ? "" : "  # " + line.reason) + "\n";
}

// The line of the header, from 0; `lines.size()` where the file has no such table, none where it is
// written otherwise.
std::optional<std::size_t> header_of(const toml::table& document, const Lines& lines) {
  const toml::table* table = document["estimator"].as_table();
  if (table == nullptr) return lines.size();
  const std::size_t line = table->source().begin.line;
  if (line < 1 || line > lines.size() || !is_header(lines[line - 1])) return std::nullopt;
  return line - 1;
}

// Of every key that changes, its line, from 0. None where a value does not stand in one line.
std::optional<std::map<std::size_t, const EstimatorLine*>> old_lines(
    const toml::table& document, const std::vector<EstimatorLine>& changed) {
  std::map<std::size_t, const EstimatorLine*> places;
  const toml::table* table = document["estimator"].as_table();
  for (const EstimatorLine& line : changed) {
    const toml::node* value = table == nullptr ? nullptr : table->get(line.key);
    if (value == nullptr) continue;
    const toml::source_region& source = value->source();
    if (source.begin.line < 1 || source.end.line != source.begin.line) return std::nullopt;
    places[source.begin.line - 1] = &line;
  }
  return places;
}

}  // namespace

std::optional<std::string> text_with_estimator(const std::string& old_text,
                                               const std::vector<EstimatorLine>& changed) {
  try {
    const std::string text = without_returns(old_text);
    const toml::table document = toml::parse(text);
    const Lines lines = lines_of(text);
    const auto header = header_of(document, lines);
    const auto places = old_lines(document, changed);
    if (!header || !places) return std::nullopt;
    LineComposer out(lines);
    for (const auto& [place, line] : *places) {
      out.copy_until(place);
      out.replace_line(text_of(*line));
    }
    std::string added;
    for (const EstimatorLine& line : changed) {
      const bool is_there = std::any_of(places->begin(), places->end(),
                                        [&](const auto& old) { return old.second == &line; });
      if (!is_there) added += text_of(line);
    }
    const bool is_new = *header == lines.size();
    out.copy_until(is_new ? *header : end_of_block(lines, *header));
    if (is_new) {
      out.insert("[estimator]\n" + added);
    } else {
      out.append(added);
    }
    out.copy_until(lines.size());
    return has_returns(old_text) ? with_returns(out.text()) : out.text();
  } catch (const toml::parse_error&) {
    return std::nullopt;
  }
}

}  // namespace offnominal::desk
