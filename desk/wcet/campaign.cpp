#include "wcet/campaign.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "common/error.hpp"
#include "drives/drive_table.hpp"
#include "wcet/cache.hpp"
#include "wcet/tick_bus.hpp"

namespace offnominal::desk::wcet {
namespace {

// Repetitions whose shortest says what an input costs: the machine's disturbances only add.
constexpr int kSearchRepetitions = 15;
constexpr int kFinalRepetitions = 301;

std::int64_t timed_run(Tick& tick) {
  tick.restore();
  const std::int64_t begin = now_ns();
  tick.run();
  return now_ns() - begin;
}

double shortest_run(Tick& tick, int repetitions) {
  std::int64_t shortest = std::numeric_limits<std::int64_t>::max();
  for (int i = 0; i < repetitions; ++i) shortest = std::min(shortest, timed_run(tick));
  return static_cast<double>(shortest);
}

// Below 0 for an input that the controller would never get to see.
double cost_of(Tick& tick, const TickInput& input, int repetitions) {
  try {
    tick.prepare(input);
  } catch (const std::runtime_error&) {
    return -1;
  }
  if (!tick.facts().watched) return -1;
  return shortest_run(tick, repetitions);
}

class Campaign {
 public:
  Campaign(const RobotDescription& robot, const WcetSettings& settings,
           const OnWcetProgress& on_progress)
      : robot_(robot),
        settings_(settings),
        on_progress_(on_progress),
        tick_(make_tick(robot, settings.precision, settings.format)) {
    result_.period_s = settings.period_s.value_or(robot.estimator.period_s);
    period_ns_ = std::llround(1e9 * result_.period_s);
  }

  WcetResult run() {
    describe();
    measure_scenarios();
    find_worst();
    measure_worst();
    measure_cold();
    measure_phases();
    if (settings_.compare_cyclictest) compare();
    return std::move(result_);
  }

 private:
  void describe() {
    result_.refused = prepare_machine(settings_.machine);
    result_.machine = describe_machine();
    result_.robot = robot_.name;
    result_.joints = robot_.joint_count();
    result_.hidden_units = robot_.estimator.hidden_units;
    result_.hidden_capacity = tick_->hidden_capacity();
    result_.precision = settings_.precision;
    result_.seed = settings_.search.seed;
    result_.clock_ns = std::numeric_limits<std::int64_t>::max();
    for (int i = 0; i < 1000; ++i) {
      const std::int64_t begin = now_ns();
      result_.clock_ns = std::min(result_.clock_ns, now_ns() - begin);
    }
  }

  void record(std::int64_t duration_ns, Timing& timing) const {
    timing.histogram.record(duration_ns);
    if (duration_ns > period_ns_) ++timing.overruns;
  }

  void progress(const std::string& what, std::int64_t done) const {
    constexpr std::int64_t kEvery = 10'000;
    if (on_progress_ && done % kEvery == 0) on_progress_(what, done);
  }

  // Caches and branch predictors as they are when the same tick has just run.
  void warm_up() {
    for (int i = 0; i < 100; ++i) timed_run(*tick_);
  }

  [[nodiscard]] std::int64_t ticks_of_a_scenario() const {
    return std::clamp<std::int64_t>(settings_.ticks / 20, 1, 100'000);
  }

  void measure_scenarios() {
    for (const Scenario& scenario : scenarios(robot_, settings_.precision)) {
      ScenarioTiming& timing = result_.scenarios.emplace_back();
      timing.name = scenario.name;
      timing.words = scenario.words;
      tick_->prepare(scenario.input);
      timing.facts = tick_->facts();
      warm_up();
      for (std::int64_t i = 0; i < ticks_of_a_scenario(); ++i) {
        record(timed_run(*tick_), timing.timing);
        progress(std::string("scenario ") + scenario.name, i);
      }
    }
  }

  void find_worst() {
    std::vector<TickInput> beginnings;
    const std::vector<Scenario> known = scenarios(robot_, settings_.precision);
    for (const Scenario& scenario : known) {
      // What a bus can carry beside the joints' frames is a matter of the bus, not of the search.
      if (scenario.input.foreign_frames == 0) beginnings.push_back(scenario.input);
    }
    const SampleRange range = sample_range(robot_);
    std::int64_t evaluated = 0;
    auto candidates = search_worst(
        beginnings,
        [&](const TickInput& input) {
          if (on_progress_ && ++evaluated % 100 == 0) on_progress_("search", evaluated);
          return cost_of(*tick_, input, kSearchRepetitions);
        },
        [&](const TickInput& input, std::mt19937_64& generator) {
          return mutated(input, robot_, range, settings_.precision, generator);
        },
        settings_.search);
    if (candidates.empty()) throw std::runtime_error("no input was accepted by the controller");
    result_.evaluations = settings_.search.evaluations;
    // What was only measured badly falls back.
    for (Candidate& candidate : candidates) {
      candidate.cost_ns = cost_of(*tick_, candidate.input, kFinalRepetitions);
    }
    const auto worst = std::max_element(
        candidates.begin(), candidates.end(),
        [](const Candidate& a, const Candidate& b) { return a.cost_ns < b.cost_ns; });
    result_.worst_input = worst->input;
    result_.worst_from = "search";
    double cost = worst->cost_ns;
    for (const Scenario& scenario : known) {
      if (scenario.input.foreign_frames > 0) continue;
      const double known_cost = cost_of(*tick_, scenario.input, kFinalRepetitions);
      if (known_cost <= cost) continue;
      cost = known_cost;
      result_.worst_input = scenario.input;
      result_.worst_from = scenario.name;
    }
    tick_->prepare(result_.worst_input);
    result_.worst_facts = tick_->facts();
  }

  void measure_worst() {
    constexpr std::int64_t kBlocks = 1000;
    const std::int64_t block = std::max<std::int64_t>(settings_.ticks / kBlocks, 1);
    BlockMaxima maxima(block, static_cast<std::size_t>(settings_.ticks / block));
    warm_up();
    const Interference before = interference();
    for (std::int64_t i = 0; i < settings_.ticks; ++i) {
      const std::int64_t duration = timed_run(*tick_);
      record(duration, result_.worst);
      maxima.record(static_cast<double>(duration));
      progress("worst input, warm cache", i);
    }
    result_.interference = interference() - before;
    extrapolate(maxima);
  }

  void extrapolate(const BlockMaxima& maxima) {
    Extrapolation& beyond = result_.extrapolation;
    beyond.block_size = maxima.block_size();
    beyond.blocks = maxima.maxima().size();
    beyond.exceedance = settings_.exceedance;
    beyond.fit = fit_gumbel(maxima.maxima());
    if (!beyond.fit) return;
    beyond.kolmogorov = kolmogorov_statistic(*beyond.fit, maxima.maxima());
    beyond.bound_ns = exceeded_with(*beyond.fit, beyond.block_size, beyond.exceedance);
  }

  void measure_cold() {
    CacheFlush cache;
    result_.cold_method = cache.method();
    const std::int64_t ticks = settings_.cold_ticks.value_or(
        std::clamp<std::int64_t>(settings_.ticks / 1000, 100, 10'000));
    for (std::int64_t i = 0; i < ticks; ++i) {
      tick_->restore();
      cache.flush(tick_->memory());
      const std::int64_t begin = now_ns();
      tick_->run();
      record(now_ns() - begin, result_.cold);
      if (on_progress_ && i % 100 == 0) on_progress_("worst input, cold cache", i);
    }
  }

  void measure_phases() {
    for (const char* name : kPhaseNames) result_.phases.push_back({name, {}});
    for (std::int64_t i = 0; i < ticks_of_a_scenario(); ++i) {
      std::array<std::int64_t, kPhases> durations{};
      tick_->restore();
      tick_->run_phases(durations);
      for (std::size_t p = 0; p < kPhases; ++p) result_.phases[p].histogram.record(durations[p]);
      progress("phases", i);
    }
    for (std::size_t p = 0; p < kParts; ++p) {
      PhaseTiming part{kPartNames.at(p), {}};
      for (std::int64_t i = 0; i < ticks_of_a_scenario(); ++i) {
        tick_->restore();
        const std::int64_t begin = now_ns();
        tick_->run_part(static_cast<Part>(p));
        part.histogram.record(now_ns() - begin);
      }
      const auto behind = result_.phases.begin() + static_cast<std::ptrdiff_t>(2 + p);
      result_.phases.insert(behind, std::move(part));
    }
  }

  void compare() {
    Comparison comparison;
    comparison.interval_us = std::max<std::int64_t>(period_ns_ / 1000, 1);
    CyclicSettings settings;
    settings.interval_us = comparison.interval_us;
    settings.ticks = settings_.cyclic_ticks;
    settings.request = settings_.machine;
    settings.machine = result_.machine;
    if (on_progress_) on_progress_("the tick every period", 0);
    tick_->restore();
    comparison.tick = run_cyclic(
        settings, [this] { tick_->run(); }, [this] { tick_->restore(); });
    if (on_progress_) on_progress_("cyclictest", 0);
    comparison.cyclictest = run_cyclictest(settings);
    result_.comparison = std::move(comparison);
  }

  const RobotDescription& robot_;
  const WcetSettings& settings_;
  const OnWcetProgress& on_progress_;
  std::unique_ptr<Tick> tick_;
  std::int64_t period_ns_ = 0;
  WcetResult result_;
};

}  // namespace

WcetResult measure_wcet(const RobotDescription& robot, const WcetSettings& settings,
                        const OnWcetProgress& on_progress) {
  const DriveProtocol& measured = drive_protocols().front();
  const DriveProtocol& spoken = protocol_of(robot.drive_settings());
  if (&spoken != &measured) {
    throw InputError({"robot " + robot.name, "drives.protocol", spoken.name, measured.name,
                      "the frames of a measured tick are offnominal's own: measure a copy of the "
                      "file without [drives]"});
  }
  return Campaign(robot, settings, on_progress).run();
}

}  // namespace offnominal::desk::wcet
