#include "report/validate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "report/decimate.hpp"

namespace offnominal::desk::report {
namespace {

[[noreturn]] void refuse(const std::string& block, const std::string& fault) {
  throw std::invalid_argument("report page: " + block + ": " + fault);
}

void require(bool holds, const std::string& block, const std::string& fault) {
  if (!holds) refuse(block, fault);
}

void check_length(const std::string& block, const std::string& what, std::size_t found,
                  std::size_t allowed) {
  require(found == allowed, block,
          what + ": " + std::to_string(found) + " given, " + std::to_string(allowed) + " needed");
}

void check_format(const std::string& block, const std::string& format) {
  require(is_number_format(format), block,
          "number format \"" + format + "\"; allowed: d, .Nf, .Ng, .Ne with N up to 12");
}

void check_axis(const std::string& block, const Axis& axis) {
  require(!axis.name.empty(), block, "an axis has no name");
  require(!axis.unit.empty(), block,
          "axis \"" + axis.name + "\" has no unit (\"1\" where dimensionless)");
  for (const std::optional<double>& limit : {axis.min, axis.max}) {
    require(!limit || std::isfinite(*limit), block, "axis \"" + axis.name + "\": limit not finite");
    require(!limit || !axis.log || *limit > 0.0, block,
            "axis \"" + axis.name + "\": limit <= 0 on a logarithmic axis");
  }
  require(!axis.min || !axis.max || *axis.min < *axis.max, block,
          "axis \"" + axis.name + "\": min is not below max");
}

void check_edges(const std::string& block, const std::vector<double>& edges) {
  require(edges.size() >= 2, block, "fewer than two edges");
  for (std::size_t i = 0; i < edges.size(); ++i) {
    require(std::isfinite(edges[i]) && (i == 0 || edges[i - 1] < edges[i]), block,
            "edges must be finite and ascending");
  }
}

void check_order(const std::string& block, const std::vector<double>& x) {
  double last = -std::numeric_limits<double>::infinity();
  for (const double value : x) {
    if (!std::isfinite(value)) continue;
    require(value >= last, block,
            "x goes back from " + std::to_string(last) + " to " + std::to_string(value) +
                "; only points may do that");
    last = value;
  }
}

void check_series(const std::string& chart, const Series& series, std::size_t y_axes) {
  const std::string block = chart + ", series \"" + series.name + "\"";
  require(!series.name.empty(), chart, "a series has no name");
  require(series.y_axis < y_axes, block, "its y axis does not exist");
  if (series.kind == SeriesKind::kBars) {
    check_edges(block, series.x);
    check_length(block, "y (one per bar, edges less one)", series.y.size(), series.x.size() - 1);
  } else {
    check_length(block, "y (as long as x)", series.y.size(), series.x.size());
    require(!series.x.empty(), block, "no point");
    if (series.kind != SeriesKind::kPoints) check_order(block, series.x);
  }
  const bool band = series.kind == SeriesKind::kBand;
  check_length(block, band ? "y_upper (as long as y)" : "y_upper (bands only)",
               series.y_upper.size(), band ? series.y.size() : 0);
}

void check(const Table& table) {
  const std::string block = "table \"" + table.caption + "\"";
  require(!table.caption.empty(), block, "no caption");
  require(!table.columns.empty(), block, "no column");
  for (const Column& column : table.columns) {
    require(!column.name.empty(), block, "a column has no name");
    check_format(block, column.format);
  }
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    check_length(block, "cells of row " + std::to_string(i + 1), table.rows[i].size(),
                 table.columns.size());
  }
}

void check(const KeyFigures& key_figures) {
  require(!key_figures.figures.empty(), "key figures", "none given");
  for (const KeyFigure& figure : key_figures.figures) {
    const std::string block = "key figure \"" + figure.label + "\"";
    require(!figure.label.empty(), block, "no label");
    check_format(block, figure.format);
  }
}

void check_levels(const std::string& block, const std::vector<LevelMark>& levels) {
  for (const LevelMark& mark : levels) {
    require(std::isfinite(mark.y), block, "level \"" + mark.label + "\" is not finite");
  }
}

void check(const Chart& chart) {
  const std::string block = "chart \"" + chart.title + "\"";
  require(!chart.title.empty(), block, "no title");
  check_axis(block, chart.x);
  require(chart.y.size() == 1 || chart.y.size() == 2, block, "needs one or two y axes");
  for (const Axis& axis : chart.y) check_axis(block, axis);
  require(!chart.series.empty(), block, "no series");
  require(chart.max_points >= kMinDecimatedPoints, block,
          "max_points below " + std::to_string(kMinDecimatedPoints));
  for (auto it = chart.series.begin(); it != chart.series.end(); ++it) {
    check_series(block, *it, chart.y.size());
    require(std::none_of(chart.series.begin(), it,
                         [&](const Series& other) { return other.name == it->name; }),
            block, "two series are called \"" + it->name + "\"");
  }
  for (const EventMark& event : chart.events) {
    require(std::isfinite(event.x), block, "event \"" + event.label + "\" is not finite");
  }
  for (const SpanMark& span : chart.spans) {
    const bool is_span = std::isfinite(span.from) && std::isfinite(span.to) && span.from < span.to;
    require(is_span, block, "span \"" + span.label + "\" does not end behind its beginning");
  }
  check_levels(block, chart.levels);
}

void check(const Heatmap& map) {
  const std::string block = "heatmap \"" + map.title + "\"";
  require(!map.title.empty(), block, "no title");
  for (const Axis* axis : {&map.x, &map.y, &map.value_axis}) {
    check_axis(block, *axis);
    require(!axis->log, block, "axis \"" + axis->name + "\": a heatmap has no logarithmic axis");
  }
  check_edges(block + ", x", map.x_edges);
  check_edges(block + ", y", map.y_edges);
  check_length(block, "value (rows times columns)", map.value.size(),
               (map.x_edges.size() - 1) * (map.y_edges.size() - 1));
}

void check(const Waterfall& waterfall) {
  const std::string block = "waterfall \"" + waterfall.title + "\"";
  require(!waterfall.title.empty(), block, "no title");
  check_axis(block, waterfall.value_axis);
  check_format(block, waterfall.format);
  require(!waterfall.value_axis.log, block, "bars need a linear axis");
  require(!waterfall.steps.empty(), block, "no step");
  check_levels(block, waterfall.levels);
}

void check(const Note& note) { require(!note.text.empty(), "note", "no text"); }

}  // namespace

bool is_number_format(const std::string& format) {
  if (format == "d") return true;
  if (format.size() < 3 || format.size() > 4 || format.front() != '.') return false;
  const char style = format.back();
  if (style != 'f' && style != 'g' && style != 'e') return false;
  const std::string digits = format.substr(1, format.size() - 2);
  if (digits.find_first_not_of("0123456789") != std::string::npos) return false;
  const int count = std::stoi(digits);
  return count <= 12 && (count >= 1 || style != 'g');
}

void validate(const Page& page) {
  require(!page.title.empty(), "title", "empty");
  require(!page.verdict.words.empty(), "verdict", "no words");
  for (const Section& section : page.sections) {
    require(!section.heading.empty(), "section", "no heading");
    for (const Block& block : section.blocks) {
      std::visit([](const auto& value) { check(value); }, block);
    }
  }
}

}  // namespace offnominal::desk::report
