#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "report/page.hpp"
#include "report/validate.hpp"
#include "sample.hpp"

namespace offnominal::desk::report {
namespace {

using nlohmann::json;
using test::block_json;
using test::chart_of;
using test::kGap;
using test::page_of;
using ::testing::AllOf;
using ::testing::HasSubstr;

std::string refusal(const Page& page) {
  try {
    (void)to_json(page);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

TEST(PageJson, HoldsTitleVerdictAndCommandLine) {
  Page page = page_of(Note{"Read this.", Level::kWarn});
  page.command_line = "offnominal paper";
  const json data = to_json(page);
  EXPECT_EQ(data.at("title"), "Title");
  EXPECT_EQ(data.at("verdict"), json({{"words", "All is well."}, {"level", "good"}}));
  EXPECT_EQ(data.at("command_line"), "offnominal paper");
  EXPECT_EQ(data.at("sections")[0].at("blocks")[0],
            json({{"type", "note"}, {"text", "Read this."}, {"level", "warn"}}));
}

TEST(PageJson, GapsAreNullInEveryKindOfBlock) {
  const double infinite = std::numeric_limits<double>::infinity();
  const json chart =
      block_json(chart_of({.name = "e", .x = {0.0, 1.0, 2.0}, .y = {1.0, kGap, -infinite}}));
  EXPECT_EQ(chart.at("series")[0].at("y"), json({1.0, nullptr, nullptr}));

  Table table{.caption = "T", .columns = {{"a"}, {"b"}, {"c"}}, .rows = {{kGap, "x", {}}}};
  EXPECT_EQ(block_json(table).at("rows")[0], json({nullptr, "x", nullptr}));

  Heatmap map;
  map.title = "M";
  map.x = map.y = map.value_axis = {.name = "a", .unit = "1"};
  map.x_edges = {0.0, 1.0, 2.0};
  map.y_edges = {0.0, 1.0};
  map.value = {kGap, 3.0};
  EXPECT_EQ(block_json(map).at("value"), json({nullptr, 3.0}));

  Waterfall waterfall;
  waterfall.title = "W";
  waterfall.value_axis = {.name = "error", .unit = "%"};
  waterfall.steps = {{"first", kGap}};
  EXPECT_TRUE(block_json(waterfall).at("steps")[0].at("value").is_null());
}

TEST(PageJson, SeriesAreRoundedAndTableCellsAreExact) {
  const double third = 1.0 / 3.0;
  const json series =
      block_json(chart_of({.name = "e", .x = {0.0, 123456.7891234}, .y = {third, -0.0}}))
          .at("series")[0];
  EXPECT_EQ(series.at("y")[0].dump(), "0.3333333");
  EXPECT_EQ(series.at("y")[1].dump(), "0.0");
  EXPECT_EQ(series.at("x")[1].dump(), "123456.789");
  const json table = block_json(Table{.caption = "T", .columns = {{"a"}}, .rows = {{third}}});
  EXPECT_EQ(table.at("rows")[0][0].get<double>(), third);
}

TEST(PageJson, ALongSeriesIsReducedAndTheNoteSaysSo) {
  Series series{.name = "e"};
  for (int i = 0; i < 10000; ++i) {
    series.x.push_back(i);
    series.y.push_back(std::sin(0.01 * i));
  }
  Chart chart = chart_of(series);
  chart.note = "A note.";
  chart.max_points = 500;
  const json data = block_json(chart);
  EXPECT_LE(data.at("series")[0].at("x").size(), 500U);
  EXPECT_THAT(data.at("note").get<std::string>(),
              AllOf(HasSubstr("A note. "), HasSubstr("500"), HasSubstr("10000")));
  chart.max_points = 10000;
  EXPECT_EQ(block_json(chart).at("note"), "A note.");
}

TEST(PageJson, RefusesAPageThatContradictsItself) {
  const auto with = [](auto change) {
    Chart chart = chart_of({.name = "e", .x = {0.0, 1.0}, .y = {1.0, 2.0}});
    change(chart);
    return refusal(page_of(chart));
  };
  EXPECT_EQ(with([](Chart&) {}), "accepted");
  EXPECT_THAT(with([](Chart& c) { c.series[0].y.pop_back(); }),
              AllOf(HasSubstr("chart \"Residual\", series \"e\""), HasSubstr("1 given, 2 needed")));
  EXPECT_THAT(with([](Chart& c) { c.x.unit = ""; }), HasSubstr("\"Time\" has no unit"));
  EXPECT_THAT(with([](Chart& c) { c.series.clear(); }), HasSubstr("no series"));
  EXPECT_THAT(with([](Chart& c) { c.series.push_back(c.series[0]); }), HasSubstr("two series"));
  EXPECT_THAT(with([](Chart& c) { c.series[0].x = {1.0, 0.0}; }), HasSubstr("x goes back"));
  EXPECT_THAT(with([](Chart& c) { c.series[0].y_axis = 1; }), HasSubstr("does not exist"));
  EXPECT_THAT(with([](Chart& c) { c.y.clear(); }), HasSubstr("one or two y axes"));
  EXPECT_THAT(with([](Chart& c) { c.max_points = 3; }), HasSubstr("max_points"));
  EXPECT_THAT(with([](Chart& c) { c.events = {{kGap, "fault"}}; }), HasSubstr("not finite"));
  EXPECT_EQ(with([](Chart& c) { c.spans = {{0.2, 0.4, "stuck"}}; }), "accepted");
  for (const SpanMark& span : {SpanMark{0.4, 0.2, "stuck"}, SpanMark{kGap, 1, "stuck"}}) {
    EXPECT_THAT(with([&](Chart& c) { c.spans = {span}; }), HasSubstr("span \"stuck\""));
  }
  EXPECT_THAT(with([](Chart& c) {
                c.y[0].log = true;
                c.y[0].min = 0.0;
              }),
              HasSubstr("logarithmic"));
  EXPECT_THAT(with([](Chart& c) { c.series[0].kind = SeriesKind::kBand; }), HasSubstr("y_upper"));
  EXPECT_THAT(with([](Chart& c) { c.series[0].kind = SeriesKind::kBars; }), HasSubstr("bar"));
}

TEST(PageJson, RefusesTablesAndMapsOfTheWrongSize) {
  Table table{.caption = "T", .columns = {{"a"}, {"b"}}, .rows = {{1.0, 2.0}, {1.0}}};
  EXPECT_THAT(refusal(page_of(table)), HasSubstr("row 2: 1 given, 2 needed"));
  table.rows.pop_back();
  table.columns[0].format = "%g";
  EXPECT_THAT(refusal(page_of(table)), HasSubstr("\"%g\""));
  table.columns[0] = {};
  EXPECT_THAT(refusal(page_of(table)), HasSubstr("a column has no name"));
  Heatmap map;
  map.title = "M";
  map.x = map.y = map.value_axis = {.name = "a", .unit = "1"};
  map.x_edges = {0.0, 1.0, 2.0};
  map.y_edges = {0.0, 1.0};
  map.value = {1.0};
  EXPECT_THAT(refusal(page_of(map)), HasSubstr("1 given, 2 needed"));
  map.value = {1.0, 2.0};
  map.x_edges = {0.0, 0.0, 2.0};
  EXPECT_THAT(refusal(page_of(map)), HasSubstr("ascending"));
}

TEST(PageJson, KnowsTheNumberFormats) {
  for (const char* good : {"d", ".0f", ".4g", ".12e", ".3f"}) {
    EXPECT_TRUE(is_number_format(good)) << good;
  }
  for (const char* bad : {"", "g", ".g", ".0g", ".13f", "4g", ".4x", ".-1f", "%.4g", ".004f"}) {
    EXPECT_FALSE(is_number_format(bad)) << bad;
  }
}

}  // namespace
}  // namespace offnominal::desk::report
