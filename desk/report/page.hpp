#pragma once

#include <cstddef>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "common/file.hpp"

/// A report page as a document of plain data, free of any drawing library.
/// A page is built by value, then written with write_page(). Text is UTF-8, shown as it stands
/// (no markup; an empty line starts a paragraph). Units are SI symbols ("s", "rad/s", "Nm", "%");
/// "1" stands for dimensionless. NaN and infinite numbers are gaps.
namespace offnominal::desk::report {

/// What a verdict, a note, a figure or an event says about the state of things. The words carry
/// the meaning; the level only chooses colour and symbol.
enum class Level { kNeutral, kGood, kWarn, kBad };

/// Share of the page's width that a picture takes. Two kHalf pictures in a row stand side by side
/// on a wide screen.
enum class Width { kFull, kHalf };

struct Verdict {
  std::string words{};
  Level level = Level::kNeutral;
};

/// A table's field: empty, a number (shown in its column's format) or text.
using Cell = std::variant<std::monostate, double, std::string>;

/// Format of numbers: "d" integer, ".Nf" N decimals, ".Ng" N significant digits,
/// ".Ne" N decimals and a power of ten; N from 0 (g: from 1) to 12.
inline constexpr const char* kDefaultFormat = ".4g";

struct Column {
  std::string name{};
  std::string unit{};  ///< empty for text columns
  std::string format = kDefaultFormat;
};

/// Numbers stand on the right, text on the left. Every row has as many cells as there are columns.
struct Table {
  std::string caption{};
  std::vector<Column> columns{};
  std::vector<std::vector<Cell>> rows{};
  std::string note{};
};

/// The few numbers a reader looks for first, shown large, side by side.
struct KeyFigure {
  std::string label{};
  Cell value{};
  std::string unit{};  ///< "1" or empty where there is none to show
  std::string format = kDefaultFormat;
  Level level = Level::kNeutral;
  std::string note{};  ///< one short line, e.g. "paper: 10.6 s"
};
struct KeyFigures {
  std::vector<KeyFigure> figures{};
};

/// Unit must not be empty ("1" = dimensionless). On a logarithmic axis values <= 0 are gaps.
struct Axis {
  std::string name{};
  std::string unit{};
  bool log = false;
  std::optional<double> min{};  ///< unset: from the data
  std::optional<double> max{};
};

enum class SeriesKind {
  kLine,
  kPoints,
  kSteps,  ///< y[i] holds from x[i] to x[i + 1]
  kBand,   ///< area between y and y_upper
  kBars,   ///< histogram: x holds the n + 1 ascending edges of n bars
};

/// Meaning of a series, so that the same thing has the same colour in every chart.
/// kAuto takes the next colour of the palette; kFaint is a quiet grey; kThreshold is dashed.
enum class Tone { kAuto, kMeasured, kModel, kResidual, kThreshold, kFaint };

/// x and y have the same length, x is in recorded order (lines, steps, bands: not decreasing).
struct Series {
  std::string name{};
  SeriesKind kind = SeriesKind::kLine;
  std::vector<double> x{};
  std::vector<double> y{};
  std::vector<double> y_upper{};  ///< kBand only, as long as y
  Tone tone = Tone::kAuto;
  bool dashed = false;
  std::size_t y_axis = 0;  ///< 0 left, 1 right
};

/// A vertical line at x, e.g. {10.0, "fault", Level::kNeutral}, {10.6, "detected", Level::kGood}.
struct EventMark {
  double x = 0.0;
  std::string label{};
  Level level = Level::kNeutral;
};

/// What holds from one x to another, e.g. {3.1, 4.2, "encoder stuck", Level::kBad}: a band behind
/// the series. Bands may overlap; from < to.
struct SpanMark {
  double from = 0.0;
  double to = 0.0;
  std::string label{};
  Level level = Level::kNeutral;
};

/// A horizontal line at y on the left axis, e.g. a published figure.
struct LevelMark {
  double y = 0.0;
  std::string label{};
};

/// A picture with numeric axes.
struct Chart {
  std::string title{};
  Axis x{};
  std::vector<Axis> y{};  ///< one (left) or two (left, right)
  std::vector<Series> series{};
  std::vector<EventMark> events{};
  std::vector<SpanMark> spans{};
  std::vector<LevelMark> levels{};
  /// Charts of one page with the same non-empty group have the same x range and zoom together.
  std::string zoom_group{};
  bool slider = false;  ///< range slider under the chart; for long time series
  Width width = Width::kFull;
  std::string note{};
  /// A longer series is reduced for drawing by decimate(), which keeps its peaks; the note says so.
  std::size_t max_points = 4000;
};

/// Cells of equal meaning on a numeric grid: cell (row r, column c) covers
/// [x_edges[c], x_edges[c+1]] x [y_edges[r], y_edges[r+1]] and has value[r * columns + c].
struct Heatmap {
  std::string title{};
  Axis x{};
  Axis y{};
  Axis value_axis{};              ///< min and max are the ends of the colour scale
  std::vector<double> x_edges{};  ///< ascending, columns + 1
  std::vector<double> y_edges{};  ///< ascending, rows + 1
  std::vector<double> value{};    ///< NaN: no data in this cell
  bool diverging = false;         ///< colours symmetric about zero, for signed values
  Width width = Width::kHalf;
  std::string note{};
};

/// What is left after each step, e.g. error 69 % -> 17 % -> 4 %: a bar per step, and above it what
/// the step took away.
struct WaterfallStep {
  std::string label{};
  double value = 0.0;
};
struct Waterfall {
  std::string title{};
  Axis value_axis{};
  std::vector<WaterfallStep> steps{};
  std::vector<LevelMark> levels{};
  std::string format = kDefaultFormat;
  Width width = Width::kFull;
  std::string note{};
};

struct Note {
  std::string text{};
  Level level = Level::kNeutral;
};

using Block = std::variant<Table, KeyFigures, Chart, Heatmap, Waterfall, Note>;

/// A page may show several recordings: sections of the same `recording` stand together, and the
/// reader chooses which recording's are shown. The others, whose `recording` is empty, are always
/// shown.
struct Section {
  std::string heading{};
  std::string text{};
  std::vector<Block> blocks{};
  std::string recording{};
};

struct Page {
  std::string title{};
  std::string subtitle{};
  Verdict verdict{};
  std::vector<Section> sections{};
  std::string command_line{};  ///< that made the page; shown in the footer, may be empty
};

/// Everything the page shows, as the page embeds it (`<script id="data">`): the page draws from
/// this object and holds no other number. Series are reduced and rounded (y to 7, x to 9
/// significant digits; table cells and key figures are exact), gaps are null.
/// Throws std::invalid_argument, naming the block, when the page contradicts itself: lengths that
/// do not match, an axis without unit, edges that do not ascend, an unknown format, an empty chart.
nlohmann::json to_json(const Page& page);

/// The page as one HTML text that needs no other file and makes no request.
/// The same page gives the same bytes. Throws as to_json().
std::string render(const Page& page);

/// Writes render(page) to `path`; the file appears whole or not at all. With Existing::kRefuse a
/// file that is there is left alone, unless it is such a page.
/// Throws as to_json(), and an exception naming the file when it cannot be written.
void write_page(const std::filesystem::path& path, const Page& page,
                Existing existing = Existing::kRefuse);

/// Whether a file is a page that write_page() wrote: its head says so.
[[nodiscard]] bool is_page(const std::filesystem::path& file);

}  // namespace offnominal::desk::report
