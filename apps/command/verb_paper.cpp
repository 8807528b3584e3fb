#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdint>
#include <iostream>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "command/answer.hpp"
#include "command/command_line.hpp"
#include "command/progress.hpp"
#include "command/refuse_option.hpp"
#include "command/verbs.hpp"
#include "common/file.hpp"
#include "common/output_file.hpp"
#include "common/text_table.hpp"
#include "log/csv_text.hpp"
#include "paper/figures.hpp"
#include "paper/paper_json.hpp"
#include "paper/paper_runs.hpp"
#include "paper/recording.hpp"
#include "paper/sweep_pair.hpp"
#include "paper/two_link_robot.hpp"
#include "robot/robot_file.hpp"

namespace offnominal::desk {
namespace {

using paper::Experiment;
using paper::ExperimentResult;

struct PaperOptions {
  std::optional<std::string> fault;
  std::optional<double> mass_loss;
  std::optional<double> rho;
  bool accommodate = false;
  std::string scalar = "float";
  std::optional<std::string> dead_zone;
  std::optional<int> hidden;
  std::optional<double> step;
  std::optional<std::uint32_t> seed;
  std::optional<std::string> robot;
  std::optional<std::string> against;
  std::optional<double> duration;
  std::optional<double> start;
  std::optional<std::string> motion;
  std::optional<std::string> log;
  bool sweep = false;
  AnswerOptions answer;
  std::string command_line;
};

// A number in a range, NaN excluded, told in the same words for every option.
CLI::Validator number_where(bool (*allowed)(double), const std::string& words) {
  return CLI::Validator(
      [allowed, words](const std::string& text) -> std::string {
        double value = 0.0;
        const bool good = CLI::detail::lexical_cast(text, value) && allowed(value);
        return good ? "" : "found " + text + "; allowed: " + words;
      },
      words);
}

// An option that would be ignored is a misunderstanding.
void check_together(const PaperOptions& options) {
  if (options.sweep) {
    if (options.fault && *options.fault != "mass_loss") {
      refuse_option("paper", "--sweep", "--fault " + *options.fault, "",
                    "leave --fault out; the sweep loses mass");
    }
    if (options.mass_loss)
      refuse_option("paper", "--sweep", "--mass-loss", "", "leave it out; the sweep tries all");
    if (options.accommodate) {
      refuse_option("paper", "--sweep", "--accommodate", "",
                    "leave it out; nothing is compensated before detection");
    }
    if (options.answer.report && !options.against) {
      refuse_option(
          "paper", "--sweep", "--report", "",
          "run `offnominal paper --report FILE`, which holds the sweep, or add --against");
    }
  }
  if (options.log && !options.fault) {
    refuse_option("paper", "--log", "no --fault", "",
                  "add --fault none for a recording of the healthy arm");
  }
  if (options.motion && !options.fault) {
    refuse_option("paper", "--motion", "no --fault", "",
                  "add --fault none to see the healthy arm on this motion");
  }
  if (options.against && !options.sweep)
    refuse_option("paper", "--against", "no --sweep", "", "add --sweep");
  if (options.answer.force && !options.log && !options.answer.report)
    refuse_option("paper", "--force", "no --log or --report", "", "leave it out");
  if (options.mass_loss && options.fault && *options.fault != "mass_loss") {
    refuse_option("paper", "--mass-loss", "--fault " + *options.fault, "",
                  "leave one of the two out");
  }
  if (options.rho && options.fault && *options.fault == "none") {
    refuse_option("paper", "--rho", "--fault none", "", "leave one of the two out");
  }
}

RobotDescription robot_of(const PaperOptions& options, const std::optional<std::string>& file) {
  RobotDescription robot = file ? read_robot_file(*file) : paper::two_link_robot();
  if (file) {
    require_bound(robot, *file);
    paper::require_acceleration_space(robot, *file);
  }
  EstimatorSettings& estimator = robot.estimator;
  if (options.dead_zone) {
    estimator.dead_zone =
        *options.dead_zone == "continuous" ? DeadZone::kContinuous : DeadZone::kDiscontinuous;
  }
  if (options.hidden) estimator.hidden_units = *options.hidden;
  if (options.step) estimator.period_s = *options.step;
  if (options.seed) estimator.seed = *options.seed;
  return robot;
}

Experiment experiment_of(const PaperOptions& options) {
  Experiment experiment;
  const std::string fault = options.fault.value_or(options.sweep ? "mass_loss" : "none");
  experiment.fault.kind = fault == "mass_loss"   ? sim::FaultKind::kMassLoss
                          : fault == "nonlinear" ? sim::FaultKind::kNonlinear
                                                 : sim::FaultKind::kNone;
  if (options.mass_loss) experiment.fault.mass_loss = *options.mass_loss;
  if (options.rho) experiment.fault.rate_per_s = *options.rho;
  experiment.accommodate = options.accommodate;
  experiment.precision = precision_of(options.scalar);
  if (options.duration) experiment.duration_s = *options.duration;
  if (options.start) experiment.motion_start_s = *options.start;
  if (options.motion) {
    experiment.motion =
        std::make_shared<paper::RecordedMotion>(paper::RecordedMotion::read(*options.motion));
    if (!options.duration) experiment.duration_s = experiment.motion->duration_s();
  }
  experiment.record = options.answer.report.has_value() || options.log.has_value();
  return experiment;
}

std::string or_none(const std::optional<double>& value, const char* format) {
  return value ? fmt::format(fmt::runtime(format), *value) : "none";
}

std::string text_of(const ExperimentResult& run) {
  const TextTable table({{"", -38}, {"", 0}}, "  ");
  const std::string heading = fmt::format(
      "fault {}{}, {}, seed {}, {} steps\n", paper::name_of(run.fault),
      run.accommodate ? ", accommodated" : "", name_of(run.precision), run.seed, run.steps);
  return heading + table.row("fault begins", or_none(run.fault_time_s, "{:g} s")) +
         table.row("detected", or_none(run.detection_time_s, "{:.3f} s")) +
         table.row("certain to be detected (Theorem 4.2)",
                   or_none(run.guaranteed_time_s, "{:.3f} s")) +
         table.row("before the fault: largest |e| / mu",
                   fmt::format("{:.4f}", run.max_error_to_threshold_before_fault)) +
         table.row("before the fault: largest |psi_hat|",
                   fmt::format("{:g} rad/s^2", run.max_abs_psi_hat_before_fault)) +
         table.row("tracking error, last quarter",
                   fmt::format("{:.4f} rad rms", run.tracking_rms_rad)) +
         table.row(
             "error of the fault estimate",
             run.fault_estimate_relative_error
                 ? fmt::format("{:.1f} % of the fault", 100.0 * *run.fault_estimate_relative_error)
                 : "none") +
         table.row("largest |theta|", fmt::format("{:.3f}", run.max_weight_norm)) +
         paper::words_of(run) + "\n";
}

std::string text_of(const std::vector<paper::Comparison>& lines, const std::string& verdict) {
  const TextTable table({{"what", -46}, {"paper", -21}, {"here", -32}, {"agrees", 0}});
  std::string text = table.heading();
  for (const paper::Comparison& line : lines) {
    const char* agrees = !line.agrees ? "" : *line.agrees ? "yes" : "no";
    text += table.row(line.what, line.paper, line.here, agrees);
  }
  return text + verdict + "\n";
}

void run_sweep(const RobotDescription& robot, const Experiment& base, bool json) {
  Progress progress;
  const auto on_probe = [&](const paper::SweepProbe& probe) {
    const std::string words = fmt::format(
        "mass loss {:5.1f} %  {}", 100.0 * probe.mass_loss,
        probe.detection_time_s ? fmt::format("detected at {:.3f} s", *probe.detection_time_s)
                               : std::string("not detected"));
    if (json) {
      progress.begin(words);
    } else {
      std::cout << words << '\n';
    }
  };
  const paper::SweepResult sweep = paper::sweep_mass_loss(robot, base, 0.005, on_probe);
  if (json) {
    std::cout << json_text(paper::to_json(sweep));
    return;
  }
  const auto percent = [](const std::optional<double>& share) {
    return share ? fmt::format("{:.1f} %", 100.0 * *share) : std::string("none");
  };
  if (sweep.false_alarm_s) {
    std::cout << fmt::format("false alarm at {:.3f} s, before the fault\n", *sweep.false_alarm_s);
  }
  std::cout << "smallest mass loss that is detected: " << percent(sweep.smallest_detected)
            << " (paper: 10 %)\nlargest that is not: " << percent(sweep.largest_undetected) << '\n';
}

void run_pair(const RobotDescription& robot, const RobotDescription& other, const Experiment& base,
              const PaperOptions& options) {
  Progress progress;
  const auto on_probe = [&](const paper::SweepProbe& probe) {
    progress.begin(fmt::format("mass loss {:.1f} %", 100.0 * probe.mass_loss));
  };
  const paper::SweepPair pair{*options.against,
                              paper::sweep_mass_loss(other, base, 0.005, on_probe),
                              options.robot.value_or("the paper's arm"),
                              paper::sweep_mass_loss(robot, base, 0.005, on_probe)};
  progress.end();
  write_report(options.answer, [&] { return paper::page_of(pair, options.command_line); });
  print_answer(
      options.answer, [&] { return paper::to_json(pair); },
      [&] { return paper::words_of(pair) + "\n"; });
}

void run_one(const RobotDescription& robot, const Experiment& experiment,
             const PaperOptions& options) {
  const ExperimentResult run = paper::run_experiment(robot, experiment);
  std::vector<std::string> written;
  if (options.log) {
    write_file_atomically(*options.log, csv_text(paper::recording_of(robot, experiment, run)),
                          options.answer.existing());
    written.push_back(*options.log);
  }
  write_report(options.answer, [&] { return paper::page_of(run, options.command_line); });
  print_answer(
      options.answer, [&] { return paper::to_json(run); }, [&] { return text_of(run); }, written);
}

void run_all(const RobotDescription& robot, const Experiment& experiment,
             const PaperOptions& options) {
  paper::PaperRuns runs;
  {
    Progress progress;
    runs = paper::run_everything(robot, experiment,
                                 [&](const std::string& part) { progress.begin(part); });
  }
  const auto lines = paper::compare_with_paper(runs);
  const bool paper_settings = !options.mass_loss && !options.rho && !options.dead_zone &&
                              !options.hidden && !options.step && !options.robot &&
                              !options.duration && !options.start;
  const std::string verdict = paper::verdict_of(lines, paper_settings);
  write_report(options.answer,
               [&] { return paper::page_of(runs, lines, verdict, options.command_line); });
  print_answer(
      options.answer, [&] { return paper::to_json(runs, lines, verdict); },
      [&] { return text_of(lines, verdict); });
}

void run(const PaperOptions& options) {
  check_together(options);
  const RobotDescription robot = robot_of(options, options.robot);
  const Experiment experiment = experiment_of(options);
  if (options.against) {
    run_pair(robot, robot_of(options, options.against), experiment, options);
  } else if (options.sweep) {
    run_sweep(robot, experiment, options.answer.json);
  } else if (options.fault) {
    run_one(robot, experiment, options);
  } else {
    run_all(robot, experiment, options);
  }
}

void add_options(CLI::App& verb, PaperOptions& options) {
  verb.add_option("--fault", options.fault, "Run one fault; without it, everything")
      ->check(CLI::IsMember({"none", "mass_loss", "nonlinear"}));
  verb.add_option("--mass-loss", options.mass_loss,
                  "Share of mass 1 that is lost in the end, default 0.75")
      ->check(number_where([](double x) { return x >= 0.0 && x < 1.0; }, "0 to below 1"));
  verb.add_option("--rho", options.rho,
                  "How fast the fault evolves, 1/s, default 0.5; inf for an abrupt one")
      ->check(number_where([](double x) { return x > 0.0; }, "above 0, or inf"));
  verb.add_flag("--accommodate", options.accommodate, "Add the compensating torque, eq. (31)");
  verb.add_option("--scalar", options.scalar, "Arithmetic of monitor and controller")
      ->check(CLI::IsMember({"float", "double"}))
      ->capture_default_str();
  verb.add_option("--dead-zone", options.dead_zone, "Dead-zone of the learning law")
      ->check(CLI::IsMember({"continuous", "discontinuous"}));
  verb.add_option("--hidden", options.hidden, "Hidden units of the network, default 35")
      ->check(number_where(
          [](double x) { return x >= 1 && x <= kMaxHiddenUnits && x == std::floor(x); },
          "a whole number from 1 to " + std::to_string(kMaxHiddenUnits)));
  verb.add_option("--step", options.step, "Length of a control tick, s, default 0.001")
      ->check(
          number_where([](double x) { return x >= paper::kMinPeriod && x <= paper::kMaxPeriod; },
                       fmt::format("{:g} to {:g} s", paper::kMinPeriod, paper::kMaxPeriod)));
  verb.add_option("--seed", options.seed, "Seed of the network's first layer, default 1")
      ->check(number_where(
          [](double x) {
            return x >= 0 && x <= std::numeric_limits<std::uint32_t>::max() && x == std::floor(x);
          },
          "a whole number from 0 to 4294967295"));
  verb.add_option(
      "--robot", options.robot,
      "Robot file of the controller and the monitor; default: the paper's two-link arm");
  verb.add_option("--duration", options.duration, "Length of a run, s, default 20")
      ->check(number_where([](double x) { return x >= 1 && x <= 1e5; }, "1 to 1e5 s"));
  verb.add_option("--start", options.start,
                  "Time on the desired motion at which a run starts, s, default 0: other motion "
                  "under the same disturbance")
      ->check(number_where([](double x) { return x >= 0 && x <= 1e5; }, "0 to 1e5 s"));
  verb.add_option("--motion", options.motion,
                  "With --fault: a desired motion in place of the paper's, CSV as `offnominal "
                  "motion` writes it; the run is as long as it, unless --duration is given");
  verb.add_option(
          "--log", options.log,
          "With --fault: write the run as a recording, CSV: t, q, dq and the torque applied "
          "over the tick that ends there")
      ->type_name(kNewFile);
  add_force_option(verb, options.answer);
  verb.add_flag("--sweep", options.sweep, "Find the smallest mass loss that is detected");
  verb.add_option("--against", options.against,
                  "With --sweep: another robot file, whose smallest mass loss stands beside it");
  add_report_option(verb, options.answer, "figures");
  add_json_option(verb, options.answer);
}

}  // namespace

void set_up_paper(CLI::App& verb, ExitCode& /*exit_code*/) {
  const auto options = std::make_shared<PaperOptions>();
  add_options(verb, *options);
  verb.callback([&verb, options] {
    options->command_line = command_line_of(verb);
    run(*options);
  });
}

}  // namespace offnominal::desk
