#include <nlohmann/json.hpp>

#include "wcet/wcet_report.hpp"

namespace offnominal::desk::wcet {
namespace {

using nlohmann::ordered_json;

ordered_json histogram_json(const Histogram& histogram, bool with_bins) {
  ordered_json json{{"ticks", histogram.count()},
                    {"min_ns", histogram.min_ns()},
                    {"mean_ns", histogram.mean_ns()}};
  for (const Quantile& quantile : kQuantiles) {
    json[std::string(quantile.name) + "_ns"] = histogram.quantile_ns(quantile.p);
  }
  json["max_ns"] = histogram.max_ns();
  if (!with_bins) return json;
  ordered_json bins = ordered_json::array();
  for (const Histogram::Bin& bin : histogram.bins()) {
    bins.push_back({bin.begin_ns, bin.end_ns, bin.count});
  }
  json["bins"] = std::move(bins);  // [begin_ns, end_ns, ticks], those that are not empty
  return json;
}

ordered_json timing_json(const Timing& timing, bool with_bins) {
  ordered_json json = histogram_json(timing.histogram, with_bins);
  json["overruns"] = timing.overruns;
  return json;
}

ordered_json machine_json(const WcetResult& result) {
  const Machine& machine = result.machine;
  return {{"processor", machine.cpu_model},
          {"virtual_machine", machine.virtual_machine},
          {"kernel", machine.kernel},
          {"preemption", machine.preemption},
          {"scheduler", machine.scheduler},
          {"memory_locked", machine.memory_locked},
          {"subnormals_flushed", machine.subnormals_flushed},
          {"cpu", machine.cpu ? ordered_json(*machine.cpu) : ordered_json()},
          {"cpu_isolated", machine.cpu_isolated},
          {"governor", machine.governor},
          {"clocksource", machine.clocksource},
          {"clock_reading_ns", result.clock_ns},
          {"not_granted", result.refused},
          {"preempted", result.interference.involuntary_switches},
          {"page_faults", result.interference.page_faults},
          {"stolen_s", result.interference.stolen_s}};
}

ordered_json input_json(const WcetResult& result) {
  const TickInput& input = result.worst_input;
  const TickFacts& facts = result.worst_facts;
  return {{"from", result.worst_from},
          {"q", facts.q},
          {"dq", facts.dq},
          {"tau", facts.tau},
          {"threshold", input.threshold},
          {"error_to_threshold", facts.error_to_threshold},
          {"weight_norm", facts.weight_norm},
          {"weight_radius", facts.weight_radius},
          {"input_weights_rms", input.input_weights},
          {"output_weights_rms", input.output_weights},
          {"pre_activation", input.pre_activation},
          {"share_subnormal", facts.share_subnormal},
          {"smallest_sigmoid", facts.smallest_sigmoid},
          {"learning", facts.learned},
          {"ticks_since_reset", input.ticks}};
}

ordered_json extrapolation_json(const Extrapolation& beyond) {
  ordered_json json{{"block_size", beyond.block_size}, {"blocks", beyond.blocks}};
  json["fitted"] = beyond.fit.has_value();
  if (!beyond.fit) return json;
  json["location_ns"] = beyond.fit->location;
  json["scale_ns"] = beyond.fit->scale;
  json["kolmogorov_statistic"] = beyond.kolmogorov;
  json["kolmogorov_limit"] = kKolmogorovLimit;
  json["fit_not_refuted"] = beyond.holds();
  json["exceedance_per_tick"] = beyond.exceedance;
  json["bound_ns"] = beyond.bound_ns;
  return json;
}

ordered_json comparison_json(const Comparison& comparison) {
  const CyclictestResult& other = comparison.cyclictest;
  return {{"interval_us", comparison.interval_us},
          {"tick_latency", histogram_json(comparison.tick.latency, false)},
          {"tick_response", histogram_json(comparison.tick.response, false)},
          {"tick_overruns", comparison.tick.overruns},
          {"cyclictest",
           {{"version", other.version},
            {"command", other.command},
            {"cycles", other.cycles},
            {"min_us", other.min_us},
            {"mean_us", other.mean_us},
            {"p99.9_us", other.quantile_us(0.999)},
            {"max_us", other.max_us}}}};
}

}  // namespace

ordered_json to_json(const WcetResult& result) {
  ordered_json json{{"robot", result.robot},
                    {"joints", result.joints},
                    {"hidden_units", result.hidden_units},
                    {"hidden_units_computed", result.hidden_capacity},
                    {"scalar", name_of(result.precision)},
                    {"period_s", result.period_s},
                    {"seed", result.seed},
                    {"machine", machine_json(result)},
                    {"worst_input", input_json(result)},
                    {"worst_warm", timing_json(result.worst, true)},
                    {"worst_cold", timing_json(result.cold, true)},
                    {"cold_method", result.cold_method}};
  for (const ScenarioTiming& scenario : result.scenarios) {
    json["scenarios"][scenario.name] = timing_json(scenario.timing, false);
  }
  for (const PhaseTiming& phase : result.phases) {
    json["phases"][phase.name] = histogram_json(phase.histogram, false);
  }
  json["extrapolation"] = extrapolation_json(result.extrapolation);
  json["comparison"] = result.comparison ? comparison_json(*result.comparison) : ordered_json();
  return json;
}

}  // namespace offnominal::desk::wcet
