#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "wcet/wcet_report.hpp"

namespace offnominal::desk::wcet {
namespace {

report::Series bars(const std::string& name, const Histogram& histogram) {
  constexpr int kPerDecade = 40;
  report::Series series{.name = name, .kind = report::SeriesKind::kBars};
  const std::vector<Histogram::Bin> bins = histogram.log_bins(kPerDecade);
  for (const Histogram::Bin& bin : bins) {
    // A logarithmic axis has no 0.
    series.x.push_back(in_us(std::max<std::int64_t>(bin.begin_ns, 1)));
    series.y.push_back(static_cast<double>(bin.count));
  }
  if (!bins.empty()) series.x.push_back(in_us(bins.back().end_ns));
  return series;
}

report::Chart histogram_chart(const std::string& title, const std::string& name,
                              const Histogram& histogram, const WcetResult& result) {
  report::Chart chart;
  chart.title = title;
  chart.x = {.name = "duration of a tick", .unit = "us", .log = true};
  chart.y = {{.name = "ticks", .unit = "1", .log = true, .min = 0.5}};
  chart.series.push_back(bars(name, histogram));
  chart.events.push_back({in_us(histogram.max_ns()), "longest measured", report::Level::kNeutral});
  chart.events.push_back({1e6 * result.period_s, "period", report::Level::kNeutral});
  return chart;
}

report::Table times_table(const WcetResult& result) {
  report::Table table;
  table.caption = "One tick, us";
  table.columns = {{.name = "what"}, {.name = "ticks", .format = "d"}};
  for (const char* name : {"min", "mean"}) {
    table.columns.push_back({.name = name, .unit = "us", .format = ".2f"});
  }
  for (const Quantile& quantile : kQuantiles) {
    table.columns.push_back({.name = quantile.name, .unit = "us", .format = ".2f"});
  }
  table.columns.push_back({.name = "max", .unit = "us", .format = ".2f"});
  table.columns.push_back({.name = "overruns", .format = "d"});
  for (const TimeRow& row : time_rows(result)) {
    const Histogram& h = *row.histogram;
    std::vector<report::Cell> cells{row.name, static_cast<double>(h.count()), in_us(h.min_ns()),
                                    in_us(h.mean_ns())};
    for (const Quantile& quantile : kQuantiles)
      cells.emplace_back(in_us(h.quantile_ns(quantile.p)));
    cells.emplace_back(in_us(h.max_ns()));
    cells.emplace_back();
    if (row.timing != nullptr) cells.back() = static_cast<double>(row.timing->overruns);
    table.rows.push_back(std::move(cells));
  }
  table.note = fmt::format("Every time contains {} ns for reading the clock.", result.clock_ns);
  return table;
}

report::Table facts_table(const std::string& caption, const std::vector<Fact>& facts) {
  report::Table table;
  table.caption = caption;
  table.columns = {{.name = "what"}, {.name = "value"}};
  for (const Fact& fact : facts) table.rows.push_back({fact.name, fact.value});
  return table;
}

report::KeyFigures key_figures(const WcetResult& result) {
  const Histogram& h = result.worst.histogram;
  const bool overran = result.worst.overruns > 0;
  report::KeyFigures figures;
  figures.figures = {{.label = "median, worst input, warm",
                      .value = in_us(h.quantile_ns(0.5)),
                      .unit = "us",
                      .format = ".2f"},
                     {.label = "longest measured, warm",
                      .value = in_us(h.max_ns()),
                      .unit = "us",
                      .format = ".2f",
                      .level = overran ? report::Level::kBad : report::Level::kGood},
                     {.label = "longest measured, cold",
                      .value = in_us(result.cold.histogram.max_ns()),
                      .unit = "us",
                      .format = ".2f"}};
  const Extrapolation& beyond = result.extrapolation;
  if (beyond.holds()) {
    figures.figures.push_back({.label = "extrapolated, not measured",
                               .value = in_us(beyond.bound_ns),
                               .unit = "us",
                               .format = ".2f",
                               .note = fmt::format("exceeded by one tick in {:.3g}, if a Gumbel "
                                                   "tail holds",
                                                   1 / beyond.exceedance)});
  }
  return figures;
}

report::Section comparison_section(const Comparison& comparison) {
  report::Section section;
  section.heading = "Woken every period";
  section.text =
      "What comes on top of a tick's duration where a kernel wakes it: the same settings, one "
      "after "
      "the other.";
  report::Table table;
  table.caption = fmt::format("Every {} us", comparison.interval_us);
  table.columns = {{.name = "what"}, {.name = "ticks", .format = "d"}};
  for (const char* name : {"min", "mean", "p99.9", "max"}) {
    table.columns.push_back({.name = name, .unit = "us", .format = ".1f"});
  }
  const auto row = [&table](const std::string& name, const Histogram& h) {
    table.rows.push_back({name, static_cast<double>(h.count()), in_us(h.min_ns()),
                          in_us(h.mean_ns()), in_us(h.quantile_ns(0.999)), in_us(h.max_ns())});
  };
  row("the tick: wake-up", comparison.tick.latency);
  row("the tick: wake-up to its end", comparison.tick.response);
  const CyclictestResult& other = comparison.cyclictest;
  table.rows.push_back({"cyclictest " + other.version + ": wake-up",
                        static_cast<double>(other.cycles), other.min_us, other.mean_us,
                        other.quantile_us(0.999), other.max_us});
  table.note =
      fmt::format("Overruns of the tick: {} of {}. cyclictest ran as: {}", comparison.tick.overruns,
                  comparison.tick.response.count(), other.command);
  section.blocks.emplace_back(std::move(table));
  return section;
}

}  // namespace

report::Page page_of(const WcetResult& result, const std::string& command_line) {
  report::Page page;
  page.title = "Duration of one control tick";
  page.subtitle = fmt::format("{}: {} joints, {} hidden units, {}", result.robot, result.joints,
                              result.hidden_units, name_of(result.precision));
  page.command_line = command_line;
  const bool overran = result.worst.overruns + result.cold.overruns > 0;
  page.verdict = {measured_words(result), overran ? report::Level::kBad : report::Level::kNeutral};

  report::Section measured;
  measured.heading = "Measured";
  measured.blocks.emplace_back(key_figures(result));
  measured.blocks.emplace_back(
      histogram_chart("Worst input found, warm cache", "warm", result.worst.histogram, result));
  measured.blocks.emplace_back(
      histogram_chart("Worst input found, cold cache", "cold", result.cold.histogram, result));
  measured.blocks.emplace_back(times_table(result));
  page.sections.push_back(std::move(measured));

  report::Section beyond;
  beyond.heading = "Extrapolated, not measured";
  beyond.text = extrapolated_words(result);
  beyond.blocks.emplace_back(report::Note{
      "No measurement on a processor with caches and an operating system proves a bound. "
      "docs/worst-case.md says what each number means.",
      report::Level::kNeutral});
  page.sections.push_back(std::move(beyond));

  report::Section conditions;
  conditions.heading = "Conditions";
  conditions.blocks.emplace_back(facts_table("What the machine gave", machine_facts(result)));
  conditions.blocks.emplace_back(facts_table("The worst input found", input_facts(result)));
  page.sections.push_back(std::move(conditions));
  if (result.comparison) page.sections.push_back(comparison_section(*result.comparison));
  return page;
}

}  // namespace offnominal::desk::wcet
