#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "analysis/add_report.hpp"
#include "command/add_all_found.hpp"
#include "command/command_line.hpp"
#include "command/doctor.hpp"
#include "command/filter_options.hpp"
#include "command/progress.hpp"
#include "command/recordings.hpp"
#include "command/refuse_option.hpp"
#include "command/verbs.hpp"
#include "common/nearest.hpp"
#include "common/output_file.hpp"
#include "discovery/data_fault_report.hpp"
#include "log/log_format.hpp"
#include "report/page.hpp"
#include "robot/robot_file.hpp"

namespace offnominal::tools {
namespace {

struct AddOptions {
  std::vector<std::string> effects;
  int joint = 0;
  std::string robot;
  std::vector<std::string> logs;
  std::vector<std::string> holdout;
  bool all_found = false;
  std::optional<std::filesystem::path> channels;
  std::string output;
  std::vector<std::string> set;
  std::optional<double> refit_inertia_percent;
  bool keep = false;
  bool force = false;
  FilterRequest filter;
  std::optional<double> link_share;
  int threads = 1;
  std::optional<std::string> report;
  bool json = false;
};

EffectKind kind_of(const std::string& name) {
  std::vector<std::string> names;
  for (const EffectInfo& info : kAllEffectInfos) {
    if (name == info.name) return info.kind;
    names.emplace_back(info.name);
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
  if (options.joint < 1)
    refuse_option("add", "--joint", std::to_string(options.joint), "a number from 1");
  request.joint = static_cast<std::size_t>(options.joint - 1);
  for (const std::string& setting : options.set) read_setting(setting, request);
  if (options.refit_inertia_percent) {
    const double percent = *options.refit_inertia_percent;
    if (!(percent > 0 && percent <= 100)) {
      refuse_option("add", "--refit-inertia", fmt::format("{:g}", percent), "above 0, up to 100 %");
    }
    request.inertia_deviation = percent / 100;
  }
  request.keep = options.keep;
  request.source = "Fitted to " + file_names({options.logs[0]}) + " by offnominal add.";
  return request;
}

// One effect by name: what only a search takes is not for it, and the other way round.
void check_kind(const AddOptions& options) {
  if (!options.all_found) {
    if (options.effects.empty()) {
      refuse_option("add", "EFFECT", "none", "one or more effects, or --all-found",
                    "name an effect, or let --all-found search for what is missing");
    }
    if (options.logs.size() != 1)
      refuse_option("add", "--log", "several", "one, unless with --all-found");
    if (options.holdout.size() > 1)
      refuse_option("add", "--holdout", "several", "one, unless with --all-found");
    if (options.link_share) refuse_option("add", "--link-share", "given", "only with --all-found");
    return;
  }
  const std::string alone = "nothing of it with --all-found";
  if (!options.effects.empty())
    refuse_option("add", "EFFECT", "\"" + options.effects[0] + "\"", alone);
  if (options.joint != 0) refuse_option("add", "--joint", std::to_string(options.joint), alone);
  if (!options.set.empty()) refuse_option("add", "--set", "\"" + options.set[0] + "\"", alone);
  if (options.keep) refuse_option("add", "--keep", "given", alone);
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
  const std::string& log_file = options.logs[0];
  std::optional<std::string> holdout_file;
  if (!options.holdout.empty()) holdout_file = options.holdout[0];
  Progress progress;
  const RobotDescription robot = read_robot_file(options.robot);
  std::vector<Log> logs = read_recordings(options.logs, robot, options.channels, progress);
  std::vector<Log> held_out = read_recordings(options.holdout, robot, options.channels, progress);
  check_recordings_differ("add", "--log", logs, held_out);
  progress.begin("examining the recordings");
  const std::vector<discovery::DataFault> faults = examine_all({logs, held_out}, robot);
  refuse_spoilt(faults, discovery::RestsOn::kTorque);
  progress.end();
  print_hints(faults);
  const Measurement log = measure(std::move(logs[0]), options.filter);
  std::optional<Measurement> holdout;
  if (holdout_file) holdout = measure(std::move(held_out[0]), options.filter);
  progress.begin("fitting");
  const AddResult result =
      add(robot, request, log, holdout ? &*holdout : nullptr, [&progress] { progress.step(); });
  progress.end();
  const AddNames names{log_file,       holdout_file, options.robot,
                       options.output, command_line, options.force};
  const bool write = result.may_be_written(options.force);
  if (options.report) {
    report::Page page = page_of(result, request, names);
    add_faults(faults, page);
    report::write_page(*options.report, page, existing_if(options.force));
  }
  if (write) {
    write_robot_file(result.robot, options.output, existing_if(options.force));
  } else {
    exit_code = ExitCode::kCheckFailed;
  }
  if (options.json) {
    auto json = to_json(result, request, names);
    json["data_faults"] = discovery::to_json(faults);
    std::cout << json.dump(2) << '\n';
    return;
  }
  std::cout << text_of(result, request, names);
  if (write) std::cout << "written: " << options.output << '\n';
  if (options.report) std::cout << "written: " << *options.report << '\n';
}

void run(const AddOptions& options, const std::string& command_line, ExitCode& exit_code) {
  check_kind(options);
  check_recordings_differ("add", "--log", options.logs, options.holdout);
  if (!options.all_found) {
    add_named(options, command_line, exit_code);
    return;
  }
  add_all_found({options.logs, options.holdout, options.robot, options.channels, options.output,
                 options.force, options.link_share, options.threads, options.report, options.json},
                command_line, exit_code);
}

std::string effects_text() {
  std::string text = "Effects, their formulas and parameters:\n";
  for (const EffectInfo& info : kAllEffectInfos) {
    text += fmt::format("  {:<22} {}\n", info.name, info.formula);
    for (const ParameterInfo& parameter : info.parameters) {
      text +=
          fmt::format("  {:<22}   {}{}: {}\n", "", parameter.name,
                      parameter.role == ParameterRole::kShape ? " (shape)" : "", parameter.meaning);
    }
  }
  return text;
}

constexpr const char* kHowItFits =
    "The new effects are fitted together with those effects of the robot file that are marked "
    "`fitted = true` and act on the same joints, because what was missing had biased them; --keep "
    "leaves them alone. Masses and inertias stay as they are unless --refit-inertia gives their "
    "uncertainty. Shape parameters that --set does not give are searched for; the widths of the "
    "smoothed sign of one joint have one common value.\n"
    "The error is judged on data that the fit has not seen: --holdout, or else every fifth of the "
    "recording predicted by a fit of the others.\n"
    "--all-found fits all that explain finds, together with the effects marked `fitted = true` and "
    "with mass and inertia of the links within --link-share. It writes nothing unless the verdict "
    "is "
    "found or parameter_shift.\n"
    "Exit code 1, and nothing written, when the recording cannot tell an effect from what the "
    "model has already, or when the fit is not physical; so too when the error on data that the "
    "fit has not seen does not fall, which --force overrules.\n\n";

}  // namespace

void register_add(CLI::App& app, ExitCode& exit_code) {
  CLI::App* verb = app.add_subcommand(
      "add", "Fit an effect to a recording and write the robot file that has it");
  const auto options = std::make_shared<AddOptions>();
  options->threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  verb->add_option("EFFECT", options->effects,
                   "One or more effects, all on one joint; listed below");
  verb->add_option("--joint", options->joint, "The joint that they act on, from 1");
  verb->add_flag("--all-found", options->all_found,
                 "Search for what is missing, as explain does, and add all of it");
  verb->add_option("--robot", options->robot, "Robot file to start from")->required();
  verb->add_option("--log", options->logs,
                   "Recording to fit, " + log_format_names() + "; with --all-found one or more")
      ->required();
  verb->add_option("--holdout", options->holdout,
                   "Recording to judge the fit on; with --all-found one or more");
  verb->add_option("-o,--output", options->output, "Robot file to write")
      ->type_name(kNewRobotFile)
      ->required();
  verb->add_flag("--force", options->force,
                 "Replace files that are there, for -o be it the robot file that is read, and "
                 "write it even where the error on data not used for the fit does not fall");
  verb->add_option("--set", options->set,
                   "NAME=VALUE or EFFECT.NAME=VALUE: a parameter of the new effects that is given, "
                   "not fitted; SI units")
      ->take_all()
      ->allow_extra_args(false);
  verb->add_flag("--keep", options->keep, "Leave effects that were fitted before as they are");
  verb->add_option("--refit-inertia", options->refit_inertia_percent,
                   "Fit mass and inertia of every link as well, believed to be right to within so "
                   "many percent (one standard deviation)");
  verb->add_option("--channels", options->channels,
                   "TOML file that maps the recordings' columns, instead of the robot file's "
                   "[channels]");
  add_filter_options(*verb, options->filter);
  verb->add_option("--link-share", options->link_share,
                   "With --all-found: how far mass and inertia of a link may be off the file, as a "
                   "share [0.05]")
      ->check(CLI::Range(0.0, 1.0));
  verb->add_option("--threads", options->threads,
                   "With --all-found: threads; the result does not depend on their number")
      ->check(CLI::Range(1, 256));
  verb->add_option("--report", options->report, "Write the pictures as an HTML page")
      ->type_name(kNewPage);
  verb->add_flag("--json", options->json, "Print one JSON object and nothing else");
  verb->footer(kHowItFits + effects_text());
  verb->callback([verb, options, &exit_code] { run(*options, command_line_of(*verb), exit_code); });
}

}  // namespace offnominal::tools
