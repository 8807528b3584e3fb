#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/text_table.hpp"
#include "wcet/wcet_report.hpp"

namespace offnominal::desk::wcet {
namespace {

std::string yes_no(bool value) { return value ? "yes" : "no"; }

std::string list_words(const std::vector<double>& values) {
  return fmt::format("{:.4g}", fmt::join(values, ", "));
}

std::string times_text(const WcetResult& result) {
  std::vector<TextColumn> columns{{"One tick [us]", -38}, {"ticks", 11}, {"min", 9}, {"mean", 9}};
  for (const Quantile& quantile : kQuantiles) columns.push_back({quantile.name, 9});
  columns.insert(columns.end(), {{"max", 10}, {"overruns", 9}});
  const TextTable table(std::move(columns), "", "");
  std::string text = table.heading();
  const auto us = [](auto ns) { return fmt::format("{:.2f}", in_us(ns)); };
  for (const TimeRow& row : time_rows(result)) {
    const Histogram& h = *row.histogram;
    std::vector<std::string> cells{row.name, std::to_string(h.count()), us(h.min_ns()),
                                   us(h.mean_ns())};
    for (const Quantile& quantile : kQuantiles) cells.push_back(us(h.quantile_ns(quantile.p)));
    cells.push_back(us(h.max_ns()));
    if (row.timing != nullptr) cells.push_back(std::to_string(row.timing->overruns));
    text += table.line(cells);
  }
  return text;
}

std::string facts_text(const std::vector<Fact>& facts) {
  const TextTable table({{"", -34}, {"", 0}}, "  ");
  std::string text;
  for (const Fact& fact : facts) text += table.row(fact.name, fact.value);
  return text;
}

std::string comparison_text(const Comparison& comparison) {
  const TextTable table(
      {{"", -34}, {"ticks", 9}, {"min", 9}, {"mean", 9}, {"p99.9", 9}, {"max", 9}}, "  ", "");
  const auto row = [&](const std::string& name, auto count, double min, double mean, double p999,
                       double max) {
    const auto us = [](double value) { return fmt::format("{:.1f}", value); };
    return table.row(name, count, us(min), us(mean), us(p999), us(max));
  };
  const auto line = [&](const std::string& name, const Histogram& h) {
    return row(name, h.count(), in_us(h.min_ns()), in_us(h.mean_ns()), in_us(h.quantile_ns(0.999)),
               in_us(h.max_ns()));
  };
  const CyclictestResult& other = comparison.cyclictest;
  return fmt::format("\nWoken every {} us [us]\n", comparison.interval_us) + table.heading() +
         line("the tick: wake-up", comparison.tick.latency) +
         line("the tick: wake-up to its end", comparison.tick.response) +
         row("cyclictest " + other.version + ": wake-up", other.cycles, other.min_us, other.mean_us,
             other.quantile_us(0.999), other.max_us) +
         facts_text({{"overruns of the tick", fmt::format("{} of {}", comparison.tick.overruns,
                                                          comparison.tick.response.count())},
                     {"cyclictest ran as", other.command}});
}

}  // namespace

std::vector<TimeRow> time_rows(const WcetResult& result) {
  std::vector<TimeRow> rows{
      {"worst input found, warm cache", &result.worst.histogram, &result.worst},
      {"worst input found, cold cache", &result.cold.histogram, &result.cold}};
  for (const ScenarioTiming& scenario : result.scenarios) {
    rows.push_back({"  " + scenario.name, &scenario.timing.histogram, &scenario.timing});
  }
  for (const PhaseTiming& phase : result.phases) {
    rows.push_back({"  " + phase.name, &phase.histogram, nullptr});
  }
  return rows;
}

std::vector<Fact> machine_facts(const WcetResult& result) {
  const Machine& machine = result.machine;
  std::vector<Fact> facts{
      {"processor", machine.cpu_model + (machine.virtual_machine ? ", in a virtual machine" : "")},
      {"kernel", machine.kernel},
      {"kernel preemption model", machine.preemption},
      {"scheduler class", machine.scheduler},
      {"memory locked", yes_no(machine.memory_locked)},
      {"subnormal numbers", machine.subnormals_flushed ? "flushed to zero" : "computed"},
      {"bound to CPU", machine.cpu ? std::to_string(*machine.cpu) : "none"},
      {"CPU isolated", yes_no(machine.cpu_isolated)},
      {"frequency governor", machine.governor},
      {"clock", fmt::format("{}, {} ns a reading, contained in every time", machine.clocksource,
                            result.clock_ns)},
      {"while the worst input was timed",
       fmt::format("preempted {} times, {} page faults, {:.2f} s stolen by the hypervisor",
                   result.interference.involuntary_switches, result.interference.page_faults,
                   result.interference.stolen_s)}};
  for (const std::string& refused : result.refused) facts.push_back({"not granted", refused});
  return facts;
}

std::vector<Fact> input_facts(const WcetResult& result) {
  const TickInput& input = result.worst_input;
  const TickFacts& facts = result.worst_facts;
  return {{"found by", result.worst_from == "search" ? fmt::format("search, {} candidates, seed {}",
                                                                   result.evaluations, result.seed)
                                                     : "scenario " + result.worst_from},
          {"q (rad or m)", list_words(facts.q)},
          {"dq (rad/s or m/s)", list_words(facts.dq)},
          {"tau (N m or N)", list_words(facts.tau)},
          {"|e| / mu", fmt::format("{:.6g}", facts.error_to_threshold)},
          {"mu", fmt::format("{:.4g}", input.threshold)},
          {"|theta| / M", fmt::format("{:.6g}", facts.weight_norm / facts.weight_radius)},
          {"output weights, rms", fmt::format("{:.4g}", input.output_weights)},
          {"output weights subnormal", fmt::format("{:.0f} %", 100 * facts.share_subnormal)},
          {"smallest sigmoid, magnitude", fmt::format("{:.4g}", facts.smallest_sigmoid)},
          {"learning", yes_no(facts.learned)},
          {"ticks since reset", std::to_string(input.ticks)}};
}

std::string measured_words(const WcetResult& result) {
  const Histogram& h = result.worst.histogram;
  const double period_us = 1e6 * result.period_s;
  return fmt::format(
      "Measured: the longest of {} ticks from the worst input found took {:.2f} us, half of them "
      "at "
      "most {:.2f} us; {} took longer than the period of {:g} us. With a cold cache the longest of "
      "{} "
      "took {:.2f} us.",
      h.count(), in_us(h.max_ns()), in_us(h.quantile_ns(0.5)), result.worst.overruns, period_us,
      result.cold.histogram.count(), in_us(result.cold.histogram.max_ns()));
}

std::string extrapolated_words(const WcetResult& result) {
  const Extrapolation& beyond = result.extrapolation;
  if (!beyond.fit) {
    return fmt::format(
        "Extrapolated: nothing. It takes {} blocks whose largest times are not all the same; here "
        "are {}.",
        kLeastMaxima, beyond.blocks);
  }
  std::string words = fmt::format(
      "Extrapolated, not measured: one tick in {:.3g} takes longer than {:.2f} us, if the largest "
      "of "
      "every {} ticks follow a Gumbel distribution (fitted to {} blocks: location {:.2f} us, scale "
      "{:.3f} us), are independent, and the machine stays as it was.",
      1 / beyond.exceedance, in_us(beyond.bound_ns), beyond.block_size, beyond.blocks,
      in_us(beyond.fit->location), in_us(beyond.fit->scale));
  if (!beyond.holds()) {
    words += fmt::format(
        " They do not: Kolmogorov's statistic is {:.2f}, above {:.3f}. Do not use this number.",
        beyond.kolmogorov, kKolmogorovLimit);
  } else {
    words += fmt::format(" The fit is not refuted (Kolmogorov's statistic {:.2f}, limit {:.3f}).",
                         beyond.kolmogorov, kKolmogorovLimit);
  }
  if (beyond.bound_ns < static_cast<double>(result.worst.histogram.max_ns())) {
    words += " A longer tick than that was measured: the measured one counts.";
  }
  return words;
}

std::string bars_of(const Histogram& histogram) {
  constexpr int kPerDecade = 20;
  constexpr double kCharactersPerDecade = 6;
  const TextTable table({{"", 10}, {"", 2}, {"", 10}, {"", 11}, {"", 0}});
  std::string text;
  int empty = 0;
  for (const Histogram::Bin& bin : histogram.log_bins(kPerDecade)) {
    if (bin.count == 0) {
      ++empty;
      continue;
    }
    if (empty > 0) text += table.row("", "", "...");
    empty = 0;
    const double length = 1 + kCharactersPerDecade * std::log10(static_cast<double>(bin.count));
    text += table.row(fmt::format("{:.2f}", in_us(bin.begin_ns)), "to",
                      fmt::format("{:.2f}", in_us(bin.end_ns)), bin.count,
                      std::string(static_cast<std::size_t>(length), '#'));
  }
  return text;
}

std::string text_of(const WcetResult& result) {
  std::string text =
      fmt::format("{}: {} joints, {} hidden units ({} computed), {}, period {:g} us\n",
                  result.robot, result.joints, result.hidden_units, result.hidden_capacity,
                  name_of(result.precision), 1e6 * result.period_s);
  text += facts_text(machine_facts(result));
  text += "\n" + times_text(result);
  text += "\nThe worst input found\n" + facts_text(input_facts(result));
  text += "\nThe worst input found, warm cache [us], ticks, logarithmic bins and bars\n" +
          bars_of(result.worst.histogram);
  if (result.comparison) text += comparison_text(*result.comparison);
  return text + "\n" + measured_words(result) + "\n" + extrapolated_words(result) + "\n";
}

}  // namespace offnominal::desk::wcet
