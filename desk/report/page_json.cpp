#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <offnominal/version.hpp>

#include "report/decimate.hpp"
#include "report/page.hpp"
#include "report/validate.hpp"

namespace offnominal::desk::report {

NLOHMANN_JSON_SERIALIZE_ENUM(Level, {{Level::kNeutral, "neutral"},
                                     {Level::kGood, "good"},
                                     {Level::kWarn, "warn"},
                                     {Level::kBad, "bad"}})
NLOHMANN_JSON_SERIALIZE_ENUM(Width, {{Width::kFull, "full"}, {Width::kHalf, "half"}})
NLOHMANN_JSON_SERIALIZE_ENUM(SeriesKind, {{SeriesKind::kLine, "line"},
                                          {SeriesKind::kPoints, "points"},
                                          {SeriesKind::kSteps, "steps"},
                                          {SeriesKind::kBand, "band"},
                                          {SeriesKind::kBars, "bars"}})
NLOHMANN_JSON_SERIALIZE_ENUM(Tone, {{Tone::kAuto, "auto"},
                                    {Tone::kMeasured, "measured"},
                                    {Tone::kModel, "model"},
                                    {Tone::kResidual, "residual"},
                                    {Tone::kThreshold, "threshold"},
                                    {Tone::kFaint, "faint"}})

namespace {

using nlohmann::json;

constexpr int kXDigits = 9;  ///< a millisecond in a recording of eleven days
constexpr int kYDigits = 7;

/// The nearest number with `digits` significant digits, null when it is not finite.
json rounded(double value, int digits) {
  if (!std::isfinite(value)) return nullptr;
  if (value == 0.0) return 0.0;
  char text[32];
  const auto end =
      std::to_chars(text, text + sizeof text, value, std::chars_format::scientific, digits - 1).ptr;
  double result = 0.0;
  std::from_chars(text, end, result);
  return result;
}

json rounded(const std::vector<double>& values, int digits) {
  json result = json::array();
  for (const double value : values) result.push_back(rounded(value, digits));
  return result;
}

json exact(double value) { return std::isfinite(value) ? json(value) : json(nullptr); }

std::string joined(const std::string& first, const std::string& second) {
  return first.empty() || second.empty() ? first + second : first + " " + second;
}

/// One overload per part of the page; a class, so that each may use those after it.
struct Json {
  static json of(const std::optional<double>& value) {
    return value ? exact(*value) : json(nullptr);
  }

  static json of(const Cell& cell) {
    if (const double* number = std::get_if<double>(&cell)) return exact(*number);
    if (const std::string* text = std::get_if<std::string>(&cell)) return *text;
    return nullptr;
  }

  static json of(const Axis& axis) {
    return {{"name", axis.name},
            {"unit", axis.unit},
            {"log", axis.log},
            {"min", of(axis.min)},
            {"max", of(axis.max)}};
  }

  static json of(const SpanMark& span) {
    return {{"from", exact(span.from)},
            {"to", exact(span.to)},
            {"label", span.label},
            {"level", span.level}};
  }

  static json of(const LevelMark& mark) { return {{"y", mark.y}, {"label", mark.label}}; }

  template <typename Item>
  static json list(const std::vector<Item>& items) {
    json result = json::array();
    for (const Item& item : items) result.push_back(of(item));
    return result;
  }

  static json of(const Column& column) {
    return {{"name", column.name}, {"unit", column.unit}, {"format", column.format}};
  }

  static json of(const std::vector<Cell>& row) { return list(row); }

  static json of(const Table& table) {
    return {{"type", "table"},
            {"caption", table.caption},
            {"columns", list(table.columns)},
            {"rows", list(table.rows)},
            {"note", table.note}};
  }

  static json of(const KeyFigure& figure) {
    return {{"label", figure.label},   {"value", of(figure.value)}, {"unit", figure.unit},
            {"format", figure.format}, {"level", figure.level},     {"note", figure.note}};
  }

  static json of(const KeyFigures& key_figures) {
    return {{"type", "key_figures"}, {"figures", list(key_figures.figures)}};
  }

  static json of(const Series& series) {
    json result = {{"name", series.name},
                   {"kind", series.kind},
                   {"tone", series.tone},
                   {"dashed", series.dashed},
                   {"y_axis", series.y_axis},
                   {"x", rounded(series.x, kXDigits)},
                   {"y", rounded(series.y, kYDigits)}};
    if (series.kind == SeriesKind::kBand) result["y_upper"] = rounded(series.y_upper, kYDigits);
    return result;
  }

  static json of(const EventMark& event) {
    return {{"x", event.x}, {"label", event.label}, {"level", event.level}};
  }

  static json of(const Chart& chart) {
    std::vector<Series> drawn;
    std::size_t longest = 0;
    for (const Series& series : chart.series) {
      drawn.push_back(decimate(series, chart.max_points));
      if (drawn.back().x.size() < series.x.size()) longest = std::max(longest, series.x.size());
    }
    const std::string reduction =
        longest == 0 ? ""
                     : "Drawn with at most " + std::to_string(chart.max_points) + " of up to " +
                           std::to_string(longest) + " points per series; peaks are kept.";
    return {{"type", "chart"},
            {"title", chart.title},
            {"x", of(chart.x)},
            {"y", list(chart.y)},
            {"series", list(drawn)},
            {"events", list(chart.events)},
            {"spans", list(chart.spans)},
            {"levels", list(chart.levels)},
            {"zoom_group", chart.zoom_group},
            {"slider", chart.slider},
            {"width", chart.width},
            {"note", joined(chart.note, reduction)}};
  }

  static json of(const Heatmap& map) {
    return {{"type", "heatmap"},
            {"title", map.title},
            {"x", of(map.x)},
            {"y", of(map.y)},
            {"value_axis", of(map.value_axis)},
            {"x_edges", rounded(map.x_edges, kXDigits)},
            {"y_edges", rounded(map.y_edges, kXDigits)},
            {"value", rounded(map.value, kYDigits)},
            {"diverging", map.diverging},
            {"width", map.width},
            {"note", map.note}};
  }

  static json of(const WaterfallStep& step) {
    return {{"label", step.label}, {"value", exact(step.value)}};
  }

  static json of(const Waterfall& waterfall) {
    return {{"type", "waterfall"},
            {"title", waterfall.title},
            {"value_axis", of(waterfall.value_axis)},
            {"steps", list(waterfall.steps)},
            {"levels", list(waterfall.levels)},
            {"format", waterfall.format},
            {"width", waterfall.width},
            {"note", waterfall.note}};
  }

  static json of(const Note& note) {
    return {{"type", "note"}, {"text", note.text}, {"level", note.level}};
  }

  static json of(const Block& block) {
    return std::visit([](const auto& value) { return of(value); }, block);
  }

  static json of(const Section& section) {
    return {{"heading", section.heading},
            {"text", section.text},
            {"blocks", list(section.blocks)},
            {"recording", section.recording}};
  }
};

std::string version() {
  return std::to_string(kVersionMajor) + "." + std::to_string(kVersionMinor) + "." +
         std::to_string(kVersionPatch);
}

}  // namespace

nlohmann::json to_json(const Page& page) {
  validate(page);
  return {{"title", page.title},
          {"subtitle", page.subtitle},
          {"verdict", {{"words", page.verdict.words}, {"level", page.verdict.level}}},
          {"sections", Json::list(page.sections)},
          {"command_line", page.command_line},
          {"version", version()}};
}

}  // namespace offnominal::desk::report
