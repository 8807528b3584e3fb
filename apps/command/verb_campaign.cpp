#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "campaign/campaign_file.hpp"
#include "campaign/result_file.hpp"
#include "campaign/run_campaign.hpp"
#include "campaign/simulate.hpp"
#include "campaign/summary.hpp"
#include "campaign/summary_report.hpp"
#include "command/answer.hpp"
#include "command/command_line.hpp"
#include "command/input_options.hpp"
#include "command/progress.hpp"
#include "command/refuse_option.hpp"
#include "command/verbs.hpp"
#include "common/file.hpp"
#include "common/output_file.hpp"
#include "log/csv_text.hpp"
#include "report/page.hpp"
#include "robot/robot_file.hpp"

namespace offnominal::desk {
namespace {

// Results are gone on with: no NEW-FILE, whose name must be free.
constexpr const char* kResultsFile = "RESULTS";

struct CampaignOptions {
  std::string file;
  std::string output;
  std::string shard = "1/1";
  int threads = 1;
  AnswerOptions answer;
};

struct MergeOptions {
  std::vector<std::string> files;
  std::string output;
  AnswerOptions answer;
};

struct ShowOptions {
  std::string file;
  AnswerOptions answer;
};

void print(const campaign::Summary& summary, const AnswerOptions& answer,
           const std::string& command_line, std::vector<std::string> written = {}) {
  write_report(answer, [&] { return page_of(summary, command_line); });
  print_answer(
      answer, [&] { return to_json(summary); }, [&] { return text_of(summary); },
      std::move(written));
}

void require(const std::string& value, const char* option, const char* what) {
  if (value.empty()) {
    refuse_option("campaign", option, "nothing", what, "run `offnominal campaign --help`");
  }
}

void run(const CampaignOptions& options, const std::string& command_line) {
  require(options.file, "FILE", "a campaign file, or merge or show");
  require(options.output, "-o", "the file of results, there already or not");
  if (same_file(options.file, options.output)) {
    refuse_option("campaign", "-o", options.output + ", which is that of FILE",
                  "a file of its own");
  }
  const campaign::Shard shard = campaign::parse_shard(options.shard);
  const campaign::Campaign plan = campaign::read_campaign(options.file);
  Progress progress;
  const campaign::RunRequest request{options.output, shard, options.threads};
  const auto on_progress = [&](const std::string& what, std::int64_t done, std::int64_t of) {
    progress.begin(fmt::format("{}: {} of {}", what, done, of));
  };
  const campaign::RunOutcome outcome = run_campaign(plan, request, on_progress);
  progress.end();
  if (!options.answer.json && outcome.skipped > 0) {
    std::cerr << outcome.skipped << " of " << outcome.runs << " runs were there already\n";
  }
  print(summary_of(campaign::read_results(options.output)), options.answer, command_line,
        {options.output});
}

void merge(const MergeOptions& options, const std::string& command_line, ExitCode& exit_code) {
  const std::vector<std::filesystem::path> paths(options.files.begin(), options.files.end());
  const campaign::Results results = campaign::merged(paths);
  campaign::write_results(options.output, results, options.answer.existing());
  if (!results.missing.empty()) exit_code = ExitCode::kCheckFailed;
  print(summary_of(results), options.answer, command_line, {options.output});
}

void show(const ShowOptions& options, const std::string& command_line) {
  print(summary_of(campaign::read_results(options.file)), options.answer, command_line);
}

struct RecordOptions {
  std::string file;
  std::optional<std::int64_t> run;
  std::optional<int> calibration;
  std::string output;
  std::string model;
  AnswerOptions answer;
};

// One of the campaign's recordings, and the file of the model that its detectors have.
void record(const RecordOptions& options) {
  if (options.run.has_value() == options.calibration.has_value()) {
    refuse_option("campaign record", "--run, --calibration", options.run ? "both" : "neither",
                  "one of them");
  }
  const campaign::Campaign plan = campaign::read_campaign(options.file);
  const std::int64_t count = options.run ? plan.run_count() : plan.calibration.runs;
  const std::int64_t number = options.run.value_or(options.calibration.value_or(0));
  if (number < 0 || number >= count) {
    refuse_option("campaign record", options.run ? "--run" : "--calibration",
                  std::to_string(number), fmt::format("0 to {}", count - 1));
  }
  const campaign::Simulator simulator(plan);
  const Log log = options.run ? simulator.run(campaign::run_of(plan, number)).log
                              : simulator.calibration_run(static_cast<int>(number));
  std::vector<std::string> written{options.output};
  write_file_atomically(options.output, csv_text(log), options.answer.existing());
  if (!options.model.empty()) {
    write_robot_file(plan.model, options.model, options.answer.existing());
    written.push_back(options.model);
  }
  const auto json = [&] {
    return nlohmann::ordered_json{{"written", written},
                                  {options.run ? "run" : "calibration", number},
                                  {"samples", log.sample_count()},
                                  {"period_s", log.period_s}};
  };
  print_answer(
      options.answer, json, [] { return std::string(); }, written);
}

void set_up_record(CLI::App& verb) {
  CLI::App& sub = *verb.add_subcommand("record", "Write one run as a recording, to look into");
  const auto options = std::make_shared<RecordOptions>();
  sub.add_option("FILE", options->file, "Campaign file (docs/campaigns.md)")->required();
  sub.add_option("--run", options->run, "Number of a run, as the results have it, from 0");
  sub.add_option("--calibration", options->calibration,
                 "Number of a run that is calibrated on, from 0, instead");
  sub.add_option("-o,--output", options->output, "Recording to write, CSV")
      ->type_name(kNewFile)
      ->required();
  sub.add_option("--model", options->model,
                 "Robot file to write too: the model that the detectors have, without a bound")
      ->type_name(kNewRobotFile);
  add_force_option(sub, options->answer);
  add_json_option(sub, options->answer);
  sub.callback([&sub, options] {
    check_outputs(sub, report::is_page);
    record(*options);
  });
}

void set_up_merge(CLI::App& verb, ExitCode& exit_code) {
  CLI::App& sub = *verb.add_subcommand("merge", "Join results of one campaign's parts");
  const auto options = std::make_shared<MergeOptions>();
  sub.add_option("RESULTS", options->files, "Files of results of one campaign")->required();
  sub.add_option("-o,--output", options->output, "File of all results to write")
      ->type_name(kNewFile)
      ->required();
  add_report_option(sub, options->answer);
  add_force_option(sub, options->answer);
  add_json_option(sub, options->answer);
  sub.footer(
      "Files of another campaign, or calibrated otherwise, are refused. Exit code 1 where runs are "
      "missing: they are listed, and all that are there are written.");
  sub.callback([&sub, options, &exit_code] {
    check_outputs(sub, report::is_page);
    merge(*options, "offnominal " + command_line_of(sub), exit_code);
  });
}

void set_up_show(CLI::App& verb) {
  CLI::App& sub = *verb.add_subcommand("show", "Print what a file of results says");
  const auto options = std::make_shared<ShowOptions>();
  sub.add_option("RESULTS", options->file, "File of results")->required();
  add_page_options(sub, options->answer);
  add_json_option(sub, options->answer);
  sub.callback([&sub, options] {
    check_outputs(sub, report::is_page);
    show(*options, "offnominal " + command_line_of(sub));
  });
}

}  // namespace

void set_up_campaign(CLI::App& verb, ExitCode& exit_code) {
  const auto options = std::make_shared<CampaignOptions>();
  verb.add_option("FILE", options->file, "Campaign file (docs/campaigns.md)");
  verb.add_option("-o,--output", options->output,
                  "Results, an SQLite file; one of the same campaign is gone on with")
      ->type_name(kResultsFile);
  verb.add_option("--shard", options->shard, "Part i of n of all runs, as 3/8")
      ->capture_default_str();
  add_threads_option(verb, options->threads);
  add_page_options(verb, options->answer);
  add_json_option(verb, options->answer);
  set_up_merge(verb, exit_code);
  set_up_show(verb);
  set_up_record(verb);
  verb.require_subcommand(0, 1);
  verb.footer(
      "Simulates one robot without faults, calibrates every detector of FILE on that, then runs "
      "each fault of each size as often as FILE says and gives every recording to all detectors. "
      "A run follows from the campaign's seed and its number alone: any part may run anywhere, on "
      "any number of threads, and be interrupted.\n"
      "Faults:\n" +
      campaign::fault_kinds_text());
  verb.callback([&verb, options] {
    if (verb.get_subcommands().empty()) run(*options, command_line_of(verb));
  });
}

}  // namespace offnominal::desk
