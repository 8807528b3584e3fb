#include "studio/results_view.hpp"

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

std::string spaced(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

void refuse_filter(const std::string& words) { throw Refused(Refused::Why::kBadRequest, words); }

void check_filters(const ResultsFilter& filter, const std::vector<std::string>& known) {
  for (const auto& [key, value] : filter) {
    if (std::find(known.begin(), known.end(), key) == known.end()) {
      refuse_filter("There is no such filter.");
    }
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
