#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
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
#include "command/refuse_option.hpp"
#include "command/verbs.hpp"
#include "command/write_robot.hpp"
#include "common/nearest.hpp"
#include "common/output_file.hpp"
#include "common/text_table.hpp"
#include "explain/add_found.hpp"
#include "identify/add_report.hpp"
#include "log/log_format.hpp"
#include "log/read_log.hpp"
#include "robot/read_effect.hpp"
#include "robot/robot_file.hpp"

namespace offnominal::desk {
namespace {

struct AddOptions {
  std::vector<std::string> effects;
  int joint = 0;
  int motor = 0;
  FitFiles files;
  bool all_found = false;
  std::string output;
  std::vector<std::string> set;
  std::optional<double> refit_inertia_percent;
  bool keep_effects = false;
  std::vector<KeepFault> keep;
  bool no_skew = false;
  FilterRequest filter;
  std::optional<double> link_share;
  int threads = 1;
  AnswerOptions answer;
};

EffectKind kind_of(const std::string& name) {
  std::vector<std::string> names;
  for (const EffectInfo* info : file_effects()) {
    if (name == info->name) return info->kind;
    names.emplace_back(info->name);
  }
  const std::string meant = nearest(name, names);
  refuse_option("add", "EFFECT", "\"" + name + "\"", list_of(names),
                meant.empty() ? "" : "write " + meant);
}

// "name=value"
void read_setting(const std::string& text, AddRequest& request) {
  const auto equals = text.find('=');
  double value = 0;
  const bool good = equals != std::string::npos && equals > 0 &&
                    CLI::detail::lexical_cast(text.substr(equals + 1), value) &&
                    std::isfinite(value);
  if (!good)
    refuse_option("add", "--set", "\"" + text + "\"", "NAME=NUMBER, such as smoothing=0.001");
  if (!request.set.emplace(text.substr(0, equals), value).second) {
    refuse_option("add", "--set", "\"" + text.substr(0, equals) + "\" twice", "one value per name");
  }
}

AddRequest request_of(const AddOptions& options) {
  AddRequest request;
  for (const std::string& name : options.effects) request.effects.push_back(kind_of(name));
  request.of_motor = options.motor != 0;
  if (request.of_motor && options.joint != 0)
    refuse_option("add", "--motor", "a motor beside --joint", "one of the two");
  const int place = request.of_motor ? options.motor : options.joint;
  if (place < 1)
    refuse_option("add", request.of_motor ? "--motor" : "--joint",
                  place == 0 ? "none" : std::to_string(place),
                  "the joint that the effects act on, from 1",
                  "write --joint N, or --motor N for the shaft of a motor");
  request.joint = static_cast<std::size_t>(place - 1);
  for (const std::string& setting : options.set) read_setting(setting, request);
  if (options.refit_inertia_percent) {
    const double percent = *options.refit_inertia_percent;
    if (!(percent > 0 && percent <= 100)) {
      refuse_option("add", "--refit-inertia", fmt::format("{:g}", percent), "above 0, up to 100 %");
    }
    request.inertia_deviation = percent / 100;
  }
  request.keep = options.keep_effects;
  request.fit_skew = !options.no_skew;
  request.source = "Fitted to " + file_names(options.files.logs) + " by offnominal add.";
  return request;
}

// One effect by name: what only a search takes is not for it, and the other way round.
void check_kind(const AddOptions& options) {
  if (!options.all_found) {
    if (options.effects.empty()) {
      refuse_option("add", "EFFECT", "none", "one or more effects, or --all-found",
                    "name an effect, or let --all-found search for what is missing");
    }
    if (options.link_share) refuse_option("add", "--link-share", "given", "only with --all-found");
    return;
  }
  const std::string alone = "nothing of it with --all-found";
  if (!options.effects.empty())
    refuse_option("add", "EFFECT", "\"" + options.effects[0] + "\"", alone);
  if (options.joint != 0) refuse_option("add", "--joint", std::to_string(options.joint), alone);
  if (options.motor != 0) refuse_option("add", "--motor", std::to_string(options.motor), alone);
  if (!options.set.empty()) refuse_option("add", "--set", "\"" + options.set[0] + "\"", alone);
  if (options.no_skew) refuse_option("add", "--no-skew", "given", alone);
  if (options.refit_inertia_percent) {
    refuse_option("add", "--refit-inertia", "given", alone, "say --link-share, as for explain");
  }
  if (options.filter.cutoff_hz || options.filter.decimate) {
    refuse_option("add", "--cutoff or --decimate", "given", alone,
                  "the search chooses its filter by the encoders");
  }
}

void add_named(const AddOptions& options, const std::string& command_line, ExitCode& exit_code) {
  const AddRequest request = request_of(options);
  Progress progress;
  FitData data = read_fit_data("add", "--log", options.files, read_log, progress);
  const auto faults =
      treated({data.logs, data.holdout}, data.robot, options.keep, progress, RestsOn::kTorque);
  const AddResult result = add(data.robot, request, data.logs, data.holdout, options.filter,
                               [&](const std::string& doing) { progress.begin(doing); });
  progress.end();
  const AddNames names{options.files.logs, options.files.holdout, options.files.robot,
                       options.output,     command_line,          options.answer.force};
  write_report(options.answer,
               [&] { return with_faults(page_of(result, request, names), faults); });
  std::vector<std::string> written;
  if (result.may_be_written(options.answer.force)) {
    write_robot(result.robot, options.files.robot, options.output, options.answer);
    written.push_back(options.output);
  } else {
    exit_code = ExitCode::kCheckFailed;
  }
  print_answer(
      options.answer, [&] { return with_faults(to_json(result, request, names), faults); },
      [&] { return text_of(result, request, names); }, written);
}

// Searches, writes the robot file with everything that was found, prints the error before and
// after. Nothing is written where nothing may be added.
void add_all_found(const AddOptions& options, const std::string& command_line,
                   ExitCode& exit_code) {
  const FitFiles& files = options.files;
  const bool force = options.answer.force;
  Progress progress;
  FitData data = read_fit_data("add", "--log", files, read_log_or_hold_map, progress);
  ExplainOptions explain;
  explain.threads = options.threads;
  explain.keep_effects = options.keep_effects;
  explain.link_share = options.link_share;
  explain.robot_file = files.robot;
  explain.keep = options.keep;
  explain.source = "Fitted to " + file_names(files.logs) + " by offnominal add --all-found.";
  const AddedFindings added =
      add_found(data.robot, std::move(data.logs), std::move(data.holdout), explain,
                [&](const std::string& doing) { progress.begin(doing); });
  progress.end();
  const ExplainNames names{files.logs,
                           files.holdout,
                           files.robot,
                           command_line,
                           files.channels.file ? files.channels.file->string() : "",
                           files.channels.payloads,
                           explain.keep,
                           explain.link_share,
                           explain.keep_effects};
  write_report(options.answer, [&] { return page_of(added.explanation, names); });
  std::vector<std::string> written;
  if (added.may_be_written(force)) {
    write_robot(added.explanation.improved, files.robot, options.output, options.answer);
    written.push_back(options.output);
  } else {
    exit_code = ExitCode::kCheckFailed;
  }
  print_answer(
      options.answer, [&] { return to_json(added, names, options.output, force); },
      [&] { return text_of(added, names, force); }, written);
}

void run(const AddOptions& options, const std::string& command_line, ExitCode& exit_code) {
  check_kind(options);
  const auto add = options.all_found ? add_all_found : add_named;
  add(options, command_line, exit_code);
}

std::string effects_text() {
  const TextTable table({{"", -22}, {"", 0}}, "  ");
  std::string text = "Effects, their formulas and parameters:\n";
  for (const EffectInfo* info : file_effects()) {
    text += table.row(info->name, info->formula);
    for (const ParameterInfo& parameter : info->parameters) {
      text += table.row("", fmt::format("  {}{}: {}", parameter.name,
                                        parameter.role == ParameterRole::kShape ? " (shape)" : "",
                                        parameter.meaning));
    }
  }
  return text;
}

constexpr const char* kHowItFits =
    "The new effects are fitted together with those effects of the robot file that are marked "
    "`fitted = true` and act on the same joints, because what was missing had biased them; "
    "--keep-effects "
    "leaves them alone. Masses and inertias stay as they are unless --refit-inertia gives their "
    "uncertainty. Shape parameters that --set does not give are searched for; the widths of the "
    "smoothed sign of one joint have one common value.\n"
    "The error is judged on data that the fit has not seen: --holdout, or else every fifth of the "
    "recordings predicted by a fit of the others.\n"
    "--all-found fits all that explain finds, together with the effects marked `fitted = true`, "
    "those whose numbers the recordings contradict, and mass and inertia of the links within "
    "--link-share; --keep-effects takes the numbers of all effects of the file for right, and fits "
    "what is found beside them. It writes nothing unless something is sure: an effect that the "
    "recordings do not confuse with another one, or a number of the file that they contradict.\n"
    "Exit code 1, and nothing written, when the recording cannot tell an effect from what the "
    "model has already, or when the fit is not physical; so too when the error on data that the "
    "fit has not seen does not fall, which --force overrules.\n\n";

}  // namespace

void set_up_add(CLI::App& verb, ExitCode& exit_code) {
  const auto options = std::make_shared<AddOptions>();
  verb.add_option("EFFECT", options->effects,
                  "One or more effects, all on one joint; listed below");
  verb.add_option("--joint", options->joint, "The joint that they act on, from 1");
  verb.add_option("--motor", options->motor,
                  "Instead: the motor on whose shaft they act, of a robot with [transmission]");
  verb.add_flag("--all-found", options->all_found,
                "Search for what is missing, as explain does, and add all of it");
  verb.add_option("--robot", options->files.robot, "Robot file to start from")->required();
  verb.add_option("--log", options->files.logs,
                  "One recording to fit or several, " + log_format_names())
      ->required();
  verb.add_option("--holdout", options->files.holdout,
                  "Recordings to judge the fit on: no fit sees them");
  verb.add_option("-o,--output", options->output, "Robot file to write")
      ->type_name(kNewRobotFile)
      ->required();
  add_force_option(verb, options->answer,
                   "Replace files that are there, for -o be it the robot file that is read, and "
                   "write it even where the error on data not used for the fit does not fall");
  verb.add_option("--set", options->set,
                  "NAME=VALUE or EFFECT.NAME=VALUE: a parameter of the new effects that is given, "
                  "not fitted; SI units. Once for each")
      ->type_name("NAME=VALUE")
      ->expected(1)
      ->take_all()
      ->allow_extra_args(false);
  verb.add_flag("--keep-effects", options->keep_effects,
                "Leave effects that were fitted before as they are; with --all-found, all of the "
                "file's");
  add_keep_option(verb, options->keep);
  verb.add_flag("--no-skew", options->no_skew,
                "Torque and position are of one time: fit no skew between them beside the effects. "
                "For a model whose bound is calibrated on recordings of the same drives");
  verb.add_option("--refit-inertia", options->refit_inertia_percent,
                  "Fit mass and inertia of every link as well, believed to be right to within so "
                  "many percent (one standard deviation)");
  add_channels_option(verb, options->files.channels, "recordings'");
  add_filter_options(verb, options->filter);
  verb.add_option("--link-share", options->link_share,
                  "With --all-found: how far mass and inertia of a link may be off the file, as a "
                  "share [0.05, or more where the recordings ask for it]")
      ->check(CLI::Range(0.0, 1.0));
  add_threads_option(verb, options->threads, "With --all-found: threads");
  add_report_option(verb, options->answer);
  add_json_option(verb, options->answer);
  verb.footer(kHowItFits + effects_text());
  verb.callback([&verb, options, &exit_code] { run(*options, command_line_of(verb), exit_code); });
}

}  // namespace offnominal::desk
