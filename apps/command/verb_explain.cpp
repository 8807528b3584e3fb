#include <CLI/CLI.hpp>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "command/answer.hpp"
#include "command/command_line.hpp"
#include "command/doctor.hpp"
#include "command/input_options.hpp"
#include "command/progress.hpp"
#include "command/recordings.hpp"
#include "command/verbs.hpp"
#include "common/error.hpp"
#include "common/nearest.hpp"
#include "explain/explain_report.hpp"
#include "log/log_format.hpp"
#include "log/read_log.hpp"

namespace offnominal::desk {
namespace {

struct ExplainArguments {
  FitFiles files;
  std::vector<std::string> before;
  std::vector<std::string> after;
  ExplainOptions explain;
  AnswerOptions answer;
};

// The recordings of all options, those of --after last.
FitFiles files_of(const ExplainArguments& options) {
  FitFiles files = options.files;
  if (!options.before.empty()) {
    files.logs = options.before;
    files.logs.insert(files.logs.end(), options.after.begin(), options.after.end());
  }
  if (files.logs.empty()) {
    throw InputError({"explain", "LOG", "none", "one recording or more, or --before and --after",
                      "give the recordings"});
  }
  return files;
}

void run(const ExplainArguments& options, const std::string& command_line) {
  const FitFiles files = files_of(options);
  const bool between = !options.before.empty();
  Progress progress;
  FitData data = read_fit_data("explain", between ? "--before and --after" : "LOG", files,
                               read_log_or_hold_map, progress);
  ExplainOptions settings = options.explain;
  settings.after = options.before.size();
  settings.robot_file = files.robot;
  settings.reading = reading_words(files.channels);
  const Explanation explanation =
      explain(data.robot, std::move(data.logs), std::move(data.holdout), settings,
              [&](const std::string& doing) { progress.begin(doing); });
  progress.end();
  const ExplainNames names{files.logs,
                           files.holdout,
                           files.robot,
                           command_line,
                           files.channels.file ? files.channels.file->string() : "",
                           files.channels.payloads,
                           settings.keep,
                           settings.link_share,
                           settings.keep_effects,
                           options.after};
  write_report(options.answer, [&] { return page_of(explanation, names); });
  print_answer(
      options.answer, [&] { return to_json(explanation, names); },
      [&] { return text_of(explanation, names); });
}

// When the robot may have become another one, where that is known.
void set_up_known_changes(CLI::App& verb, CLI::Option* logs, ExplainArguments& options) {
  CLI::Option* holdout = verb.get_option("--holdout");
  CLI::Option* before =
      verb.add_option("--before", options.before,
                      "Instead of LOG: recordings of the robot as it was. With --after: what has "
                      "changed since: a payload, friction, an offset or a torque constant")
          ->excludes(logs)
          ->excludes(holdout);
  CLI::Option* after = verb.add_option("--after", options.after, "Recordings made after that");
  before->needs(after);
  after->needs(before);
  verb.add_option("--since", options.explain.since_s,
                  "What has changed since that time of the only LOG, s by its own time stamps. "
                  "Default: moments at which something changes are looked for")
      ->excludes(before);
}

}  // namespace

void set_up_explain(CLI::App& verb, ExitCode& /*exit_code*/) {
  const auto options = std::make_shared<ExplainArguments>();
  CLI::Option* logs =
      verb.add_option("LOG", options->files.logs, "Recordings, " + log_format_names());
  verb.add_option("--robot", options->files.robot, "Robot file")->required();
  verb.add_option("--holdout", options->files.holdout,
                  "Recordings that no fit may see. Without any, blocks of time are held out");
  set_up_known_changes(verb, logs, *options);
  add_channels_option(verb, options->files.channels, "recordings'");
  add_keep_option(verb, options->explain.keep);
  verb.add_option("--link-share", options->explain.link_share,
                  "How far mass and inertia of a link may be off the file, as a share; beyond 0.1 "
                  "its centre of mass, and torque constants by 5 %, too [0.05, or more where the "
                  "recordings ask for it]")
      ->check(CLI::Range(0.0, 1.0));
  verb.add_flag("--keep-effects", options->explain.keep_effects,
                "Take the numbers of the file's effects for right: fit none of them beside what is "
                "looked for");
  verb.add_option("--replays", options->explain.replays,
                  "How often each finding is checked against the model without it; 0: never")
      ->check(CLI::Range(0, 10000))
      ->capture_default_str();
  verb.add_option("--seed", options->explain.seed, "Seed of the bootstrap and of the replays")
      ->capture_default_str();
  add_threads_option(verb, options->explain.threads);
  add_page_options(verb, options->answer);
  add_json_option(verb, options->answer);
  verb.footer("Verdicts: " + list_of(verdict_names()) +
              ". A diagnostic aid: it does not replace a look at the recordings.");
  verb.callback([&verb, options] { run(*options, command_line_of(verb)); });
}

}  // namespace offnominal::desk
