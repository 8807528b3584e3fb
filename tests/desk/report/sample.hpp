#pragma once

#include <limits>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "report/page.hpp"

namespace offnominal::desk::report::test {

inline constexpr double kGap = std::numeric_limits<double>::quiet_NaN();

inline Chart chart_of(Series series) {
  Chart chart;
  chart.title = "Residual";
  chart.x = {.name = "Time", .unit = "s"};
  chart.y = {{.name = "Residual", .unit = "rad/s"}};
  chart.series = {std::move(series)};
  return chart;
}

inline Page page_of(Block block) {
  Page page;
  page.title = "Title";
  page.verdict = {"All is well.", Level::kGood};
  page.sections = {{"Section", "", {std::move(block)}}};
  return page;
}

inline nlohmann::json block_json(const Block& block) {
  return to_json(page_of(block)).at("sections").at(0).at("blocks").at(0);
}

}  // namespace offnominal::desk::report::test
