#include "studio/results_view.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "common/refused.hpp"

namespace offnominal::desk::studio {

using nlohmann::ordered_json;

ordered_json filter_json(const std::string& key, const std::string& label, bool of_list_alone,
                         const std::vector<FilterOption>& options) {
  ordered_json all = ordered_json::array();
  for (const FilterOption& one : options) {
    all.push_back({{"value", one.value}, {"words", one.words}});
  }
  return {{"key", key},
          {"label", label},
          {"of", of_list_alone ? "list" : "all"},
          {"options", std::move(all)}};
}

ordered_json cell_json(const std::string& words, const std::string& level) {
  return {{"words", words}, {"level", level}};
}

namespace {

// As much of a value as an answer repeats.
std::string shortened(const std::string& value) {
  constexpr std::size_t kMost = 40;
  return value.size() <= kMost ? value : value.substr(0, kMost) + "...";
}

}  // namespace

void refuse_filter(const std::string& words) { throw Refused(Refused::Why::kBadRequest, words); }

void check_filters(const ResultsFilter& filter, const ordered_json& known) {
  for (const auto& asked : filter) {
    const std::string& key = asked.first;
    const std::string& value = asked.second;
    const auto found = std::find_if(known.begin(), known.end(),
                                    [&](const ordered_json& one) { return one.at("key") == key; });
    if (found == known.end()) refuse_filter("There is no such filter.");
    std::vector<std::string> allowed;
    for (const ordered_json& option : found->at("options")) allowed.push_back(option.at("value"));
    if (std::find(allowed.begin(), allowed.end(), value) != allowed.end()) continue;
    std::erase(allowed, "");  // all of them, which is to leave it out
    refuse_filter(fmt::format(
        "{} is \"{}\"; allowed: {}.", key, shortened(value),
        allowed.empty() ? "to leave it out" : fmt::format("{}", fmt::join(allowed, ", "))));
  }
}

std::string value_of(const ResultsFilter& filter, const std::string& key) {
  const auto found = filter.find(key);
  return found == filter.end() ? std::string() : found->second;
}

nlohmann::json ResultsView::watched(std::int64_t /*run*/, const std::string& /*detector*/) {
  refuse_filter("No monitor watched these.");
}

}  // namespace offnominal::desk::studio
