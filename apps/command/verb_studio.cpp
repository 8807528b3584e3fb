#include <fcntl.h>
#include <malloc.h>
#include <pthread.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <array>
#include <atomic>
#include <csignal>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "command/doctor.hpp"
#include "command/input_options.hpp"
#include "command/plant_options.hpp"
#include "command/progress.hpp"
#include "command/recordings.hpp"
#include "command/refuse_option.hpp"
#include "command/verbs.hpp"
#include "common/input_name.hpp"
#include "common/json_text.hpp"
#include "common/output_file.hpp"
#include "common/shell_word.hpp"
#include "live/live.hpp"
#include "log/log_format.hpp"
#include "log/read_log.hpp"
#include "log/seen_by_sensor.hpp"
#include "robot/robot_file.hpp"
#include "sil/scenario_file.hpp"
#include "studio/benchmark_view.hpp"
#include "studio/campaign_view.hpp"
#include "studio/server.hpp"

namespace offnominal::desk {
namespace {

struct StudioOptions {
  FitFiles files;
  std::vector<std::string> campaign;     // results, and the campaign's file
  std::optional<std::string> benchmark;  // results
  std::optional<std::string> bus;
  std::optional<std::vector<std::string>> sil;  // with the scenario's file, or none
  PlantOptions other_end;                       // of it
  std::vector<KeepFault> keep;
  std::optional<std::string> output;
  int port = 0;
  bool no_open = false;
  bool no_session = false;
  bool json = false;
  bool force = false;
  int threads = 1;
};

// Of what was given, that which every command has to be given again to read the same; beside
// --payload, which is of a recording.
std::string options_of(const CLI::App& verb) {
  std::string line;
  for (const char* name : {"--channels", "--period", "--keep"}) {
    const CLI::Option* option = verb.get_option(name);
    for (const std::string& word : option->results()) {
      line += std::string(" ") + name + " " + shell_word(word);
    }
  }
  return line;
}

// Where files lie that were dropped on a page is nobody's business: remarks name them without it.
void set_names(std::vector<Log>& logs, const std::vector<std::string>& paths,
               const std::vector<std::string>& names) {
  for (std::size_t i = 0; i < logs.size(); ++i) {
    logs[i].file = names[i];
    if (paths[i] == names[i]) continue;
    for (const std::filesystem::path& file : recording_files(paths[i])) {
      const std::string folder = file.parent_path().string() + "/";
      for (std::string& remark : logs[i].remarks) {
        for (auto at = remark.find(folder); at != std::string::npos; at = remark.find(folder)) {
          remark.erase(at, folder.size());
        }
      }
    }
  }
}

// Beside the recording that is named first, also where it was dropped on a page: then the command
// line's folder is where it is. -o says another.
std::filesystem::path place_of_session(const StudioOptions& options, const std::string& recording) {
  const bool is_named = !options.files.logs.empty() && options.files.logs.front() == recording;
  std::filesystem::path place = recording;
  if (is_named) place = recording_files(recording).front();
  if (options.output) {
    place = std::filesystem::path(*options.output).replace_filename(place.filename());
  }
  return place;
}

// `names`: what commands and messages call the recordings, where that is not where they lie.
struct ShownNames {
  std::vector<std::string> logs;
  std::vector<std::string> holdout;
};

studio::Input read_input(const StudioOptions& options, const std::string& more, ReadOne* read_one,
                         const ShownNames& names) {
  const FitFiles& files = options.files;
  for (const auto* some : {&files.logs, &files.holdout}) {
    for (const std::string& file : *some) {
      if (is_stream(file)) {
        refuse_option("studio", "RECORDING", input_name(file), "files",
                      "the commands that repeat the session read them again");
      }
    }
  }
  Progress progress;
  FitData data = read_fit_data("studio", "RECORDING", files, read_one, progress);
  set_names(data.logs, files.logs, names.logs);
  set_names(data.holdout, files.holdout, names.holdout);
  for (const std::vector<Log>* some : {&data.logs, &data.holdout}) {
    for (const Log& log : *some) refuse_hidden_from_sensors(data.robot, log);
  }
  Treated recordings;
  recordings.faults =
      treated({data.logs, data.holdout}, data.robot, options.keep, progress, RestsOn::kTorque);
  recordings.logs = std::move(data.logs);
  recordings.holdout = std::move(data.holdout);
  studio::Input input;
  input.robot = std::move(data.robot);
  input.robot_file = files.robot;
  input.recordings = std::make_shared<const Treated>(std::move(recordings));
  input.log_files = names.logs;
  input.holdout_files = names.holdout;
  input.source = "Fitted to " + file_names(names.logs) + " by offnominal add.";
  input.options = more;
  input.payloads = files.channels.payloads;
  input.output = options.output;
  input.threads = options.threads;
  if (!options.no_session) input.keep_beside = place_of_session(options, names.logs.front());
  return input;
}

studio::Input read_input(const StudioOptions& options, const std::string& more, ReadOne* read_one) {
  return read_input(options, more, read_one, {options.files.logs, options.files.holdout});
}

// Best effort: the address is printed all the same.
void open_browser(const std::string& address) {
  if (std::getenv("DISPLAY") == nullptr && std::getenv("WAYLAND_DISPLAY") == nullptr) return;
  std::string program = "xdg-open";
  std::string argument = address;
  std::array<char*, 3> words = {program.data(), argument.data(), nullptr};
  posix_spawn_file_actions_t silent;
  posix_spawn_file_actions_init(&silent);
  posix_spawn_file_actions_addopen(&silent, 0, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&silent, 1, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&silent, 2, "/dev/null", O_WRONLY, 0);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t none;
  sigemptyset(&none);
  posix_spawnattr_setsigmask(&attributes, &none);
  // A session of its own: Ctrl-C in the terminal is not for the browser.
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSID);
  pid_t child = 0;
  if (posix_spawnp(&child, words[0], &silent, &attributes, words.data(), environ) == 0) {
    std::thread([child] { ::waitpid(child, nullptr, 0); }).detach();
  }
  posix_spawn_file_actions_destroy(&silent);
  posix_spawnattr_destroy(&attributes);
}

// Ctrl-C and a request to end, held back from every thread that is made meanwhile.
class HeldSignals {
 public:
  HeldSignals() {
    sigemptyset(&signals_);
    sigaddset(&signals_, SIGINT);
    sigaddset(&signals_, SIGTERM);
    sigaddset(&signals_, SIGHUP);
    pthread_sigmask(SIG_BLOCK, &signals_, &before_);
  }
  HeldSignals(const HeldSignals&) = delete;
  HeldSignals& operator=(const HeldSignals&) = delete;
  ~HeldSignals() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }

  [[nodiscard]] const sigset_t& all() const { return signals_; }

 private:
  sigset_t signals_{};
  sigset_t before_{};
};

// Waits for them in a thread of its own: a handler may do next to nothing.
class EndOnSignal {
 public:
  EndOnSignal(studio::Server& server, const HeldSignals& held)
      : thread_([this, &server, &held] {
          constexpr timespec kQuarter = {0, 250'000'000};
          while (!over_) {
            if (sigtimedwait(&held.all(), nullptr, &kQuarter) < 0) continue;
            server.stop();
            return;
          }
        }) {}
  EndOnSignal(const EndOnSignal&) = delete;
  EndOnSignal& operator=(const EndOnSignal&) = delete;
  ~EndOnSignal() {
    over_ = true;
    thread_.join();
  }

 private:
  std::atomic<bool> over_ = false;
  std::thread thread_;
};

// Of a run that is simulated: the plant is the robot of the file, unless --plant names another.
sil::Scenario scenario_of(const StudioOptions& options, const RobotDescription& robot) {
  const std::optional<std::string> file = plant_file(options.other_end, options.files.robot);
  if (!file) {
    refuse_option(
        "studio", "--plant", *options.other_end.plant,
        "a robot file, or mujoco:FILE: the paper's arm keeps the faults that it began with",
        "run it by offnominal sil, or leave --plant out");
  }
  sil::Scenario scenario;
  // Of a plant of MuJoCo the controller's file says the joints.
  scenario.plant = *file == options.files.robot ? robot : plant_from(*file, robot);
  if (!options.sil->empty()) scenario = sil::read_scenario(options.sil->front(), scenario.plant);
  put_plant_options(options.other_end, robot, scenario);
  scenario.precision = Precision::kFloat;  // as firmware
  return scenario;
}

std::unique_ptr<live::Live> live_view(const StudioOptions& options) {
  live::LiveInput input;
  input.robot = read_robot_file(options.files.robot);
  require_carried(input.robot, options.files.robot);
  input.robot_file = options.files.robot;
  input.bus = options.bus;
  if (options.sil) {
    input.scenario = scenario_of(options, input.robot);
    input.plant_file = options.other_end.plant;
  }
  if (options.output) input.folder = std::filesystem::path(*options.output).parent_path();
  return std::make_unique<live::Live>(std::move(input));
}

// Reads what a live view has written: it is in the common format, whatever [channels] say.
studio::OpenRecording opener(StudioOptions options, const std::string& more) {
  return [options = std::move(options), more](const std::string& file) {
    StudioOptions of_file = options;
    of_file.files.logs = {file};
    return read_input(of_file, more, [](const auto& path, const auto& robot, const auto&) {
      return read_log(path, robot.joint_count(), std::nullopt);
    });
  };
}

// Reads what the page was given, as if the command line had named it.
studio::OpenFiles file_opener(StudioOptions options, const std::string& more) {
  return [options = std::move(options), more](const studio::SessionFiles& files) {
    StudioOptions of_files = options;
    ShownNames names;
    const auto take = [](const std::vector<studio::NamedFile>& some,
                         std::vector<std::string>& paths, std::vector<std::string>& shown) {
      for (const studio::NamedFile& file : some) {
        paths.push_back(file.path);
        shown.push_back(file.name);
      }
    };
    take(files.logs, of_files.files.logs, names.logs);
    take(files.holdout, of_files.files.holdout, names.holdout);
    of_files.files.robot = files.robot.path;
    of_files.files.channels.payloads = files.payloads;
    std::string with_channels = more;
    if (files.channels) {
      of_files.files.channels.file = files.channels->path;
      with_channels += " --channels " + shell_word(files.channels->name);
    }
    studio::Input input = read_input(of_files, with_channels, read_log, names);
    if (!files.kept_as.empty() && !options.no_session) {
      input.keep_beside = place_of_session(options, files.kept_as);
    }
    input.robot_file = files.robot.name;
    input.commands_note = files.commands_note;
    input.commands_before = files.commands_before;
    input.marks = files.marks;
    return input;
  };
}

std::unique_ptr<studio::Intake> intake_of(const StudioOptions& options) {
  studio::IntakeSettings settings;
  if (!options.files.robot.empty()) settings.robot_file = options.files.robot;
  if (options.output) settings.folder = std::filesystem::path(*options.output).parent_path();
  settings.keep = options.keep;
  settings.keeps_columns = !options.no_session;
  return std::make_unique<studio::Intake>(std::move(settings));
}

void serve(studio::Server& server, const StudioOptions& options, const HeldSignals& held) {
  if (options.json) {
    std::cout << json_text(
        nlohmann::ordered_json{{"address", server.address()}, {"port", server.port()}});
  } else {
    std::cout << "Studio is at " << server.address() << "\nCtrl-C ends it.\n";
  }
  std::cout.flush();
  const EndOnSignal end(server, held);
  if (!options.no_open) open_browser(server.address());
  server.run();
}

// Of what the page asks for, nothing is said before.
void check_nothing_of_recordings(const StudioOptions& options) {
  const ChannelOptions& channels = options.files.channels;
  const auto refuse = [](const char* option, const char* mend) {
    refuse_option("studio", option, "no recording that it is of", "a recording beside it", mend);
  };
  const char* on_page = "leave it out: the page asks for it once a recording is dropped";
  if (!options.files.holdout.empty()) refuse("--holdout", on_page);
  if (channels.file) refuse("--channels", on_page);
  if (channels.period_s) refuse("--period", on_page);
  if (!channels.payloads.empty()) refuse("--payload", on_page);
}

// The models and the recordings are those of the results.
void check_results(const StudioOptions& options) {
  const std::string results = options.benchmark ? "--benchmark" : "--campaign";
  const auto refuse = [&](const char* option) {
    refuse_option("studio", option, "together with " + results, "one of the two",
                  "the runs of results are opened from their page, with their model");
  };
  if (options.benchmark && !options.campaign.empty()) refuse("--campaign");
  if (options.bus) refuse("--bus");
  if (options.sil) refuse("--sil");
  if (!options.files.logs.empty()) refuse("RECORDING");
  if (!options.files.robot.empty()) refuse("--robot");
}

// One of six: recordings, a bus, a run that is simulated, a campaign, a benchmark, files that the
// page is given.
void check_source(const StudioOptions& options) {
  const bool live = options.bus || options.sil;
  const bool has_logs = !options.files.logs.empty();
  if (options.bus && options.sil) {
    refuse_option("studio", "--bus", "together with --sil", "one of the two", "leave one out");
  }
  if ((live || has_logs) && options.files.robot.empty()) {
    refuse_option("studio", "--robot", "nothing", "a robot file",
                  "give one; without recordings too, the page asks for both");
  }
  if (!options.sil) {
    const auto refuse = [](const char* option) {
      refuse_option("studio", option, "without --sil", "of a run that is simulated",
                    "give --sil, or leave it out");
    };
    if (options.other_end.plant) refuse("--plant");
    if (options.other_end.motion) refuse("--motion");
  }
  if (!live && !has_logs) check_nothing_of_recordings(options);
  if (!options.campaign.empty() || options.benchmark) check_results(options);
  if (!live) return;
  if (has_logs || !options.files.holdout.empty()) {
    refuse_option("studio", "RECORDING", "recordings beside a live view", "one of the two",
                  "what a live view records is opened from its page");
  }
}

// Beside what main() says of memory that is freed. A click fills and frees matrices of many
// megabytes: given back to the system each time, a third of its time would go to clearing their
// pages. One arena, since only the first one can grow to them.
void keep_memory_for_the_next_click() {
  constexpr int kTopPad = 1 << 25;
  mallopt(M_ARENA_MAX, 1);
  mallopt(M_TOP_PAD, kTopPad);
}

// Null: none were named.
std::unique_ptr<studio::ResultsView> results_view(const StudioOptions& options) {
  if (options.benchmark) return std::make_unique<studio::BenchmarkView>(*options.benchmark);
  if (options.campaign.empty()) return nullptr;
  std::optional<std::string> file;
  if (options.campaign.size() > 1) file = options.campaign[1];
  return std::make_unique<studio::CampaignView>(options.campaign[0], file);
}

void run(const StudioOptions& options, const std::string& more) {
  check_source(options);
  keep_memory_for_the_next_click();
  if (options.bus || options.sil) {
    const HeldSignals held;
    studio::Server server(live_view(options), opener(options, more), options.port);
    serve(server, options, held);
    return;
  }
  if (std::unique_ptr<studio::ResultsView> view = results_view(options)) {
    const HeldSignals held;
    studio::Server server(std::move(view), file_opener(options, more), options.port);
    serve(server, options, held);
    return;
  }
  if (options.files.logs.empty()) {
    const HeldSignals held;
    studio::Server server(intake_of(options), file_opener(options, more), options.port);
    serve(server, options, held);
    return;
  }
  studio::Input input = read_input(options, more, read_log);
  const HeldSignals held;
  studio::Server server(std::move(input), options.port);
  serve(server, options, held);
}

}  // namespace

void set_up_studio(CLI::App& verb, ExitCode& /*exit_code*/) {
  const auto options = std::make_shared<StudioOptions>();
  verb.add_option("RECORDING", options->files.logs,
                  "One recording to fit or several, " + log_format_names() +
                      ". Without any the page asks for them");
  verb.add_option("--robot", options->files.robot,
                  "Robot file to start from; needed with recordings and for a live view");
  verb.add_option("--bus", options->bus,
                  "In place of recordings, a live view of a CAN interface (can0, vcan0): the "
                  "monitor over what the drives say. It listens and can send nothing");
  verb.add_option_function<std::vector<std::string>>(
          "--sil",
          [options](const std::vector<std::string>& files) {
            options->sil = files;
            std::erase(*options->sil, "");  // of an option without a value
          },
          "In place of recordings, a live view of a run that is simulated: controller and arm of "
          "the robot file on a bus, with faults from the page. A scenario's file may say more")
      ->type_name("[SCENARIO]")
      ->expected(0, 1);
  add_plant_options(verb, options->other_end,
                    ". Of --sil; by default the controller's robot. What the model does not know "
                    "then shows as it does on a real arm",
                    ", at whose end the arm stands. Of --sil; by default sway");
  verb.add_option("--campaign", options->campaign,
                  "In place of recordings, the results of `offnominal campaign`: tables and curves "
                  "by fault, joint and detector, and every run as a recording. The campaign's file "
                  "may stand behind them: the commands that repeat a session name it")
      ->type_name("RESULTS [FILE]")
      ->expected(1, 2);
  verb.add_option("--benchmark", options->benchmark,
                  "In place of recordings, the results of `./dev bench discovery --results`: what "
                  "was found of what was hidden, by effect, joint and group, and every case that "
                  "was written as a recording")
      ->type_name("RESULTS");
  verb.add_option("--holdout", options->files.holdout,
                  "Recordings to judge the fit on: no fit sees them. Without any, parts of the "
                  "others are held out");
  verb.add_option("-o,--output", options->output,
                  "Robot file that saving writes, and no other [one beside the robot file, under a "
                  "name that the page asks for]")
      ->type_name(kNewRobotFile);
  verb.add_flag("--force", options->force,
                "-o may name a file that is there; the page still asks before it replaces it");
  verb.add_option("--port", options->port, "Port of 127.0.0.1 [a free one]")
      ->check(CLI::Range(1, 65535));
  verb.add_flag("--no-open", options->no_open, "Print the address and open no browser");
  verb.add_flag(
      "--no-session", options->no_session,
      "Begin anew, and keep nothing of it but what is saved [what was added and found is "
      "kept beside the first recording, or beside the file of -o, as "
      "RECORDING.studio.json, and taken up when the same files are opened again; what is said of "
      "files that are dropped on the page, in studio_columns.json]");
  add_channels_option(verb, options->files.channels, "recordings'");
  add_keep_option(verb, options->keep);
  add_threads_option(verb, options->threads, "Threads of the search for missing effects");
  verb.add_flag("--json", options->json, "Print the address as one JSON object and nothing else");
  verb.footer(
      "One page on this machine: look at the error of every joint, let `explain` say what is "
      "missing, switch effects on and off and watch the error on held-out data, save the robot "
      "file. The numbers are those of `add`, `compare` and `explain`. Without recordings they are "
      "dropped on the page with a robot file or a URDF, their columns guessed, shown and put right "
      "there, and [channels] written beside the file of -o, or into the working directory. With "
      "--sil or --bus it shows "
      "residual and threshold as they happen, keeps what is around a detection, and has it "
      "explained; recordings are written beside the file of -o, or into the working directory. "
      "Nothing leaves the machine; "
      "the address holds a token that nobody can guess, and is all that lets one in.");
  verb.callback([&verb, options] { run(*options, options_of(verb)); });
}

}  // namespace offnominal::desk
